//! A run that was killed goes on where it stopped.

use super::support::{contents, lines, record, results, results_of};
use crate::cli::support::{Folder, Run, bumps8};
use crate::faults::watched::{PAUSE, reaches};
use std::collections::{BTreeMap, BTreeSet};
use std::process::{Command, Stdio};
use std::time::Duration;

const TEXTURES: usize = 40;
const BOTH: [&str; 4] = ["--maps", "normal,parallax", "--scale", "5"];

#[test]
fn what_was_complete_is_not_baked_again_and_all_bytes_are_those_of_a_clean_run() {
    let folder = Folder::new();
    for index in 0..TEXTURES {
        folder.grey8(&format!("tex/t{index:02}_height.png"), 160, 120 + index, bumps8);
    }
    results_of(&folder, &BOTH, 0);
    let clean = contents(&folder);
    assert_eq!(clean.len(), 2 * TEXTURES);

    let mut interrupted = 0;
    // At another moment each time: when the record has so many lines.
    for moment in [1, 7, 15, 22, 30, 2, 11, 26, 4, 18] {
        if interrupted == 5 {
            break;
        }
        std::fs::remove_dir_all(folder.path("out")).unwrap();
        let arguments = [&["bake", "tex", "--out", "out", "-q", "--jobs", "2"], &BOTH[..]].concat();
        let mut child = folder.command(&arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let is_time = || {
            let text = std::fs::read(record(&folder)).unwrap_or_default();
            text.iter().filter(|byte| **byte == b'\n').count() > moment
        };
        if reaches(&mut child, Duration::ZERO, is_time) {
            child.kill().unwrap();
        }
        // A machine that is done before gets another try.
        if child.wait().unwrap().success() {
            continue;
        }
        interrupted += 1;

        let remembered: BTreeSet<String> = lines_without_the_torn_one(&folder);
        let there = contents(&folder);
        assert!(remembered.len() >= moment && remembered.len() < TEXTURES, "{}", remembered.len());
        let is_complete =
            |stem: &str| ["normal", "parallax"].iter().all(|map| there.contains_key(&format!("{stem}_{map}.png")));
        assert!(remembered.iter().all(|stem| is_complete(stem)), "what is remembered is complete");
        let results: BTreeMap<String, String> = results_of(&folder, &BOTH, 0);
        for (stem, result) in &results {
            assert_eq!(result == "fresh", remembered.contains(stem), "{stem}: {result}");
        }
        let mut after = contents(&folder);
        after.retain(|name, _| !name.starts_with(".texbake-"));
        assert!(after == clean);
        assert!(results_of(&folder, &BOTH, 0).values().all(|result| result == "fresh"));
    }
    assert_eq!(interrupted, 5);
}

/// The stems of the textures of which the record has a whole line.
fn lines_without_the_torn_one(folder: &Folder) -> BTreeSet<String> {
    let text = std::fs::read_to_string(record(folder)).unwrap();
    let whole = &text[..=text.rfind('\n').unwrap()];
    std::fs::write(record(folder), whole).unwrap();
    let stem = |line: serde_json::Value| {
        line["outputs"][0]["name"].as_str().unwrap().strip_suffix("_normal.png").unwrap().to_owned()
    };
    lines(folder).into_iter().map(stem).collect()
}

/// An interrupt while files are compared: nothing is baked, and none is called changed.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_comparison_knows_nothing() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 9, 8, bumps8);
    folder.grey8("tex/b_height.png", 9, 8, bumps8);
    results_of(&folder, &[], 0);
    let before = (contents(&folder), std::fs::read(record(&folder)).unwrap());
    // A hole that takes minutes to read.
    let large = folder.path("tex/a_height.png").canonicalize().unwrap();
    std::fs::File::options().write(true).open(&large).unwrap().set_len(1 << 39).unwrap();
    for arguments in [&["--dry-run"][..], &[]] {
        let bake = [&["bake", "tex", "--out", "out", "--report", "r.json"], arguments].concat();
        let mut child = folder.command(&bake).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let open_files = format!("/proc/{}/fd", child.id());
        let reads = || {
            let mut files = std::fs::read_dir(&open_files).into_iter().flatten().flatten();
            files.any(|file| std::fs::read_link(file.path()).is_ok_and(|path| path == large))
        };
        assert!(reaches(&mut child, PAUSE, reads));
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let run = Run::from(child.wait_with_output().unwrap()).ends(130);
        assert!(
            run.stderr.contains("interrupted: ") && !run.stdout.contains("changed"),
            "{}{}",
            run.stdout,
            run.stderr
        );
        let results = results(&folder.json("r.json"));
        assert_eq!(results["a"], "not_begun: interrupted before it was known");
        assert_eq!(results["b"], "fresh");
        assert!((contents(&folder), std::fs::read(record(&folder)).unwrap()) == before);
    }
}
