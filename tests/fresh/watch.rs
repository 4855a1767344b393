//! A bake that goes on: what is saved is baked again.

use super::support::results;
use crate::cli::support::{Folder, bumps8};
use crate::faults::watched::{PAUSE, reaches};
use std::fs::{self, File};
use std::process::{Child, Command};

/// A running watch of the folder `tex`.
struct Watch<'a> {
    folder: &'a Folder,
    child: Child,
}

impl<'a> Watch<'a> {
    fn spawn(folder: &'a Folder, arguments: &[&str]) -> Self {
        let mut command = folder.command(&[&["bake", "tex", "--watch"], arguments].concat());
        let file = |name| File::create(folder.path(name)).unwrap();
        let child = command.stdout(file("stdout.txt")).stderr(file("stderr.txt")).spawn().unwrap();
        Self { folder, child }
    }

    /// Waits until something holds; fails if the watch ends before.
    #[track_caller]
    fn until(&mut self, holds: impl FnMut() -> bool) {
        assert!(reaches(&mut self.child, PAUSE, holds), "it ended: {}", self.text("stderr.txt"));
    }

    /// Waits until an output holds these bytes.
    #[track_caller]
    fn until_baked(&mut self, output: &str, expected: &[u8]) {
        let path = self.folder.path(output);
        self.until(|| fs::read(&path).is_ok_and(|bytes| bytes == expected));
    }

    /// Waits until stderr has a line with `part`, `count` times.
    #[track_caller]
    fn until_said(&mut self, part: &str, count: usize) {
        let path = self.folder.path("stderr.txt");
        self.until(|| fs::read_to_string(&path).unwrap().lines().filter(|line| line.contains(part)).count() >= count);
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path(name)).unwrap()
    }

    /// Interrupts it; its exit status.
    fn interrupted(mut self) -> Option<i32> {
        assert!(Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap().success());
        self.child.wait().unwrap().code()
    }
}

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A height map that differs by `seed`.
fn map(folder: &Folder, name: &str, seed: u8) {
    folder.grey8(name, 8, 6, |x, y| bumps8(x, y).wrapping_mul(seed));
}

/// What a bake of such a map with a scale gives.
fn expected(folder: &Folder, seed: u8, scale: &str) -> Vec<u8> {
    map(folder, "apart/h.png", seed);
    folder.run(&["normal", "apart/h.png", "-o", "apart/n.png", "--scale", scale, "-q"]).ends(0);
    fs::read(folder.path("apart/n.png")).unwrap()
}

#[test]
fn what_is_saved_is_baked() {
    let folder = Folder::new();
    map(&folder, "tex/a_height.png", 1);
    map(&folder, "tex/b_height.png", 3);
    // The outputs lie among the inputs.
    let mut watch = Watch::spawn(&folder, &["--out", "tex/out"]);
    watch.until_said("watching for changes", 1);
    assert_eq!(fs::read(folder.path("tex/out/b_normal.png")).unwrap(), expected(&folder, 3, "1"));

    // Saved in place, then by a rename.
    map(&folder, "tex/a_height.png", 5);
    watch.until_baked("tex/out/a_normal.png", &expected(&folder, 5, "1"));
    map(&folder, "apart/new.png", 7);
    fs::rename(folder.path("apart/new.png"), folder.path("tex/a_height.png")).unwrap();
    watch.until_baked("tex/out/a_normal.png", &expected(&folder, 7, "1"));

    // A new file in a new folder; a folder that goes and comes back.
    map(&folder, "tex/new/c_height.png", 9);
    watch.until_baked("tex/out/new/c_normal.png", &expected(&folder, 9, "1"));
    fs::remove_dir_all(folder.path("tex/new")).unwrap();
    map(&folder, "tex/new/c_height.png", 11);
    watch.until_baked("tex/out/new/c_normal.png", &expected(&folder, 11, "1"));

    // A file that is no image does not end it.
    fs::write(folder.path("tex/b_height.png"), "half a ma").unwrap();
    watch.until_said("failed tex/b_height.png", 1);
    map(&folder, "tex/b_height.png", 13);
    watch.until_baked("tex/out/b_normal.png", &expected(&folder, 13, "1"));

    // Settings appear, are wrong, and right again.
    folder.file("tex/texbake.toml", "[defaults]\nscale = 4\n");
    watch.until_baked("tex/out/a_normal.png", &expected(&folder, 7, "4"));
    folder.file("tex/texbake.toml", "[defaults]\nscale = \n");
    watch.until_said("error: tex/texbake.toml:2", 1);
    folder.file("tex/texbake.toml", "[defaults]\nscale = 6\n");
    watch.until_baked("tex/out/b_normal.png", &expected(&folder, 13, "6"));
    watch.until_baked("tex/out/new/c_normal.png", &expected(&folder, 11, "6"));
    assert_eq!(watch.interrupted(), Some(130));
}

