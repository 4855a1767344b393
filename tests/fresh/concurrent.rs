//! Processes that bake into one folder at once.

use super::support::{contents, lines, results_of};
use crate::cli::support::{Folder, Run, bumps8};
use std::process::Stdio;

#[test]
fn processes_share_a_record() {
    const TEXTURES: usize = 60;
    let folder = Folder::new();
    for index in 0..TEXTURES {
        folder.grey8(&format!("tex/t{index:02}_height.png"), 5, 5, |x, y| bumps8(x, y) ^ index as u8);
    }
    for round in 0..4 {
        // Two bake all, and two a half each; in odd rounds the record is rewritten at the beginning too.
        let scale = (2 + round / 2).to_string();
        let of_parity = |parity: usize| {
            let indices = (0..TEXTURES).filter(move |index| index % 2 == parity);
            indices.map(|index| format!("tex/t{index:02}_height.png")).collect::<Vec<_>>()
        };
        let start = |paths: Vec<String>| {
            let mut arguments = vec!["bake", "--out", "out", "--scale", &scale, "-q", "--force"];
            arguments.extend(paths.iter().map(String::as_str));
            folder.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
        };
        let all = || vec!["tex".to_owned()];
        let bakes = [all(), of_parity(1), of_parity(0), all()].map(start);
        for bake in bakes {
            let run = Run::from(bake.wait_with_output().unwrap()).ends(0);
            assert_eq!(run.stderr, "");
        }
        // Each line is whole, and each texture has one.
        let names: std::collections::BTreeSet<String> =
            lines(&folder).iter().map(|line| line["outputs"][0]["name"].to_string()).collect();
        assert_eq!((names.len(), contents(&folder).len()), (TEXTURES, TEXTURES));
        let results = results_of(&folder, &["--scale", &scale], 0);
        assert!(results.values().all(|result| result == "fresh"), "{results:?}");
    }
}
