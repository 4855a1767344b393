//! An interrupt ends a run cleanly.

#![cfg(unix)]

use super::support::{Folder, Run, read_png};
use std::process::{Command, Stdio};

/// So many that no machine is done before the signal comes.
const FILES: usize = 400;

#[test]
fn an_interrupted_folder_leaves_whole_files_and_says_what_is_missing() {
    let folder = Folder::new();
    let heights: Vec<u8> = (0..1u32 << 20).map(|i| (i.wrapping_mul(2654435761) >> 24) as u8).collect();
    let file = folder.file("tex/m0_height.raw", heights);
    for index in 1..FILES {
        std::fs::hard_link(&file, folder.path(&format!("tex/m{index}_height.raw"))).unwrap();
    }
    let arguments = ["bake", "tex", "--out", "out", "--raw", "1024x1024:u8", "--report", "report.json"];
    let mut command = folder.command(&arguments);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !folder.files("out").iter().any(|file| file.ends_with(".png")) {
        std::thread::yield_now();
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let run = Run::from(child.wait_with_output().unwrap()).ends(130);

    let outputs = folder.files("out");
    assert!(outputs.iter().all(|file| file.ends_with("_normal.png")), "{outputs:?}");
    for output in &outputs {
        let (width, height, codes) = read_png(&folder.path("out").join(output));
        assert_eq!((width, height, codes.as_ref().len()), (1024, 1024, 3 << 20));
    }
    assert!(run.stderr.contains("interrupted: "), "{}", run.stderr);
    let summary = run.stdout.lines().last().unwrap();
    assert!(summary.starts_with(&format!("{} of {FILES} files baked, ", outputs.len())), "{summary}");
    assert!(summary.contains(" not begun; "), "{summary}");

    let report = folder.json("report.json");
    let count = |key: &str| report["totals"][key].as_u64().unwrap() as usize;
    assert_eq!((count("baked"), count("failed")), (outputs.len(), 0));
    assert_eq!(count("baked") + count("stopped") + count("not_begun"), FILES);
    let not_begun = report["files"].as_array().unwrap().iter().filter(|file| file["result"] == "not_begun");
    assert_eq!(not_begun.count(), count("not_begun"));
}

#[test]
fn an_interrupted_file_leaves_nothing() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    // A machine that is done before the signal comes gets more to do.
    for rows in [4096u64, 16384, 65536] {
        std::fs::File::create(folder.path("heights.raw")).unwrap().set_len(4096 * rows).unwrap();
        let layout = format!("4096x{rows}:u8");
        let mut command = folder.command(&["normal", "heights.raw", "--raw", &layout, "-o", "out/normal.png"]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        while folder.files("out").is_empty() {
            std::thread::yield_now();
        }
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        if output.status.code() == Some(0) {
            std::fs::remove_file(folder.path("out/normal.png")).unwrap();
            continue;
        }
        let run = Run::from(output).ends(130);
        assert!(run.stderr.ends_with("heights.raw was not baked\n"), "{}", run.stderr);
        assert_eq!(folder.files("out"), [""; 0]);
        return;
    }
    panic!("no run was interrupted");
}
