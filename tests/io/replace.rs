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
        sink.write(0, row(depth)).unwrap();
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
        sink.write(0, row(depth)).unwrap();
        sink.write(1, row(depth)).unwrap();
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
    sink.write(0, row(Depth::Bits8)).unwrap();
    let message = sink.finish().unwrap_err().to_string();
    assert!(message.contains("rows is without row 1"), "{message}");
    assert_eq!(folder.names(), Vec::<String>::new());

    let mut sink = create_normals(&folder.path("n.png"), size(), NormalFormat::default()).unwrap();
    for wrong in [CodesRef::U16(&[0; 6]), CodesRef::U8(&[0; 5]), CodesRef::U8(&[0; 18])] {
        let message = sink.write(0, wrong).unwrap_err().to_string();
        assert!(message.contains("whole rows of 6 codes of depth 8, up to 2 from row 0 on"), "{message}");
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
    let known = "texbake writes .png, .tif, .tiff, .exr, .ktx2 and .dds";
    assert!(refuse("n").contains(&format!("it has no extension, which picks the format; {known}")));
    assert!(refuse("n.webp").contains(&format!("the extension .webp is unknown; {known}")));
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

/// The same file, whether row 0 comes first or last.
#[test]
fn the_first_row_may_come_last() {
    for (name, depth) in [("n.png", Depth::Bits8), ("n.png", Depth::Bits16), ("n.tif", Depth::Bits16)] {
        for (height, channels) in [(2, Channels::Xyz), (5, Channels::Xy)] {
            let folder = Folder::new();
            let size = Size::new(40, height).unwrap();
            let format = format(Encoding::Unorm, depth, channels);
            let row_codes = 40 * channels.count();
            let bytes: Vec<u8> = (0..row_codes * height).map(|i| (i * i % 251) as u8).collect();
            let words: Vec<u16> = bytes.iter().map(|byte| u16::from(*byte) * 257).collect();
            let rows = |rows: std::ops::Range<usize>| {
                let codes = rows.start * row_codes..rows.end * row_codes;
                if depth == Depth::Bits8 { CodesRef::U8(&bytes[codes]) } else { CodesRef::U16(&words[codes]) }
            };
            let file = |name: &str, order: &[std::ops::Range<usize>]| {
                let mut sink = create_normals(&folder.path(name), size, format).unwrap();
                assert!(sink.takes_first_row_last());
                order.iter().for_each(|part| sink.write(part.start, rows(part.clone())).unwrap());
                sink.finish().unwrap();
                std::fs::read(folder.path(name)).unwrap()
            };
            let from_top = file(name, &[0..1, 1..height]);
            let late = [1..2, 2..height, 0..1].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>();
            assert_eq!(file(&std::format!("late-{name}"), &late), from_top, "{name}, {height} rows");
        }
    }
}

#[test]
fn rows_out_of_order_are_refused() {
    let folder = Folder::new();
    let rows = |count: usize| CodesRef::U8(&[7; 18][..6 * count]);
    for (name, wrong) in [("n.png", vec![(2, 1)]), ("n.png", vec![(1, 1), (0, 1)]), ("n.png", vec![(1, 2), (0, 2)])] {
        let mut sink = create_normals(&folder.path(name), Size::new(2, 3).unwrap(), NormalFormat::default()).unwrap();
        let (last, before) = wrong.split_last().unwrap();
        before.iter().for_each(|(first, count)| sink.write(*first, rows(*count)).unwrap());
        assert!(sink.write(last.0, rows(last.1)).unwrap_err().to_string().contains("whole rows"), "{wrong:?}");
    }
    let exr = NormalFormat { encoding: Encoding::Float, depth: Depth::Float32, ..NormalFormat::default() };
    let mut sink = create_normals(&folder.path("n.exr"), Size::new(2, 3).unwrap(), exr).unwrap();
    assert!(!sink.takes_first_row_last());
    assert!(sink.write(1, CodesRef::F32(&[0.0; 12])).is_err());
}
