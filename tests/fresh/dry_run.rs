//! What would be baked is told, and nothing else is done.

use super::support::{baked, record, results, textures};
use crate::cli::support::{Folder, RECORD};
use std::fs;
use std::path::Path;
use std::time::SystemTime;

/// Each file and folder below `folder`, with its time and its bytes.
fn state(folder: &Path) -> Vec<(String, SystemTime, Vec<u8>)> {
    let mut found = Vec::new();
    let mut entries: Vec<_> = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let bytes = if path.is_file() { fs::read(&path).unwrap() } else { Vec::new() };
        found.push((path.display().to_string(), fs::metadata(&path).unwrap().modified().unwrap(), bytes));
        found.extend(state(&path));
    }
    found
}

#[track_caller]
fn told(folder: &Folder, arguments: &[&str], expected: &[&str]) {
    let before = state(&folder.path("."));
    let run = folder.run(&[&["bake", "tex", "--out", "out", "--dry-run"], arguments].concat()).ends(0);
    assert_eq!(run.stdout.lines().collect::<Vec<_>>(), expected);
    assert!(state(&folder.path(".")) == before, "{:?}", folder.files("."));
}

#[test]
fn reasons_are_told_and_nothing_is_written() {
    let folder = textures();
    let [a, b, c] = ["a", "b", "sub/c"].map(|stem| format!("tex/{stem}_height.png -> out/{stem}_normal.png"));
    let all = |what: &str, summary: &str| {
        let why = what.strip_prefix("bake").map_or(String::new(), |why| format!(":{why}"));
        let first = what.split(' ').next().unwrap();
        [&a, &b, &c]
            .map(|files| format!("{first} {files}{why}"))
            .into_iter()
            .chain([summary.to_owned()])
            .collect::<Vec<_>>()
    };
    let check = |arguments: &[&str], expected: Vec<String>| {
        told(&folder, arguments, &expected.iter().map(String::as_str).collect::<Vec<_>>());
    };
    check(&[], all("bake new", "3 of 3 files would be baked"));
    assert!(!folder.path("out").exists());
    assert_eq!(baked(&folder, &["--scale", "8"]).len(), 3);
    check(&["--scale", "8"], all("fresh", "0 of 3 files would be baked, 3 fresh"));
    check(
        &["--scale", "24", "--edge", "clamp"],
        all("bake edge wrap -> clamp, scale 8 -> 24", "3 of 3 files would be baked"),
    );
    check(&["--scale", "8", "--force"], all("bake forced", "3 of 3 files would be baked"));
    check(&["-q"], Vec::new());

    fs::write(folder.path("out/a_normal.png"), "mine").unwrap();
    fs::remove_file(folder.path("out/b_normal.png")).unwrap();
    let expected = vec![
        format!("bake {a}: out/a_normal.png was edited"),
        format!("bake {b}: out/b_normal.png is missing"),
        format!("fresh {c}"),
        "2 of 3 files would be baked, 1 fresh".to_owned(),
    ];
    check(&["--scale", "8"], expected);
    fs::remove_file(record(&folder)).unwrap();
    let expected = vec![
        format!("bake {a}: out/a_normal.png is there, and not in the record"),
        format!("bake {b}: new"),
        format!("bake {c}: out/sub/c_normal.png is there, and not in the record"),
        "3 of 3 files would be baked".to_owned(),
    ];
    check(&["--scale", "8"], expected);
}

#[test]
fn a_report_is_written_if_it_is_asked_for() {
    let folder = textures();
    folder.run(&["bake", "tex/a_height.png", "--out", "out", "-q"]).ends(0);
    let before = fs::read(record(&folder)).unwrap();
    folder.run(&["bake", "tex", "--out", "out", "--dry-run", "-q", "--report", "r.json"]).ends(0);
    let results = results(&folder.json("r.json"));
    assert_eq!([&results["a"], &results["b"], &results["c"]], ["fresh", "not_begun: new", "not_begun: new"]);
    assert!(fs::read(record(&folder)).unwrap() == before);
    assert_eq!(
        folder.files("."),
        ["out/a_normal.png", "r.json", "tex/a_height.png", "tex/b_height.png", "tex/sub/c_height.png"]
    );
}

#[test]
fn clashes_are_told() {
    let folder = textures();
    fs::copy(folder.path("tex/a_height.png"), folder.path("tex/a_disp.png")).unwrap();
    let run = folder.run(&["bake", "tex", "--out", "out", "--dry-run"]).ends(1);
    let failing: Vec<&str> = run.stdout.lines().filter(|line| line.starts_with("fail tex/a_")).collect();
    assert!(failing.len() == 2 && failing.iter().all(|line| line.contains("would be baked into it")), "{}", run.stdout);
    assert!(run.stdout.ends_with("2 of 4 files would be baked, 2 would fail\n"), "{}", run.stdout);
    assert!(!folder.path("out").join(RECORD).exists());
    for other in ["--watch", "--check-plan"] {
        folder
            .run(&["bake", "tex", "--out", "out", "--dry-run", other])
            .ends(2)
            .says("error: ", &["cannot be used with"]);
    }
}

#[test]
fn an_input_that_is_not_there_fails_as_in_the_run() {
    let folder = textures();
    let bake = ["bake", "tex/a_height.png", "texx", "--out", "out"];
    let run = folder.run(&[&bake[..], &["--dry-run"]].concat()).ends(1);
    let lines: Vec<&str> = run.stdout.lines().collect();
    let reason = lines[1].strip_prefix("fail texx -> out/texx_normal.png: ").unwrap();
    assert!(reason.starts_with("texx: ") && reason.ends_with("; check how its path is written"), "{reason}");
    assert_eq!(lines[2], "1 of 2 files would be baked, 1 would fail");
    folder.run(&bake).ends(1).says("failed ", &[reason]);
}
