//! Options of textures, and the tiles beside a tile: each bakes again what depends on it, and nothing else.

use super::support::{baked, contents};
use crate::cli::support::{Folder, bumps8};
use std::fs;

/// Three textures for GPU files.
fn gpu_textures() -> Folder {
    let folder = super::support::textures();
    assert_eq!(baked(&folder, &["--format", "ktx2"]).len(), 3);
    folder
}

fn set(folder: &Folder, settings: &str) {
    folder.file("tex/texbake.toml", settings);
}

#[test]
fn mip_levels_and_blocks_are_for_the_textures_that_get_them() {
    let folder = gpu_textures();
    let ktx2 = |more: &[&str]| baked(&folder, &[&["--format", "ktx2"], more].concat());
    assert_eq!(ktx2(&[]), [""; 0]);
    set(&folder, "[[override]]\nglob = 'b_*'\nmips = true\n");
    assert_eq!(ktx2(&[]), ["b mips false -> true"]);
    assert_eq!(ktx2(&[]), [""; 0]);
    assert_eq!(ktx2(&["--mips"]), ["a mips false -> true", "c mips false -> true"]);
    assert_eq!(ktx2(&["--mips=false"]), ["a", "b", "c"].map(|name| format!("{name} mips true -> false")));
    set(&folder, "[[override]]\nglob = 'sub/*'\nblock-compression = 'bc5'\n");
    assert_eq!(ktx2(&[]), ["c block-compression none -> bc5"]);
    let all = ["a block-compression none -> bc7", "b block-compression none -> bc7", "c block-compression bc5 -> bc7"];
    assert_eq!(ktx2(&["--block-compression", "bc7"]), all);
    // What none of these maps are of changes nothing.
    let rough = ["--roughness-method", "toksvig", "--base-roughness", "0.5", "--roughness-bits", "16"];
    assert_eq!(ktx2(&[&["--block-compression", "bc7"], &rough[..]].concat()), [""; 0]);
}

#[test]
fn how_a_png_is_compressed_is_for_pngs() {
    let folder = gpu_textures();
    set(&folder, "[[override]]\nglob = 'a_*'\nformat = 'png'\n[[override]]\nglob = 'b_*'\nformat = 'tif'\n");
    let settled = |more: &[&str]| baked(&folder, &[&["--maps", "normal"], more].concat());
    let c_is_png = ["a new", "b new", "c new"];
    assert_eq!(settled(&[]), c_is_png);
    assert_eq!(settled(&["--compression", "small"]), ["a compression fast -> small", "c compression fast -> small"]);
    assert_eq!(settled(&["--compression", "small"]), [""; 0]);
    assert_eq!(
        settled(&["--compression", "balanced"]),
        ["a", "c"].map(|it| format!("{it} compression small -> balanced"))
    );
    assert_eq!(baked(&folder, &["--format", "ktx2", "--compression", "small"]), [""; 0]);
}

#[test]
fn a_roughness_map_counts_like_the_map_beside_it() {
    let folder = super::support::textures();
    let bake = |more: &[&str]| {
        baked(&folder, &[&["--format", "dds", "--mips", "--maps", "normal,roughness", "--scale", "8"], more].concat())
    };
    assert_eq!(bake(&[]), ["a new", "b new", "c new"]);
    assert_eq!(bake(&[]), [""; 0]);
    let first = contents(&folder);
    assert_eq!(first.len(), 6);
    for (option, value, reason) in [
        ("--roughness-method", "toksvig", "roughness-method lean -> toksvig"),
        ("--base-roughness", "0.25", "base-roughness 0 -> 0.25"),
        ("--roughness-bits", "16", "roughness-bits 8 -> 16"),
    ] {
        assert_eq!(bake(&[option, value]), ["a", "b", "c"].map(|name| format!("{name} {reason}")));
        assert_eq!(bake(&[option, value]), [""; 0], "{option}");
        assert_eq!(bake(&[]).len(), 3, "and back");
    }
    set(&folder, "[[override]]\nglob = 'b_*'\nroughness-method = 'toksvig'\n");
    assert_eq!(bake(&[]), ["b roughness-method lean -> toksvig"]);
    set(&folder, "");
    assert_eq!(bake(&[]), ["b roughness-method toksvig -> lean"]);

    fs::remove_file(folder.path("out/a_roughness.dds")).unwrap();
    assert_eq!(bake(&[]), ["a out/a_roughness.dds is missing"]);
    let edited = folder.path("out/sub/c_roughness.dds");
    let mut bytes = fs::read(&edited).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&edited, bytes).unwrap();
    assert_eq!(bake(&[]), ["c out/sub/c_roughness.dds was edited"]);
    assert_eq!(bake(&[]), [""; 0]);
    assert!(contents(&folder) == first);
}

