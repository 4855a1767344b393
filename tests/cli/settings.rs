//! `texbake.toml` and its place behind the command line.

use super::support::{Folder, bumps8};
use texbake::{Depth, Edge, Edges, Filter, NormalMap, NormalOptions, Scale};

const SETTINGS: &str = "\
[defaults]
scale = 8
filter = 'sobel'

[[override]]
glob = '**/dem_*'
scale = '7/2'
edge = 'clamp'

[[override]]
glob = 'coast/**'
scale = 0.5
name = '{stem}_n'
";

#[test]
fn overrides_change_the_files_that_they_match() {
    let folder = Folder::new();
    let names = ["wall_h.png", "dem_1_h.png", "sub/dem_2_h.png", "coast/dem_3_h.png"];
    let map = names.map(|name| folder.grey8(&format!("tex/{name}"), 9, 8, bumps8))[0].clone();
    folder.file("tex/texbake.toml", SETTINGS);
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    assert!(run.line("settings from").ends_with("texbake.toml"), "{}", run.stderr);

    let sobel = |scale: &str, edge| NormalOptions {
        scale: Scale::texels(scale.parse::<texbake::Rational>().unwrap()),
        filter: Filter::Sobel,
        edges: Edges::both(edge),
        ..NormalOptions::default()
    };
    folder.assert_baked("out/wall_normal.png", &map, &sobel("8", Edge::Wrap));
    folder.assert_baked("out/dem_1_normal.png", &map, &sobel("7/2", Edge::Clamp));
    folder.assert_baked("out/sub/dem_2_normal.png", &map, &sobel("7/2", Edge::Clamp));
    // Key by key: the scale of the last override that matches, the edge of the one before it.
    folder.assert_baked("out/coast/dem_3_n.png", &map, &sobel("0.5", Edge::Clamp));

    folder.run(&["bake", "tex", "--out", "own", "--scale", "2", "--edge", "mirror"]).ends(0);
    for name in ["wall_normal.png", "dem_1_normal.png", "sub/dem_2_normal.png", "coast/dem_3_n.png"] {
        folder.assert_baked(&format!("own/{name}"), &map, &sobel("2", Edge::Mirror));
    }
}

#[test]
fn the_settings_file_is_looked_for_in_the_folder_then_here_and_can_be_named() {
    let folder = Folder::new();
    let map = folder.grey8("tex/wall_h.png", 9, 8, bumps8);
    let scaled = |scale: i32| NormalOptions { scale: Scale::texels(scale), ..NormalOptions::default() };
    folder.file("other.toml", "[defaults]\nscale = 4\n");
    let run = folder.run(&["bake", "tex", "--out", "a"]).ends(0);
    assert!(!run.stderr.contains("settings"), "{}", run.stderr);
    folder.assert_baked("a/wall_normal.png", &map, &scaled(1));

    folder.file("texbake.toml", "[defaults]\nscale = 2\n");
    let run = folder.run(&["bake", "tex", "--out", "b"]).ends(0);
    run.says("settings from", &["texbake.toml"]);
    folder.assert_baked("b/wall_normal.png", &map, &scaled(2));

    folder.file("tex/texbake.toml", "[defaults]\nscale = 3\n");
    folder.run(&["bake", "tex", "--out", "c", "-q"]).ends(0);
    folder.assert_baked("c/wall_normal.png", &map, &scaled(3));

    let run = folder.run(&["bake", "tex", "--out", "d", "--config", "other.toml"]).ends(0);
    run.says("settings from", &["other.toml"]);
    folder.assert_baked("d/wall_normal.png", &map, &scaled(4));
    // One file needs no settings file, and uses none.
    folder.run(&["normal", "tex/wall_h.png", "-o", "n.png", "-q"]).ends(0);
    folder.assert_baked("n.png", &map, &scaled(1));
}

#[test]
fn suffixes_come_from_the_settings_too() {
    let folder = Folder::new();
    folder.grey8("tex/a_relief.png", 3, 3, bumps8);
    folder.grey8("tex/b_height.png", 3, 3, bumps8);
    folder.file("tex/texbake.toml", "suffix = ['_relief']\n");
    folder.run(&["bake", "tex", "--out", "a", "-q"]).ends(0);
    assert_eq!(folder.files("a"), ["a_normal.png"]);
    folder.run(&["bake", "tex", "--out", "b", "-q", "--suffix", "_height"]).ends(0);
    assert_eq!(folder.files("b"), ["b_normal.png"]);
}

