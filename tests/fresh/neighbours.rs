//! A tile is baked again with the tiles beside it, and no other is.

use super::support::{contents_of, stale};
use crate::cli::support::{Folder, bumps8};
use std::fs;

/// Texels of a tile's side.
const SIDE: usize = 6;

/// The tile in column `x`, row `y`.
fn tile(folder: &Folder, [x, y]: [usize; 2], salt: u8) {
    let code = |column: usize, row: usize| bumps8(SIDE * x + column, SIDE * y + row) ^ salt;
    folder.grey8(&format!("tex/t_{x}_{y}_height.png"), SIDE, SIDE, code);
}

/// A map of so many columns and rows of tiles.
fn tiles(columns: usize, rows: usize) -> Folder {
    let folder = Folder::new();
    (0..rows).for_each(|y| (0..columns).for_each(|x| tile(&folder, [x, y], 0)));
    folder
}

fn remove(folder: &Folder, [x, y]: [usize; 2]) {
    for name in [format!("tex/t_{x}_{y}_height.png"), format!("out/t_{x}_{y}_normal.png")] {
        fs::remove_file(folder.path(&name)).unwrap();
    }
}

/// What a run bakes, and why: `1_0 new`. The outputs are those of a clean bake then.
#[track_caller]
fn baked(folder: &Folder, more: &str) -> Vec<String> {
    let arguments = format!("--neighbours t_{{x}}_{{y}}_height.png {more}");
    let found = stale(folder, "tex", "out", &arguments);
    let _ = fs::remove_dir_all(folder.path("clean"));
    stale(folder, "tex", "clean", &arguments);
    assert!(contents_of(folder, "out") == contents_of(folder, "clean"));
    assert!(stale(folder, "tex", "out", &arguments).is_empty());
    let short = |text: &str| text.replace("tex/", "").replace("t_", "").replace("_height.png", "");
    found.iter().map(|(name, why)| short(&format!("{name} {why}"))).collect()
}

/// Those of `names` for one reason.
fn all(names: &[&str], why: &str) -> Vec<String> {
    names.iter().map(|name| format!("{name} {why}")).collect()
}

const NINE: [&str; 9] = ["0_0", "0_1", "0_2", "1_0", "1_1", "1_2", "2_0", "2_1", "2_2"];

#[test]
fn a_tile_that_changes_is_one_of_those_beside_it() {
    let folder = tiles(3, 3);
    assert_eq!(baked(&folder, "--edge clamp --filter sobel"), all(&NINE, "new"));
    tile(&folder, [1, 1], 5);
    assert_eq!(baked(&folder, "--edge clamp --filter sobel"), all(&NINE, "1_1 changed"));
    tile(&folder, [0, 0], 9);
    assert_eq!(baked(&folder, "--edge clamp --filter sobel"), all(&["0_0", "0_1", "1_0", "1_1"], "0_0 changed"));
    // The central stencil looks at no corner.
    assert_eq!(baked(&folder, "--edge clamp").len(), 9);
    tile(&folder, [1, 1], 0);
    assert_eq!(baked(&folder, "--edge clamp"), all(&["0_1", "1_0", "1_1", "1_2", "2_1"], "1_1 changed"));
    tile(&folder, [0, 0], 0);
    assert_eq!(baked(&folder, "--edge clamp"), all(&["0_0", "0_1", "1_0"], "0_0 changed"));
    // In a row that wraps, the tile at the far side is beside the last one.
    let wrapped = [
        "0_0 edge clamp -> wrap,clamp, neighbour-left edge -> 2_0",
        "0_1 edge clamp -> wrap,clamp, neighbour-left edge -> 2_1",
        "0_2 edge clamp -> wrap,clamp, neighbour-left edge -> 2_2",
        "1_0 edge clamp -> wrap,clamp",
        "1_1 edge clamp -> wrap,clamp",
        "1_2 edge clamp -> wrap,clamp",
        "2_0 edge clamp -> wrap,clamp, neighbour-right edge -> 0_0",
        "2_1 edge clamp -> wrap,clamp, neighbour-right edge -> 0_1",
        "2_2 edge clamp -> wrap,clamp, neighbour-right edge -> 0_2",
    ];
    assert_eq!(baked(&folder, "--edge wrap,clamp"), wrapped);
    tile(&folder, [0, 0], 7);
    assert_eq!(baked(&folder, "--edge wrap,clamp"), all(&["0_0", "0_1", "1_0", "2_0"], "0_0 changed"));
}

