//! Tiles of a larger map by the command line and `texbake.toml`: which files they are, and what looks wrong with them.

use super::support::{Folder, Run, bumps16, read_png};
use serde_json::json;
use texbake::{Baker, CodesRef, Edge, Edges, Grid, HeightMap, NormalOptions};

/// Texels on a side of a tile, with those that it shares.
const SIDE: usize = 8;

const TEMPLATE: &str = "tile_{x}_{y}.png";

/// Three tiles beside three, of a map of which neighbours share `overlap` texels.
fn tiles(folder: &Folder, overlap: usize) {
    for (x, y) in places() {
        tile(folder, &format!("dem/tile_{x}_{y}.png"), [x, y], overlap);
    }
}

fn tile(folder: &Folder, name: &str, [x, y]: [usize; 2], overlap: usize) -> HeightMap {
    let step = SIDE - overlap;
    folder.grey16(name, SIDE, SIDE, |column, row| bumps16(x * step + column, y * step + row))
}

fn places() -> impl Iterator<Item = (usize, usize)> {
    (0..9).map(|index| (index % 3, index / 3))
}

/// The bytes of the tile in the middle of the whole map, baked by the reference.
fn middle(overlap: usize) -> Vec<u8> {
    let (step, whole) = (SIDE - overlap, 3 * (SIDE - overlap) + overlap);
    let map: HeightMap = Grid::from_fn(whole, whole, bumps16).unwrap().into();
    let options = NormalOptions { edges: Edges::both(Edge::Clamp), ..NormalOptions::default() };
    let baked = Baker::reference().normal(&map, &options).unwrap();
    let CodesRef::U8(codes) = baked.codes() else { unreachable!("8 bits are the default") };
    (step..step + SIDE).flat_map(|row| codes[3 * (row * whole + step)..][..3 * SIDE].to_vec()).collect()
}

fn assert_is_middle(folder: &Folder, name: &str, overlap: usize) {
    let (width, height, codes) = read_png(&folder.path(name));
    assert_eq!((width, height), (SIDE, SIDE));
    assert!(codes.as_ref() == CodesRef::U8(&middle(overlap)), "{name}: not the cut of the whole map");
}

fn bake<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["bake", "dem", "--out", out, "--edge", "clamp", "--backend", "cpu"], more].concat()
}

fn warnings(stderr: &str) -> Vec<&str> {
    stderr.lines().filter(|line| line.starts_with("warning: ")).collect()
}

#[test]
fn a_folder_is_searched_by_the_template() {
    let folder = Folder::new();
    tiles(&folder, 0);
    let own = tile(&folder, "dem/own_height.png", [0, 0], 0);
    folder.grey16("dem/picture.png", 3, 3, bumps16);
    let names: Vec<String> = std::iter::once("own_normal.png".to_owned())
        .chain((0..9).map(|index| format!("tile_{}_{}_normal.png", index / 3, index % 3)))
        .collect();
    let run = folder.run(&bake("out", &["--neighbours", TEMPLATE])).ends(0);
    assert_eq!(warnings(&run.stderr), [""; 0]);
    assert_eq!(folder.files("out"), names);
    assert_is_middle(&folder, "out/tile_1_1_normal.png", 0);
    // A height map that is called otherwise is no tile.
    let alone = NormalOptions { edges: Edges::both(Edge::Clamp), ..NormalOptions::default() };
    folder.assert_baked("out/own_normal.png", &own, &alone);
    // Digits are part of no suffix.
    folder.run(&bake("digits", &["--neighbours", TEMPLATE, "--suffix", "_1", "--suffix", "_height"])).ends(0);
    assert_eq!(folder.files("digits"), names);

    folder.file("dem/texbake.toml", format!("[defaults]\nneighbours = '{TEMPLATE}'\n"));
    folder.run(&bake("settings", &[])).ends(0);
    assert_eq!(folder.files("settings"), names);
    assert_is_middle(&folder, "settings/tile_1_1_normal.png", 0);
}

#[test]
fn a_suffix_of_the_template_is_taken_off() {
    let folder = Folder::new();
    for x in 0..2 {
        tile(&folder, &format!("dem/sub/t_{x}_0_height.png"), [x, 0], 0);
    }
    folder.run(&bake("out", &["--neighbours", "t_{x}_{y}_height.png"])).ends(0);
    assert_eq!(folder.files("out"), ["sub/t_0_0_normal.png", "sub/t_1_0_normal.png"]);
}