#[test]
fn the_whole_folder_may_go_and_come_back() {
    let folder = Folder::new();
    map(&folder, "tex/a_height.png", 1);
    let mut watch = Watch::spawn(&folder, &["--out", "out"]);
    watch.until_said("watching for changes", 1);
    fs::remove_dir_all(folder.path("tex")).unwrap();
    watch.until_said("failed tex: No such file", 1);
    map(&folder, "tex/a_height.png", 3);
    watch.until_baked("out/a_normal.png", &expected(&folder, 3, "1"));
    map(&folder, "tex/a_height.png", 5);
    watch.until_baked("out/a_normal.png", &expected(&folder, 5, "1"));
    assert_eq!(watch.interrupted(), Some(130));
}

#[test]
fn its_own_files_do_not_wake_it_and_each_round_is_a_line() {
    let folder = Folder::new();
    map(&folder, "tex/a_height.png", 1);
    map(&folder, "tex/b_height.png", 3);
    // By their kind the outputs could be inputs.
    let arguments = ["--out", "tex", "--name", "{stem}_{map}_h", "--report", "tex/r.json", "--suffix", "_height"];
    let mut watch = Watch::spawn(&folder, &arguments);
    watch.until_said("watching for changes", 1);
    let rounds = |watch: &Watch| watch.text("stdout.txt").lines().filter(|line| line.contains("files baked")).count();
    assert_eq!(rounds(&watch), 1);
    for (round, seed) in [5, 7, 9].into_iter().enumerate() {
        map(&folder, "tex/a_height.png", seed);
        watch.until_baked("tex/a_normal_h.png", &expected(&folder, seed, "1"));
        let path = folder.path("tex/r.json");
        let reported = || {
            let report = fs::read(&path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
            report.is_some_and(|report| results(&report)["a"] == "baked: tex/a_height.png changed")
        };
        watch.until(reported);
        watch.until(|| {
            fs::read_to_string(folder.path("stdout.txt"))
                .unwrap()
                .lines()
                .filter(|line| line.contains("files baked"))
                .count()
                == round + 2
        });
        assert_eq!(results(&folder.json("tex/r.json"))["b"], "fresh");
        assert!(watch.text("stdout.txt").lines().last().unwrap().starts_with("1 of 2 files baked, 1 fresh; "));
    }
    // What others write beside the inputs is no round either; the next save shows that there was none.
    fs::write(folder.path("tex/notes.txt"), "notes").unwrap();
    fs::write(folder.path("tex/b_normal_h.png"), "edited").unwrap();
    map(&folder, "tex/b_height.png", 11);
    watch.until_baked("tex/b_normal_h.png", &expected(&folder, 11, "1"));
    assert_eq!(watch.interrupted(), Some(130));
}

const TILES: [&str; 4] = ["--neighbours", "t_{x}_{y}_height.png", "--edge", "clamp"];

/// The tiles of a row, by their seeds from the left.
fn tiles(folder: &Folder, seeds: &[u8]) {
    seeds.iter().enumerate().for_each(|(x, seed)| map(folder, &format!("tex/t_{x}_0_height.png"), *seed));
}

#[test]
fn a_tile_that_is_saved_is_baked_with_those_beside_it() {
    let folder = Folder::new();
    tiles(&folder, &[1, 3, 5, 7]);
    let mut watch = Watch::spawn(&folder, &[&["--out", "out"], &TILES[..]].concat());
    watch.until_said("watching for changes", 1);
    let output = |x: usize| format!("out/t_{x}_0_normal.png");
    let written = |x: usize| fs::metadata(folder.path(&output(x))).unwrap().modified().unwrap();
    let first = [1, 2].map(written);
    // Waits until these are what a clean bake of such a row gives.
    let mut until_baked = |seeds: &[u8], stale: &[usize]| {
        let clean = Folder::new();
        tiles(&clean, seeds);
        clean.run(&[&["bake", "tex", "--out", "out", "-q"], &TILES[..]].concat()).ends(0);
        let expected = |x: &usize| fs::read(clean.path(&output(*x))).unwrap();
        stale.iter().for_each(|x| watch.until_baked(&output(*x), &expected(x)));
    };
    // One appears, and goes.
    map(&folder, "tex/t_4_0_height.png", 23);
    until_baked(&[1, 3, 5, 7, 23], &[3, 4]);
    fs::remove_file(folder.path("tex/t_4_0_height.png")).unwrap();
    until_baked(&[1, 3, 5, 7], &[3]);
    assert_eq!([1, 2].map(written), first, "they lie further away");
    map(&folder, "tex/t_0_0_height.png", 21);
    until_baked(&[21, 3, 5, 7], &[0, 1]);
    assert_eq!(written(2), first[1]);
    assert_eq!(watch.interrupted(), Some(130));
}

/// What tiles end in is up to their template, of the command line or of the settings.
#[test]
fn tiles_without_a_picture_s_name_are_seen() {
    let template = "t_{x}_{y}.hgt";
    for in_settings in [false, true] {
        let folder = Folder::new();
        let tile = |x: usize, code: u8| folder.file(&format!("tex/t_{x}_0.hgt"), [[code; 16], [code / 2; 16]].concat());
        [1, 9].into_iter().enumerate().for_each(|(x, code)| _ = tile(x, code));
        let mut arguments = vec!["--out", "out", "--raw", "8x4:u8", "--edge", "clamp"];
        match in_settings {
            true => _ = folder.file("tex/texbake.toml", format!("[defaults]\nneighbours = '{template}'\n")),
            false => arguments.extend(["--neighbours", template]),
        }
        let mut watch = Watch::spawn(&folder, &arguments);
        watch.until_said("watching for changes", 1);
        let output = |x: usize| folder.path(&format!("out/t_{x}_0_normal.png"));
        let alone = fs::read(output(1)).unwrap();
        // One appears, and goes: the one beside it is baked again.
        tile(2, 200);
        watch.until(|| output(2).exists() && fs::read(output(1)).unwrap() != alone);
        fs::remove_file(folder.path("tex/t_2_0.hgt")).unwrap();
        watch.until_baked("out/t_1_0_normal.png", &alone);
        // It comes back.
        tile(2, 100);
        watch.until(|| fs::read(output(1)).unwrap() != alone);
        assert_eq!(watch.interrupted(), Some(130));
    }
}

#[test]
fn wrong_arguments_and_settings_end_it_at_once() {
    let folder = Folder::new();
    map(&folder, "tex/a_height.png", 1);
    let run =
        |arguments: &[&str]| folder.run(&[&["bake", "tex", "--out", "out", "--watch"], arguments].concat()).ends(2);
    run(&["--scale", "99999999"]).says("error: --scale is 99999999", &[]);
    run(&["--check-plan"]).says("error: ", &["cannot be used with"]);
    folder.file("tex/texbake.toml", "[defaults]\nscal = 4\n");
    run(&[]).says("error: tex/texbake.toml:2", &["scal is no setting"]);
}
