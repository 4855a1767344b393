//! Interrupts of a run whose words nobody reads.

use super::paused::Paused;
use super::watched::{PAUSE, reaches};
use crate::cli::support::{Folder, bumps8};
use std::process::Command;

/// A bake of three textures that nobody listens to: it waits at the line of the first one, its report open.
struct Unheard {
    folder: Folder,
    run: Paused,
}

impl Unheard {
    const ARGUMENTS: [&str; 8] = ["bake", "tex", "--out", "out", "--jobs", "1", "--report", "out/r.json"];

    fn spawn() -> Self {
        let folder = Folder::new();
        for name in ["a", "b", "c"] {
            folder.grey8(&format!("tex/{name}_height.png"), 9, 9, bumps8);
        }
        let mut run = Paused::spawn(folder.command(&Self::ARGUMENTS));
        assert!(reaches(&mut run.child, PAUSE, || folder.path("out/a_normal.png").exists()), "it ended");
        Self { folder, run }
    }

    fn send(&mut self, signal: &str) {
        assert!(self.run.child.try_wait().unwrap().is_none());
        assert!(Command::new("kill").args([signal, &self.run.child.id().to_string()]).status().unwrap().success());
    }

    /// Waits until it has taken note of an interrupt: then a thread is about to say so.
    fn wait_until_interrupted(&mut self) {
        let threads = format!("/proc/{}/task", self.run.child.id());
        let name = |thread: std::fs::DirEntry| std::fs::read_to_string(thread.path().join("comm")).unwrap_or_default();
        let is_interrupted =
            || std::fs::read_dir(&threads).unwrap().any(|thread| name(thread.unwrap()) == "interrupt\n");
        assert!(reaches(&mut self.run.child, PAUSE, is_interrupted), "it ended");
    }
}

#[test]
fn an_interrupt_lets_what_is_done_be_told() {
    for signal in ["-INT", "-TERM"] {
        let mut bake = Unheard::spawn();
        bake.send(signal);
        bake.wait_until_interrupted();
        let run = bake.run.go_on().ends(130);
        run.line("interrupted: what is being written is dropped");
        assert!(run.stdout.contains("1 of 3 files baked, 2 not begun; "), "{}", run.stdout);
        assert_eq!(bake.folder.json("out/r.json")["totals"]["not_begun"], 2);
        assert_eq!(bake.folder.files("out"), ["a_normal.png", "r.json"]);
    }
}

#[test]
fn a_second_interrupt_ends_the_run_at_once() {
    for signals in [["-INT", "-INT"], ["-TERM", "-INT"]] {
        let mut bake = Unheard::spawn();
        bake.send(signals[0]);
        bake.wait_until_interrupted();
        // Nobody listens yet: it can neither go on nor end cleanly.
        bake.send(signals[1]);
        assert!(!reaches(&mut bake.run.child, PAUSE, || false));
        assert_eq!(bake.run.child.wait().unwrap().code(), Some(130));
        let files = bake.folder.files("out");
        assert_eq!(files.len(), 2, "the report that was open is left: {files:?}");
        bake.folder.run(&[&Unheard::ARGUMENTS[..], &["--quiet"]].concat()).ends(0);
        assert_eq!(bake.folder.files("out"), ["a_normal.png", "b_normal.png", "c_normal.png", "r.json"]);
    }
}