#[test]
fn a_wrong_name_stops_no_other_file() {
    let folder = Folder::new();
    tiles(&folder, 0);
    tile(&folder, "dem/own_height.png", [0, 0], 0);
    let files = ["bake", "dem/own_height.png", "dem/tile_1_1.png", "--out", "out", "--edge", "clamp"];
    let run = folder.run(&[&files[..], &["--neighbours", TEMPLATE, "--report", "r.json"]].concat()).ends(1);
    let reason = format!("dem/own_height.png: its name is not {TEMPLATE} with numbers for {{x}} and {{y}}");
    run.says("error: ", &[&reason]);
    assert!(run.stdout.contains("1 of 2 files baked, 1 failed; "), "{}", run.stdout);
    assert_is_middle(&folder, "out/tile_1_1_normal.png", 0);
    assert_eq!(folder.files("out"), ["tile_1_1_normal.png"]);
    let report = folder.json("r.json");
    let [_, refused] = &report["files"].as_array().unwrap()[..] else { panic!("not two files: {report}") };
    assert_eq!([&refused["input"], &refused["result"]], ["dem/own_height.png", "failed"]);
    assert!(refused["error"].as_str().unwrap().starts_with(&reason), "{refused}");
    assert_eq!([&report["errors"], &refused["options"]], [&json!([]), &json!(null)]);
    let totals = ["files", "baked", "failed"].map(|count| report["totals"][count].clone());
    assert_eq!(totals, [2, 1, 1].map(|count| json!(count)));
    // What would be done says so too.
    let run = folder.run(&[&files[..], &["--neighbours", TEMPLATE, "--dry-run"]].concat()).ends(1);
    assert!(run.stdout.contains(&format!("fail dem/own_height.png: {reason}")), "{}", run.stdout);
    assert!(run.stdout.ends_with("0 of 2 files would be baked, 1 fresh, 1 would fail\n"), "{}", run.stdout);
}

#[test]
fn a_tile_that_is_there_twice_stops_those_beside_it_alone() {
    let folder = Folder::new();
    tiles(&folder, 0);
    tile(&folder, "dem/tile_00_0.png", [0, 0], 0);
    // A folder is no tile, whatever it is called.
    folder.file("dem/tile_02_2.png/notes.txt", "notes");
    let run = folder.run(&bake("out", &["--neighbours", TEMPLATE, "--report", "r.json"])).ends(1);
    run.says("error: ", &["dem/tile_0_0.png: it is the same tile as dem/tile_00_0.png: column 0, row 0; move one"]);
    assert_eq!(folder.json("r.json")["totals"]["failed"], 4);
    let baked = |names: &[&str]| names.iter().map(|name| format!("tile_{name}_normal.png")).collect::<Vec<_>>();
    assert_eq!(folder.files("out"), baked(&["0_2", "1_1", "1_2", "2_0", "2_1", "2_2"]));
    assert_is_middle(&folder, "out/tile_1_1_normal.png", 0);
    // Sobel's stencil looks at corners too.
    folder.run(&bake("sobel", &["--neighbours", TEMPLATE, "--filter", "sobel"])).ends(1);
    assert_eq!(folder.files("sobel"), baked(&["0_2", "1_2", "2_0", "2_1", "2_2"]));
}

#[test]
fn reduced_tiles_share_whole_texels() {
    let folder = Folder::new();
    tiles(&folder, 2);
    let shrunk = |overlap, shrink| {
        folder.run(&bake("out", &["--neighbours", TEMPLATE, "--shrink", shrink, "--overlap", overlap, "--force"]))
    };
    for wrong in ["1", "2", "3"] {
        let told = format!("--overlap is {wrong}: it must be a multiple of shrink, which is 4");
        shrunk(wrong, "4").ends(2).says("error: ", &[&told]);
    }
    assert_eq!(folder.files("out"), [""; 0]);
    assert_eq!(warnings(&shrunk("2", "2").ends(0).stderr), [""; 0]);
    // What is wrong is told in texels of the files.
    let said = |run: Run, words: &str| {
        let told: Vec<String> = warnings(&run.stderr).into_iter().map(str::to_owned).collect();
        assert!(told.len() == 9 && told.iter().all(|line| line.ends_with(words)), "{told:?}");
    };
    said(shrunk("4", "2").ends(0), "is --overlap 4 right?");
    said(shrunk("0", "2").ends(0), "tiles that share their borders take --overlap 2");
    shrunk("6", "2")
        .ends(1)
        .says("dem/tile_1_1.png: overlap is 6: ", &["at least 4 less than the sides", "8 x 8 texels"]);
}

