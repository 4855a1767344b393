//! What fuzzing found, made small: each input once ended in what its comment says.

use super::hand_made_tiff::Tiff;
use super::support::{Folder, read_error};
use ::exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};
use std::fmt::Write;
use texbake::io::{Model, ReadOptions};

/// `{size}/{stem}` of a map without a size was an absolute path, `/wall.png`: the map was written there. So was that
/// of a stem that is all suffix; and a stem of two dots led out of the folder.
#[test]
#[cfg(feature = "cli")]
fn names_stay_below_the_output_folder() {
    use std::path::Path;
    use texbake::batch::{Found, MapKind, NameTemplate};

    let output = |template: &str, stem: &str| {
        let template: NameTemplate = template.parse().unwrap();
        let found =
            Found { path: "x".into(), folder: "sub".into(), stem: stem.into(), size: String::new(), is_named: false };
        let maps = template.outputs(&found, &[MapKind::Normal], Path::new("out"), "png").unwrap();
        maps.normal.unwrap()
    };
    assert_eq!(output("{size}/{stem}", "wall"), Path::new("out/sub/wall.png"));
    assert_eq!(output("{stem}/{map}", ""), Path::new("out/sub/normal.png"));
    assert_eq!(output("{stem}/{map}", ".."), Path::new("out/sub/normal.png"));
    assert_eq!(output("a/{size}/{stem}", "wall"), Path::new("out/sub/a/wall.png"));
}

/// A template with a zero byte was taken, and no file can be called so.
#[test]
#[cfg(feature = "cli")]
fn names_are_plain_text() {
    for text in ["{stem}\0", "a\n{stem}", "\x1b[2J{stem}"] {
        let error = text.parse::<texbake::batch::NameTemplate>().unwrap_err();
        assert!(error.to_string().contains("it must be a file name without extension"), "{error}");
    }
}

/// The names of an EXR's channels went to the terminal as they were, escape sequences and new lines too.
#[test]
fn messages_are_one_line_whatever_names_a_file_holds() {
    let folder = Folder::new();
    let path = folder.path("escape.exr");
    let channel = |name: &str| AnyChannel::new(name, FlatSamples::F32(vec![0.5]));
    let channels = AnyChannels::sort(["\x1b[2Ja", "b\nwarning: all is well"].map(channel).into_iter().collect());
    let layer = Layer::new((1, 1), LayerAttributes::named("l"), Encoding::UNCOMPRESSED, channels);
    Image::from_layer(layer).write().to_file(&path).unwrap();
    let message = read_error(&path, &ReadOptions::default());
    assert!(message.contains(r"which of its channels is meant: \u{1b}[2Ja, b\nwarning: all is well; "), "{message}");

    let obj = folder.file("m.obj", b"mtllib m.mtl\nv 0 0 0\nf 1 1 1\n");
    folder.file("m.mtl", b"newmtl a\nmap_Kd \x1b[2J.png\n\x07 1\n");
    let model = Model::read(&obj).unwrap();
    assert!(model.warnings().iter().all(|warning| !warning.contains(char::is_control)), "{:?}", model.warnings());
    assert_eq!(model.warnings().len(), 2);
}

/// Each ear of a polygon was looked for from its first corner on, among all corners: a few thousand took minutes.
#[test]
fn a_comb_of_thousands_of_corners_is_cut() {
    // Teeth that point up from a long base, between which every other corner is reflex.
    let teeth = 4000;
    let mut text = String::new();
    let mut corner = |x: usize, y: usize| writeln!(text, "v {x} {y} 0\nvt 0 0").unwrap();
    corner(0, 0);
    corner(2 * teeth, 0);
    for tooth in (0..teeth).rev() {
        corner(2 * tooth + 1, 9);
        corner(2 * tooth, 1);
    }
    let corners: String = (1..=2 * teeth + 2).map(|i| format!(" {i}/{i}")).collect();
    let folder = Folder::new();
    let path = folder.file("comb.obj", format!("{text}f{corners}\n").as_bytes());
    let mesh = Model::read(&path).unwrap().mesh(0).unwrap();
    assert_eq!(mesh.triangles().len(), 2 * teeth);
    // A base of height 1, but at its right end, and teeth of base 2 and height 8.
    let areas = mesh.triangles().iter().map(|triangle| {
        let [[ax, ay, _], [bx, by, _], [cx, cy, _]] = triangle.map(|corner| mesh.positions()[corner as usize]);
        f64::from((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2.0
    });
    let areas: Vec<f64> = areas.collect();
    assert!(areas.iter().all(|area| *area >= 0.0), "no triangle lies outside");
    let outline = |corners: &[(f64, f64)]| -> f64 {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>() / 2.0
    };
    let mut polygon = vec![(0.0, 0.0), (2.0 * teeth as f64, 0.0)];
    polygon.extend((0..teeth).rev().flat_map(|i| [(2.0 * i as f64 + 1.0, 9.0), (2.0 * i as f64, 1.0)]));
    assert_eq!(areas.iter().sum::<f64>(), outline(&polygon));
}

/// The decoder makes room for all values that an entry claims, 32 bytes each, before it reads them: 160 MB for a tag of
/// a file of 400 bytes, whatever the limit was.
#[test]
fn values_of_a_tiff_stand_in_the_file() {
    let folder = Folder::new();
    let mut tiff = Tiff::grey(2, 2, 8, 1, vec![vec![1, 2, 3, 4]]);
    // Tag 338 says what further samples are.
    tiff.extra.push((338, 3, 5_000_000, vec![0; 8]));
    let message = read_error(&folder.file("t.tif", &tiff.bytes()), &ReadOptions::default());
    assert!(
        message.contains("its tag 338 claims 5000000 values, more than the file holds; it is damaged"),
        "{message}"
    );

    let values = vec![0; 2 * 40_000];
    tiff.extra = vec![(338, 3, 40_000, values)];
    let little = ReadOptions { max_bytes: 1 << 20, ..ReadOptions::default() };
    let message = read_error(&folder.file("t.tif", &tiff.bytes()), &little);
    let expected =
        "the 40000 values of its tag 338 take 1280000 bytes, above the limit of 1048576; raise it with --max-bytes";
    assert!(message.contains(expected), "{message}");
}

/// Settings that are no UTF-8 were refused in the system's words, without a line and without a way out.
#[test]
#[cfg(feature = "cli")]
fn settings_in_another_encoding() {
    let folder = Folder::new();
    folder.file("texbake.toml", b"[defaults]\n# H\xf6he\nscale = 24\n");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_texbake"));
    let done = command.args(["bake", ".", "--out", "baked"]).current_dir(folder.path("")).output().unwrap();
    let stderr = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("texbake.toml:2: it is no text in UTF-8; save it as UTF-8"), "{stderr}");
}
