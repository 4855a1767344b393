//! A thousand textures, a bad one in each hundred.

use super::support::{contents, results_of};
use crate::cli::support::{Folder, bumps8};

const TEXTURES: usize = 1000;

fn is_bad(index: usize) -> bool {
    index % 100 == 37
}

#[test]
fn of_a_thousand_textures_the_bad_ones_fail_and_are_tried_again() {
    let folder = Folder::new();
    for index in 0..TEXTURES {
        let name = format!("tex/{}/t{index:03}_height.png", index % 7);
        folder.grey8(&name, 3, 2, |x, y| bumps8(x, y) ^ index as u8);
        match index {
            // Cut short, and not an image at all.
            _ if is_bad(index) && index % 200 < 100 => {
                let bytes = std::fs::read(folder.path(&name)).unwrap();
                folder.file(&name, &bytes[..bytes.len() / 2]);
            }
            _ if is_bad(index) => drop(folder.file(&name, "no image")),
            _ => {}
        }
    }
    let first = results_of(&folder, &[], 1);
    assert_eq!(first.len(), TEXTURES);
    for (name, result) in &first {
        let index: usize = name[1..].parse().unwrap();
        assert_eq!(result, if is_bad(index) { "failed: new" } else { "baked: new" }, "{name}");
    }
    let maps = contents(&folder);
    assert_eq!(maps.len(), TEXTURES - TEXTURES / 100);

    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(1);
    let failed: Vec<&str> = run.stderr.lines().collect();
    assert!(failed.len() == TEXTURES / 100 && failed.iter().all(|line| line.contains("failed tex/")), "{}", run.stderr);
    for index in (0..TEXTURES).filter(|index| is_bad(*index)) {
        run.line(&format!("t{index:03}_height.png"));
    }
    let summary = run.stdout.lines().last().unwrap();
    assert!(summary.starts_with("0 of 1000 files baked, 990 fresh, 10 failed; "), "{summary}");
    let table: Vec<&str> = run.stdout.lines().collect();
    assert_eq!((table[0], table.len()), ("of 1000 files 10 not baked:", 13));
    assert!(contents(&folder) == maps);

    // One is mended.
    folder.grey8("tex/2/t037_height.png", 3, 2, bumps8);
    let third = results_of(&folder, &[], 1);
    let count = |kind: &str| third.values().filter(|result| result.starts_with(kind)).count();
    assert_eq!([count("baked"), count("fresh"), count("failed")], [1, 990, 9]);
    assert_eq!(third["t037"], "baked: new");
}