#[test]
fn tiles_may_be_a_texel_wide_or_high() {
    for [width, height] in [[1, 1], [1, 5], [5, 1]] {
        let folder = Folder::new();
        for (x, y) in places() {
            let code = |column, row| bumps16(x * width + column, y * height + row);
            folder.grey16(&format!("dem/tile_{x}_{y}.png"), width, height, code);
        }
        let whole: HeightMap = Grid::from_fn(3 * width, 3 * height, bumps16).unwrap().into();
        let options = NormalOptions { edges: Edges::both(Edge::Clamp), ..NormalOptions::default() };
        let expected = Baker::reference().normal(&whole, &options).unwrap();
        let CodesRef::U8(expected) = expected.codes() else { unreachable!("8 bits are the default") };
        folder.run(&bake("out", &["--neighbours", TEMPLATE])).ends(0);
        for (x, y) in places() {
            let rows = (0..height).map(|row| ((y * height + row) * 3 + x) * width);
            let cut: Vec<u8> = rows.flat_map(|first| expected[3 * first..][..3 * width].to_vec()).collect();
            let (_, _, codes) = read_png(&folder.path(&format!("out/tile_{x}_{y}_normal.png")));
            assert!(codes.as_ref() == CodesRef::U8(&cut), "tile {x}, {y} of {width} x {height}");
        }
    }
}

#[test]
fn a_template_without_a_tile_is_wrong() {
    let folder = Folder::new();
    tiles(&folder, 0);
    let run = folder.run(&bake("out", &["--neighbours", "dem_{x}_{y}.png"])).ends(1);
    run.says(
        "error: dem: no height map found",
        &["their names are dem_{x}_{y}.png with numbers for {x} and {y}, or end"],
    );
    tile(&folder, "dem/own_height.png", [0, 0], 0);
    let run = folder.run(&bake("out", &["--neighbours", "dem_{x}_{y}.png"])).ends(2);
    run.says("error: ", &["--neighbours is dem_{x}_{y}.png: it must be the name of one height map at least"]);
    let run = folder.run(&bake("out", &["--overlap", "1"])).ends(2);
    run.says("error: ", &["--overlap is 1: it must be left out, or used with --neighbours"]);
    assert_eq!(folder.files("out"), [""; 0]);
    // Settings may be for files that are not there.
    folder
        .file("dem/texbake.toml", "[defaults]\noverlap = 1\n[[override]]\nglob = 'a*'\nneighbours = 'a_{x}_{y}.png'\n");
    folder.run(&bake("out", &[])).ends(0);
    assert_eq!(folder.files("out"), ["own_normal.png"]);
}

