//! The settings that a plan chooses: a reduced map, and no map.

use super::support::{Folder, assert_parallax, bumps8, bumps16};
use serde_json::{Value, json};
use texbake::{Depth, Encoding, HeightMap, NormalOptions, ParallaxFormat, ParallaxOptions, Scale};

/// The mean of each square of 2 x 2 codes of 8 bits: 257 / 4 of their sum, ties up.
fn halved(folder: &Folder, name: &str, width: usize, height: usize) -> HeightMap {
    let code = |x: usize, y: usize| {
        let sum: u32 = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| bumps8(2 * x + i, 2 * y + j).into()).iter().sum();
        ((257 * sum + 2) / 4) as u16
    };
    folder.grey16(name, width, height, code)
}

#[test]
fn shrink_bakes_what_the_map_reduced_by_hand_bakes() {
    let folder = Folder::new();
    folder.grey8("tex/wall_h.png", 20, 12, bumps8);
    let reduced = halved(&folder, "hand/wall_h.png", 10, 6);
    // A scale of 6 texels is one of 3 texels twice as wide.
    folder.file("tex/texbake.toml", "[defaults]\nscale = 6\nmaps = ['normal', 'parallax']\nshrink = 2\n");
    let run = folder.run(&["bake", "tex", "--out", "out", "--report", "r.json"]).ends(0);
    let scale = Scale::texels(3);
    folder.assert_baked("out/wall_normal.png", &reduced, &NormalOptions { scale, ..Default::default() });
    let format = ParallaxFormat { encoding: Encoding::Biased, depth: Depth::Bits8 };
    let parallax = ParallaxOptions { scale, format, ..Default::default() };
    assert_parallax(&folder, "out/wall_parallax.png", &reduced, &parallax);
    assert!(run.line("[1/1] baked").contains("10 x 6 (shrunk by 2), u16, "), "{}", run.stderr);
    assert!(run.stdout.contains("10 x 6 (shrunk by 2)"), "{}", run.stdout);
    let file = &folder.json("r.json")["files"][0];
    assert_eq!((&file["options"]["shrink"], &file["options"]["scale"]), (&json!(2), &json!("6")));
    assert_eq!((&file["width"], &file["height"], &file["depth"]), (&json!(10), &json!(6), &json!("u16")));
    assert_eq!(file["scale"], json!({ "x": "3", "y": "3", "exact": true }));

    // By hand, the same bytes; a physical size needs no other scale.
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    folder.run(&["bake", "hand", "--out", "b", "--maps", "normal,parallax", "--scale", "3", "-q"]).ends(0);
    for map in ["wall_normal.png", "wall_parallax.png"] {
        assert!(bytes(&format!("out/{map}")) == bytes(&format!("b/{map}")), "{map}");
    }
    let physical = ["--size", "20x12", "--depth", "6", "--shrink", "2", "-q"];
    folder.run(&[&["normal", "tex/wall_h.png", "-o", "n.png"][..], &physical].concat()).ends(0);
    assert!(bytes("n.png") == bytes("b/wall_normal.png"));
    // The heights of a parallax map are reduced too, to the size of the normals that were given.
    let given = ["--normal", "n.png", "--scale", "6", "--shrink", "2", "-q"];
    folder.run(&[&["parallax", "tex/wall_h.png", "-o", "p.png"][..], &given].concat()).ends(0);
    folder.run(&["parallax", "hand/wall_h.png", "-o", "q.png", "--normal", "n.png", "--scale", "3", "-q"]).ends(0);
    assert!(bytes("p.png") == bytes("q.png"));
}

#[test]
fn a_factor_that_does_not_fit_is_refused_by_name() {
    let folder = Folder::new();
    folder.grey8("h.png", 9, 6, bumps8);
    let run = folder.run(&["normal", "h.png", "-o", "n.png", "--shrink", "2"]).ends(1);
    run.says("h.png", &["shrink is 2: it must be a divisor of both sides of the map, which has 9 x 6 texels"]);
    for wrong in ["0", "65", "1.5", "x"] {
        let run = folder.run(&["normal", "h.png", "-o", "n.png", "--shrink", wrong]).ends(2);
        run.says("--shrink", &["it must be a whole number from 1 to 64"]);
    }
    assert!(!folder.path("n.png").exists());
}

#[test]
fn a_file_may_get_no_map() {
    let folder = Folder::new();
    let map = folder.grey16("tex/wall_h.png", 8, 8, bumps16);
    folder.grey8("tex/sky_h.png", 4, 4, bumps8);
    folder.file("tex/texbake.toml", "[defaults]\nmaps = 'none'\n[[override]]\nglob = 'wall_*'\nmaps = 'normal'\n");
    let run = folder.run(&["bake", "tex", "--out", "out", "--report", "r.json"]).ends(0);
    assert_eq!(folder.files("out"), ["wall_normal.png"]);
    folder.assert_baked("out/wall_normal.png", &map, &NormalOptions::default());
    let row: Vec<&str> = run.stdout.lines().nth(2).unwrap().split_whitespace().collect();
    assert_eq!(row, ["tex/sky_h.png", "none", "left", "out"], "{}", run.stdout);
    assert!(run.stdout.contains("1 of 1 files baked, 1 left out; "), "{}", run.stdout);
    let report = folder.json("r.json");
    assert_eq!(report["left_out"], json!(["tex/sky_h.png"]));
    assert_eq!((&report["files"][0]["input"], &report["files"][1]), (&json!("tex/wall_h.png"), &Value::Null));

    // The command line has the last word, and nothing to bake is no failure.
    folder.run(&["bake", "tex", "--out", "all", "--maps", "normal", "-q"]).ends(0);
    assert_eq!(folder.files("all"), ["sky_normal.png", "wall_normal.png"]);
    folder.run(&["bake", "tex", "--out", "no", "--maps", "none"]).ends(0);
    assert!(folder.files("no").is_empty());
    let run = folder.run(&["bake", "tex", "--out", "no", "--maps", "normal,none"]).ends(2);
    run.says("error: --maps", &["none and others", "none alone, or a list of normal, parallax and roughness"]);
}