/// The tile in column `x`, row `y`; 12 texels wide and high.
fn tile(folder: &Folder, x: usize, y: usize, salt: u8) {
    let code = |column: usize, row: usize| bumps8(12 * x + column, 12 * y + row) ^ salt;
    folder.grey8(&format!("tex/t_{x}_{y}_height.png"), 12, 12, code);
}

#[test]
fn a_tile_is_baked_again_with_the_tiles_beside_it() {
    let folder = Folder::new();
    for x in 0..4 {
        tile(&folder, x, 0, 0);
    }
    let bake = |more: &[&str]| {
        let tiles = ["--neighbours", "t_{x}_{y}_height.png", "--edge", "clamp", "--filter", "sobel"];
        baked(&folder, &[&tiles, more].concat())
    };
    assert_eq!(bake(&[]), ["t_0_0 new", "t_1_0 new", "t_2_0 new", "t_3_0 new"]);
    assert_eq!(bake(&[]), [""; 0]);
    // Another content of a tile is one of those beside it too.
    tile(&folder, 0, 0, 5);
    assert_eq!(bake(&[]), ["t_0_0 tex/t_0_0_height.png changed", "t_1_0 tex/t_0_0_height.png changed"]);
    tile(&folder, 2, 0, 9);
    assert_eq!(bake(&[]), ["t_1_0", "t_2_0", "t_3_0"].map(|name| format!("{name} tex/t_2_0_height.png changed")));
    assert_eq!(bake(&[]), [""; 0]);

    // A tile that appears is seen by the one above it; at a corner what lies beyond the border of the map decides.
    tile(&folder, 0, 1, 0);
    let names = |baked: &[String]| -> Vec<String> {
        baked.iter().map(|line| line.split(' ').take(2).collect::<Vec<_>>().join(" ")).collect()
    };
    let found = bake(&[]);
    assert_eq!(names(&found), ["t_0_0 neighbours", "t_0_1 new"]);
    assert!(found[0].contains("t_0_1_height.png"), "{found:?}");
    assert_eq!(bake(&[]), [""; 0]);
    // And one that goes.
    fs::remove_file(folder.path("tex/t_3_0_height.png")).unwrap();
    assert_eq!(names(&bake(&[])), ["t_2_0 neighbours"]);
    assert_eq!(bake(&[]), [""; 0]);

    let all = ["t_0_0 neighbours", "t_0_1 neighbours", "t_1_0 neighbours", "t_2_0 neighbours"];
    assert_eq!(names(&bake(&["--overlap", "1"])), all);
    assert_eq!(bake(&["--overlap", "1"]), [""; 0]);
    assert_eq!(names(&bake(&["--overlap", "2"])), all);
    assert_eq!(names(&bake(&[])), all);
    // They are the same by another name of their folder.
    let here = fs::canonicalize(folder.path("tex")).unwrap();
    let tiles = ["--neighbours", "t_{x}_{y}_height.png", "--edge", "clamp", "--filter", "sobel"];
    let run = folder.run(&[&["bake", here.to_str().unwrap(), "--out", "out"], &tiles[..]].concat()).ends(0);
    assert!(run.stdout.lines().last().unwrap().starts_with("0 of 4 files baked, 4 fresh; "), "{}", run.stdout);
    // Tiles by themselves.
    assert_eq!(names(&baked(&folder, &["--edge", "clamp", "--filter", "sobel"])), all);
}