#[test]
fn texels_that_should_be_shared_and_are_not_are_told() {
    let folder = Folder::new();
    tiles(&folder, 2);
    let warned = |overlap| {
        let run = folder.run(&bake("out", &["--neighbours", TEMPLATE, "--overlap", overlap, "--force"])).ends(0);
        warnings(&run.stderr).into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(warned("2"), [""; 0]);
    assert_is_middle(&folder, "out/tile_1_1_normal.png", 2);
    for wrong in ["1", "3"] {
        let told = warned(wrong);
        assert_eq!(told.len(), 9, "{told:?}");
        let corner = format!(
            "warning: dem/tile_0_0.png: of the texels that it should share with the tiles beside it, these differ: \
             8 of 8 with tile_0_1.png, 8 of 8 with tile_1_0.png: is --overlap {wrong} right?"
        );
        assert!(told.contains(&corner), "{told:?}");
    }
    // One texel of those that two tiles share: each tile looks at its own border.
    for (place, expected) in [
        ((3, 0), Some(["1_1", "1_0"])),
        ((3, 1), Some(["1_0", "1_1"])),
        ((0, 4), Some(["1_1", "0_1"])),
        ((6, 3), Some(["2_1", "1_1"])),
        ((3, 3), None),
    ] {
        folder.grey16("dem/tile_1_1.png", SIDE, SIDE, |column, row| {
            bumps16(6 + column, 6 + row) ^ u16::from((column, row) == place)
        });
        let told = |[own, beside]: &[&str; 2]| {
            format!(
                "warning: dem/tile_{own}.png: of the texels that it should share with the tiles beside it, these differ: \
                 1 of 8 with tile_{beside}.png: is --overlap 2 right?"
            )
        };
        let expected: Vec<String> = expected.iter().map(told).collect();
        assert_eq!(warned("2"), expected, "{place:?}");
    }
}

#[test]
fn borders_that_are_the_same_are_told() {
    let folder = Folder::new();
    tiles(&folder, 1);
    let bake = |more: &[&str]| {
        let run = folder.run(&bake("out", &[&["--neighbours", TEMPLATE, "--force"], more].concat())).ends(0);
        warnings(&run.stderr).into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let told = bake(&[]);
    let corner = "warning: dem/tile_2_2.png: its border is the same, texel by texel, as that of tile_2_1.png, \
                  tile_1_2.png: tiles that share their borders take --overlap 1";
    assert!(told.len() == 9 && told.iter().any(|line| line == corner), "{told:?}");
    assert_eq!(bake(&["--overlap", "1"]), [""; 0]);
    assert_is_middle(&folder, "out/tile_1_1_normal.png", 1);
    // The sea is as high on both sides of a border.
    for (x, y) in places() {
        folder.grey16(&format!("dem/tile_{x}_{y}.png"), SIDE, SIDE, |_, _| 700);
    }
    assert_eq!(bake(&[]), [""; 0]);
    let run = folder.run(&["normal", "dem/tile_0_0.png", "-o", "n.png", "--neighbours", TEMPLATE, "--overlap", "8"]);
    run.ends(1).says("error: ", &["overlap is 8: it must be at least 2 less than the sides of the tiles"]);
}

#[test]
fn a_tile_that_is_missing_between_others_is_told_once() {
    let folder = Folder::new();
    tiles(&folder, 0);
    let bake = |more: &[&str]| {
        let report = ["--neighbours", TEMPLATE, "--report", "r.json"];
        let run = folder.run(&bake("out", &[&report, more].concat())).ends(0);
        let told: Vec<String> = warnings(&run.stderr).into_iter().map(str::to_owned).collect();
        let reported = folder.json("r.json")["warnings"].clone();
        let expected: Vec<&str> = told.iter().map(|line| line.strip_prefix("warning: ").unwrap()).collect();
        assert_eq!(reported, json!(expected));
        (told, run.stdout)
    };
    let (told, _) = bake(&[]);
    assert_eq!(told, [""; 0]);
    std::fs::remove_file(folder.path("dem/tile_1_1.png")).unwrap();
    let hole = "warning: dem/tile_1_1.png is missing: tiles beside it are baked as if the whole map ended there";
    let (told, table) = bake(&["--dry-run"]);
    assert_eq!(told, [hole]);
    for (name, side) in [("tile_0_1", "right"), ("tile_1_0", "below"), ("tile_1_2", "above"), ("tile_2_1", "left")] {
        let why = format!("neighbour-{side} tile_1_1.png -> edge");
        assert!(table.contains(&format!("bake dem/{name}.png -> out/{name}_normal.png: {why}\n")), "{table}");
    }
    assert!(table.ends_with("4 of 8 files would be baked, 4 fresh\n"), "{table}");
    assert_eq!(bake(&[]).0, [hole]);
    let run = folder.run(&["normal", "dem/tile_1_0.png", "-o", "n.png", "--neighbours", TEMPLATE]).ends(0);
    assert_eq!(warnings(&run.stderr), [hole]);

    tile(&folder, "dem/tile_1_1.png", [1, 1], 0);
    let (told, table) = bake(&["--dry-run"]);
    assert_eq!(told, [""; 0]);
    let appeared = "bake dem/tile_1_0.png -> out/tile_1_0_normal.png: neighbour-below edge -> tile_1_1.png\n";
    assert!(table.contains(appeared), "{table}");
    bake(&[]);
    folder.grey16("dem/tile_1_1.png", SIDE, SIDE, |_, _| 9);
    let (_, table) = bake(&["--dry-run"]);
    assert!(table.contains("out/tile_1_0_normal.png: dem/tile_1_1.png changed\n"), "{table}");

    // A corner that the map does not have is none; zeros stand in front as in the other names.
    std::fs::remove_file(folder.path("dem/tile_2_2.png")).unwrap();
    assert_eq!(bake(&[]).0, [""; 0]);
    // One warning for a hole, whichever tile beside it is asked.
    for (names, missing) in [
        (["007_-01", "009_-01"], "008_-01"),
        (["08_0", "10_0"], "09_0"),
        (["0_-04", "0_-06"], "0_-05"),
        (["9_3", "11_3"], "10_3"),
    ] {
        let folder = Folder::new();
        names.iter().for_each(|name| _ = folder.grey16(&format!("dem/{name}.png"), SIDE, SIDE, bumps16));
        let run = folder.run(&["bake", "dem", "--out", "p", "--neighbours", "{x}_{y}.png", "--edge", "clamp"]).ends(0);
        assert_eq!(warnings(&run.stderr), [hole.replace("tile_1_1", missing)]);
    }
}