#[test]
fn a_tile_that_goes_or_appears_is_seen_by_those_beside_it() {
    let folder = tiles(3, 3);
    let bake = || baked(&folder, "--edge clamp --filter sobel");
    assert_eq!(bake(), all(&NINE, "new"));
    remove(&folder, [2, 1]);
    // Beyond a corner lies what is beyond the side of the tile above or below, or of the tile itself where there is none.
    let seen = [
        "1_0 neighbour-below-right 2_1 -> edge",
        "1_1 neighbour-right 2_1 -> edge",
        "1_2 neighbour-above-right 2_1 -> edge",
        "2_0 neighbour-below 2_1 -> edge, neighbour-below-left 1_1 -> 1_0",
        "2_2 neighbour-above 2_1 -> edge, neighbour-above-left 1_1 -> 1_2",
    ];
    assert_eq!(bake(), seen);
    tile(&folder, [2, 1], 0);
    let seen = [
        "1_0 neighbour-below-right edge -> 2_1",
        "1_1 neighbour-right edge -> 2_1",
        "1_2 neighbour-above-right edge -> 2_1",
        "2_0 neighbour-below edge -> 2_1, neighbour-below-left 1_0 -> 1_1",
        "2_1 out/2_1_normal.png is missing",
        "2_2 neighbour-above edge -> 2_1, neighbour-above-left 1_2 -> 1_1",
    ];
    assert_eq!(bake(), seen);
}

#[test]
fn a_row_of_tiles_that_wraps_ends_at_another_tile() {
    let folder = tiles(3, 1);
    assert_eq!(baked(&folder, ""), all(&["0_0", "1_0", "2_0"], "new"));
    tile(&folder, [3, 0], 0);
    assert_eq!(baked(&folder, ""), ["0_0 neighbour-left 2_0 -> 3_0", "2_0 neighbour-right 0_0 -> 3_0", "3_0 new"]);
    remove(&folder, [3, 0]);
    assert_eq!(baked(&folder, ""), ["0_0 neighbour-left 3_0 -> 2_0", "2_0 neighbour-right 3_0 -> 0_0"]);
}

#[test]
fn how_tiles_lie_beside_each_other_counts() {
    let folder = tiles(3, 1);
    assert_eq!(baked(&folder, "--edge clamp").len(), 3);
    let overlapping = [
        "0_0 neighbour-right 1_0 -> 1_0 overlapping by 1",
        "1_0 neighbour-left 0_0 -> 0_0 overlapping by 1, neighbour-right 2_0 -> 2_0 overlapping by 1",
        "2_0 neighbour-left 1_0 -> 1_0 overlapping by 1",
    ];
    assert_eq!(baked(&folder, "--edge clamp --overlap 1"), overlapping);
    assert_eq!(baked(&folder, "--edge clamp --overlap 2").len(), 3);
    let alone = stale(&folder, "tex", "out", "--edge clamp");
    assert!(alone.len() == 3 && alone.values().all(|why| why == "neighbours on -> off"), "{alone:?}");
    assert_eq!(baked(&folder, "--edge clamp"), all(&["0_0", "1_0", "2_0"], "neighbours off -> on"));
}

#[test]
fn tiles_are_the_same_by_another_name_of_their_folder() {
    let folder = tiles(2, 2);
    assert_eq!(baked(&folder, "").len(), 4);
    let here = folder.path("tex").canonicalize().unwrap();
    let mut names = vec!["./tex", "tex/", "tex/../tex", here.to_str().unwrap()];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&here, folder.path("link")).unwrap();
        names.push("link");
    }
    for name in names {
        let found = stale(&folder, name, "out", "--neighbours t_{x}_{y}_height.png");
        assert!(found.is_empty(), "{name}: {found:?}");
        let found = stale(&folder, name, "./out/", "--neighbours t_{x}_{y}_height.png");
        assert!(found.is_empty(), "{name}: {found:?}");
    }
    // One by one.
    let arguments = "tex/t_1_0_height.png ./tex/t_0_1_height.png --neighbours t_{x}_{y}_height.png";
    assert!(stale(&folder, "tex/t_0_0_height.png", "out", arguments).is_empty());
}