#[test]
fn mistakes_name_file_line_and_key() {
    let folder = Folder::new();
    folder.grey8("tex/a_h.png", 3, 3, bumps8);
    for (text, parts) in [
        ("[defaults]\nscal = 1\n", ["texbake.toml:2: scal is no setting", "scale, size, depth"]),
        ("[defaults]\n\nedge = 'repeat'\n", ["texbake.toml:3: ", "'repeat' for '--edge"]),
        ("scale = 1\n", ["texbake.toml:1: scale has no meaning here", "[defaults]"]),
        ("[[override]]\nscale = 1\n", ["texbake.toml:1: this override has no glob", "glob ="]),
        ("[defaults]\nscale = 'half\n", ["texbake.toml:2: ", "correct it"]),
    ] {
        folder.file("tex/texbake.toml", text);
        folder.run(&["bake", "tex", "--out", "out"]).ends(2).says("error: tex", &parts);
        assert!(folder.files("out").is_empty());
    }
    let run = folder.run(&["bake", "tex", "--out", "out", "--config", "missing.toml"]).ends(2);
    run.says("error: missing.toml", &["No such file", "check how its path is written"]);
}

#[test]
fn an_override_for_nothing_gives_a_warning() {
    let folder = Folder::new();
    folder.grey8("tex/a_h.png", 3, 3, bumps8);
    folder.file("tex/texbake.toml", "[[override]]\nglob = 'b_*'\nscale = 3\n");
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    run.says("warning: tex", &["no height map matches the override \"b_*\""]);
}

#[test]
fn a_format_takes_the_place_of_codes_that_it_cannot_hold() {
    let folder = Folder::new();
    folder.grey8("tex/a_h.png", 3, 3, bumps8);
    let codes = "bits = 16\nencoding = 'biased'\nparallax-bits = 16\nmaps = 'normal,parallax'\n";
    folder.file("tex/texbake.toml", format!("[[override]]\nglob = 'a_*'\n{codes}"));
    let baked = |format: &str| {
        folder.run(&["bake", "tex", "--out", "out", "--format", format, "-q"]).ends(0);
        let map = NormalMap::read(folder.path(&format!("out/a_normal.{format}"))).unwrap();
        assert!(folder.path(&format!("out/a_parallax.{format}")).exists());
        map.format().depth
    };
    assert_eq!([baked("exr"), baked("tif"), baked("png")], [Depth::Float32, Depth::Bits16, Depth::Bits16]);

    // In one file they are at odds.
    folder.file("tex/texbake.toml", format!("[defaults]\nformat = 'exr'\n[[override]]\nglob = 'a_*'\n{codes}"));
    let run = folder.run(&["bake", "tex", "--out", "other"]).ends(2);
    run.says("error: tex", &["texbake.toml: encoding is biased with 16 bits, for a_normal.exr: it must be float"]);
    assert!(folder.files("other").is_empty());
}

#[test]
fn mistakes_that_only_a_bake_shows_name_the_file_too() {
    let folder = Folder::new();
    folder.grey8("tex/a_h.png", 3, 3, bumps8);
    for (text, parts) in [
        ("[defaults]\nscale = 1e9\n", ["texbake.toml: scale is 1000000000: it must be", "16777215"]),
        ("[defaults]\nsize = '1x1'\n", ["texbake.toml: depth is missing: ", "--size"]),
        ("suffix = ['']\n", ["texbake.toml: suffix is empty: ", "_height"]),
    ] {
        folder.file("tex/texbake.toml", text);
        folder.run(&["bake", "tex", "--out", "out"]).ends(2).says("error: tex", &parts);
    }
    // What is wrong on the command line is not the file's fault.
    folder.file("tex/texbake.toml", "[defaults]\nfilter = 'sobel'\n");
    folder.run(&["bake", "tex", "--out", "out", "--scale", "99999999"]).ends(2).says("error: --scale is 99999999", &[]);
}
