//! A name never stands for half a file.

use super::support::{Folder, format, write};
use texbake::io::{create_normals, default_format};
use texbake::{Channels, CodesRef, Depth, Encoding, NormalFormat, Size};

const NAMES: [(&str, Encoding, Depth); 3] = [
    ("n.png", Encoding::Unorm, Depth::Bits8),
    ("n.tiff", Encoding::Unorm, Depth::Bits8),
    ("n.exr", Encoding::Float, Depth::Float32),
];

fn row(depth: Depth) -> CodesRef<'static> {
    if depth == Depth::Float32 { CodesRef::F32(&[0.5; 6]) } else { CodesRef::U8(&[9; 6]) }
}

fn size() -> Size {
    Size::new(2, 2).unwrap()
}

#[test]
fn nothing_is_left_without_finish() {
    for (name, encoding, depth) in NAMES {
        let folder = Folder::new();
        let mut sink = create_normals(&folder.path(name), size(), format(encoding, depth, Channels::Xyz)).unwrap();
        sink.write(row(depth)).unwrap();
        assert_eq!(folder.names().len(), 1, "the temporary file stands beside the target");
        drop(sink);
        assert_eq!(folder.names(), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn an_existing_file_is_untouched_until_finish() {
    for (name, encoding, depth) in NAMES {
        let folder = Folder::new();
        let path = folder.file(name, b"before");
        let mut sink = create_normals(&path, size(), format(encoding, depth, Channels::Xyz)).unwrap();
        sink.write(row(depth)).unwrap();
        sink.write(row(depth)).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"before", "{name}");
        sink.finish().unwrap();
        assert_ne!(std::fs::read(&path).unwrap(), b"before", "{name}");
        assert_eq!(folder.names(), [name]);
    }
}

#[test]
fn an_incomplete_map_is_no_file() {
    let folder = Folder::new();
    let mut sink = create_normals(&folder.path("n.png"), size(), NormalFormat::default()).unwrap();
    sink.write(row(Depth::Bits8)).unwrap();
    let message = sink.finish().unwrap_err().to_string();
    assert!(message.contains("rows is 1 too few"), "{message}");
    assert_eq!(folder.names(), Vec::<String>::new());

    let mut sink = create_normals(&folder.path("n.png"), size(), NormalFormat::default()).unwrap();
    for wrong in [CodesRef::U16(&[0; 6]), CodesRef::U8(&[0; 5]), CodesRef::U8(&[0; 18])] {
        let message = sink.write(wrong).unwrap_err().to_string();
        assert!(message.contains("whole rows of 6 codes of depth 8, at most 2"), "{message}");
    }
}

#[test]
fn targets_that_cannot_be_written_are_refused_at_once() {
    let folder = Folder::new();
    let refuse = |name: &str| {
        let error = create_normals(&folder.path(name), size(), NormalFormat::default()).err().unwrap();
        error.to_string()
    };
    std::fs::create_dir(folder.path("d.png")).unwrap();
    assert!(refuse("d.png").contains("it is a folder; give the name of a file"));
    let message = refuse("none/n.png");
    assert!(message.contains("none/n.png: ") && message.contains("No such file"), "{message}");
    assert!(!message.contains("texbake-"), "{message}");
    let locked = folder.file("l.png", b"");
    let mut permissions = std::fs::metadata(&locked).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&locked, permissions).unwrap();
    assert!(refuse("l.png").contains("it is read-only; make it writable, or write elsewhere"));
    assert!(refuse("n").contains("it has no extension, which picks the format; texbake writes .png, .tif"));
    assert!(refuse("n.webp").contains("the extension .webp is unknown; texbake writes .png, .tif, .tiff and .exr"));
}

#[test]
fn the_extension_suggests_a_format() {
    let of = |name: &str| default_format(name.as_ref()).unwrap();
    assert_eq!(of("a.PNG"), (Encoding::Unorm, Depth::Bits8));
    assert_eq!((of("a.tif"), of("b.TIFF")), ((Encoding::Unorm, Depth::Bits16), (Encoding::Unorm, Depth::Bits16)));
    assert_eq!(of("x/a.exr"), (Encoding::Float, Depth::Float32));
    assert!(default_format("a.jpg".as_ref()).is_err());
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_any_new_file_or_of_the_old_one() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let mode = |name: &str| std::fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o777;
    folder.file("plain", b"");
    let xyz = NormalFormat::default();
    write(&folder.path("n.png"), 1, 1, xyz, CodesRef::U8(&[0; 3])).unwrap();
    assert_eq!(mode("n.png"), mode("plain"));
    std::fs::set_permissions(folder.path("n.png"), std::fs::Permissions::from_mode(0o640)).unwrap();
    write(&folder.path("n.png"), 1, 1, xyz, CodesRef::U8(&[0; 3])).unwrap();
    assert_eq!(mode("n.png"), 0o640);
}
