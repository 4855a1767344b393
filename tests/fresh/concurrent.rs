//! Processes that bake into one folder at once.

use super::support::{contents, lines, results_of};
use crate::cli::support::{Folder, Run, bumps8};
use std::collections::{BTreeMap, BTreeSet};
use std::process::{Child, Stdio};

/// Many small textures.
fn folder_of(textures: usize) -> Folder {
    let folder = Folder::new();
    for index in 0..textures {
        folder.grey8(&format!("tex/t{index:02}_height.png"), 5, 5, |x, y| bumps8(x, y) ^ index as u8);
    }
    folder
}

fn start(folder: &Folder, scale: &str, paths: &[String]) -> Child {
    let mut arguments = vec!["bake", "--out", "out", "--scale", scale, "-q", "--force"];
    arguments.extend(paths.iter().map(String::as_str));
    folder.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

#[track_caller]
fn end(bakes: impl IntoIterator<Item = Child>) {
    // All are awaited before any is judged.
    let ends: Vec<_> = bakes.into_iter().map(|bake| bake.wait_with_output().unwrap()).collect();
    ends.into_iter().for_each(|output| assert_eq!(Run::from(output).ends(0).stderr, ""));
}

#[test]
fn processes_share_a_record() {
    const TEXTURES: usize = 60;
    let folder = folder_of(TEXTURES);
    for round in 0..4 {
        // Two bake all, and two a half each; in odd rounds the record is rewritten at the beginning too.
        let scale = (2 + round / 2).to_string();
        let of_parity = |parity: usize| {
            let indices = (0..TEXTURES).filter(move |index| index % 2 == parity);
            indices.map(|index| format!("tex/t{index:02}_height.png")).collect::<Vec<_>>()
        };
        let all = || vec!["tex".to_owned()];
        end([all(), of_parity(1), of_parity(0), all()].map(|paths| start(&folder, &scale, &paths)));
        // Each line is whole, and each texture has one.
        let names: BTreeSet<String> =
            lines(&folder).iter().map(|line| line["outputs"][0]["name"].to_string()).collect();
        assert_eq!((names.len(), contents(&folder).len()), (TEXTURES, TEXTURES));
        let results = results_of(&folder, &["--scale", &scale], 0);
        assert!(results.values().all(|result| result == "fresh"), "{results:?}");
    }
}

/// Each replaces the other's files: between the moment at which one gave a file its name and that at which it remembers
/// it, the file may be the other's.
#[test]
fn what_is_remembered_is_what_was_written() {
    const TEXTURES: usize = 40;
    let folder = folder_of(TEXTURES);
    let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex().to_string();
    let hashes = || contents(&folder).into_iter().map(|(name, bytes)| (name, hash(&bytes))).collect();
    let clean = ["3", "11"].map(|scale| {
        results_of(&folder, &["--scale", scale, "--force"], 0);
        let hashes: BTreeMap<String, String> = hashes();
        (scale, hashes)
    });
    let clean = BTreeMap::from(clean);
    assert!(clean["3"].iter().all(|(name, hash)| clean["11"][name] != *hash), "the scale decides over every map");
    for _ in 0..6 {
        let paths = ["tex".to_owned()];
        end(["3", "11", "3", "11"].map(|scale| start(&folder, scale, &paths)));
        for line in lines(&folder) {
            let (scale, output) = (line["options"]["scale"].as_str().unwrap(), &line["outputs"][0]);
            assert_eq!(output["hash"], *clean[scale][output["name"].as_str().unwrap()], "scale {scale}: {output}");
        }
        // So what counts as fresh is.
        let results = results_of(&folder, &["--scale", "3"], 0);
        assert!(results.values().all(|result| result == "fresh" || result.starts_with("baked: ")), "{results:?}");
        let found: BTreeMap<String, String> = hashes();
        assert!(found == clean["3"]);
    }
}
