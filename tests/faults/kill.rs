//! A killed process leaves whole files, and what else it leaves the next one removes.

use super::paused::Paused;
use super::watched::{PAUSE, reaches};
use crate::cli::support::{Folder, Run, bumps8, bumps16};
use crate::cli::tangents::{Model, sheet};
use crate::support::Random;
use serde_json::Value;
use std::collections::{BTreeMap, HashSet};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

const KILLS: usize = 20;
const SIGKILL: i32 = 9;

/// Bakes both maps of eight textures.
const BAKE: [&str; 7] = ["bake", "tex", "--out", "out", "--maps", "normal,parallax", "--quiet"];
const TEXTURES: usize = 8;

/// A seed that is printed, and can be given.
fn seeded() -> Random {
    let given = std::env::var("TEXBAKE_SEED").ok().map(|seed| seed.parse().expect("TEXBAKE_SEED is a number"));
    let seed = given.unwrap_or_else(|| std::process::id().into());
    println!("TEXBAKE_SEED={seed} repeats the moments");
    Random::new(seed)
}

fn textures(folder: &Folder) {
    for index in 0..TEXTURES {
        match index % 2 {
            0 => folder.grey8(&format!("tex/t{index}_height.png"), 300, 260 + index, bumps8),
            _ => folder.grey16(&format!("tex/t{index}_height.png"), 260, 300 + index, bumps16),
        };
    }
}

/// Every file below a folder, with its bytes.
fn contents(folder: &Folder, below: &str) -> BTreeMap<String, Vec<u8>> {
    let read = |name: String| {
        let bytes = std::fs::read(folder.path(below).join(&name)).unwrap();
        (name, bytes)
    };
    folder.files(below).into_iter().map(read).collect()
}

fn is_temporary(name: &str) -> bool {
    let name = name.rsplit('/').next().unwrap_or(name);
    name.starts_with(".texbake-") && name.ends_with(".tmp")
}

fn leftovers(folder: &Folder, below: &str) -> usize {
    folder.files(below).iter().filter(|name| is_temporary(name)).count()
}

/// Kills a run as soon as `is_time`; whether it was still running.
fn killed(folder: &Folder, arguments: &[&str], is_time: impl FnMut() -> bool) -> bool {
    let mut command = folder.command(arguments);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    // Without a pause, which would miss most of what a folder shows.
    if reaches(&mut child, Duration::ZERO, is_time) {
        child.kill().unwrap();
    }
    let status = child.wait().unwrap();
    assert!(status.success() || status.signal() == Some(SIGKILL), "{status}");
    !status.success()
}

/// When a run is killed: at an event that is looked for in its folder, for a number of attempts; after these, should a
/// busy machine have let the events pass unseen, at a random moment of the time that the last whole run took.
struct Moments {
    attempts_by_event: usize,
    whole_run: Duration,
}

impl Moments {
    fn for_attempts(attempts_by_event: usize) -> Self {
        Self { attempts_by_event, whole_run: Duration::ZERO }
    }

    /// A test of whether it is time, which asks for the event where that counts.
    fn of_attempt(
        &self,
        attempt: usize,
        random: &mut Random,
        mut is_event: impl FnMut() -> bool,
    ) -> impl FnMut() -> bool {
        let (begin, moment) = (Instant::now(), self.whole_run.mul_f64(random.below(1000) as f64 / 1000.0));
        let is_by_event = attempt < self.attempts_by_event;
        move || if is_by_event { is_event() } else { begin.elapsed() >= moment }
    }

    /// A run that nothing disturbs.
    fn whole(&mut self, run: impl FnOnce()) {
        let begin = Instant::now();
        run();
        self.whole_run = begin.elapsed();
    }
}

#[test]
fn a_killed_folder_bake_leaves_whole_files_and_the_next_completes_it() {
    let folder = Folder::new();
    textures(&folder);
    let bake_all = |scale: &str| {
        let _ = std::fs::remove_dir_all(folder.path("out"));
        folder.run(&[BAKE.as_slice(), &["--scale", scale]].concat()).ends(0);
        contents(&folder, "out")
    };
    let (before, after) = (bake_all("3"), bake_all("8"));
    assert_eq!((before.len(), after.len()), (2 * TEXTURES, 2 * TEXTURES));
    assert!(before.iter().all(|(name, bytes)| after[name] != *bytes), "another scale is another file");

    let mut random = seeded();
    let (mut kills, mut left, mut moments) = (0, 0, Moments::for_attempts(5 * KILLS));
    // Of two, one finds an empty folder and the other the maps of an earlier bake.
    for attempt in 0..10 * KILLS {
        if kills == KILLS {
            break;
        }
        std::fs::remove_dir_all(folder.path("out")).unwrap();
        let is_rebake = attempt % 2 == 1;
        for (name, bytes) in before.iter().filter(|_| is_rebake) {
            folder.file(&format!("out/{name}"), bytes);
        }
        // Each output is seen twice at most, under its temporary name and its final one.
        let moment = 1 + random.below(4 * TEXTURES as u64 - 4) as usize;
        let mut seen: HashSet<String> = folder.files("out").into_iter().collect();
        let mut events = 0;
        let arguments = [BAKE.as_slice(), &["--scale", "8"]].concat();
        let is_event = || {
            events += folder.files("out").into_iter().filter(|name| seen.insert(name.clone())).count();
            events >= moment
        };
        let was_killed = killed(&folder, &arguments, moments.of_attempt(attempt, &mut random, is_event));
        kills += usize::from(was_killed);

        for (name, bytes) in contents(&folder, "out").iter().filter(|(name, _)| !is_temporary(name)) {
            let is_old = is_rebake && before[name] == *bytes;
            assert!(is_old || after[name] == *bytes, "{name} is neither the old file nor the new one");
        }
        left += leftovers(&folder, "out");
        moments.whole(|| drop(folder.run(&arguments).ends(0)));
        assert!(contents(&folder, "out") == after, "the next bake completes it: {:?}", folder.files("out"));
    }
    assert_eq!(kills, KILLS);
    assert!(left > 0, "no kill left anything to remove");
}

#[test]
fn what_a_living_process_writes_stays() {
    let folder = Folder::new();
    textures(&folder);
    folder.file("out/.texbake-killed.tmp", "half a map");
    // It holds its report open, and waits at the line of its first texture.
    let arguments = ["bake", "tex", "--out", "out", "--jobs", "1", "--report", "out/report.json"];
    let mut first = Paused::spawn(folder.command(&arguments));
    let has_output = || folder.files("out").iter().any(|name| name.ends_with(".png"));
    assert!(reaches(&mut first.child, PAUSE, has_output), "it ended");
    assert_eq!(leftovers(&folder, "out"), 1, "its report is open, and the dead process's file gone");

    folder.file("out/.texbake-agains.tmp", "half a map");
    folder.run(&["bake", "tex", "--out", "out", "--quiet"]).ends(0);
    let temporary: Vec<String> = folder.files("out").into_iter().filter(|name| is_temporary(name)).collect();
    assert_eq!(temporary.len(), 1, "{temporary:?}");
    assert_ne!(temporary, [".texbake-agains.tmp"]);

    first.go_on().ends(0);
    assert_eq!(folder.json("out/report.json")["totals"]["baked"], TEXTURES);
    assert_eq!(leftovers(&folder, "out"), 0);
}

#[test]
fn processes_that_bake_into_one_folder_at_once_both_complete_it() {
    let folder = Folder::new();
    textures(&folder);
    folder.run(&BAKE).ends(0);
    let expected = contents(&folder, "out");
    for _ in 0..5 {
        std::fs::remove_dir_all(folder.path("out")).unwrap();
        for index in 0..20 {
            folder.file(&format!("out/.texbake-dead{index:02}.tmp"), "half a map");
        }
        let bakes: Vec<_> = (0..3)
            .map(|_| folder.command(&BAKE).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
            .collect();
        bakes.into_iter().for_each(|bake| drop(Run::from(bake.wait_with_output().unwrap()).ends(0)));
        assert!(contents(&folder, "out") == expected, "{:?}", folder.files("out"));
    }
}

/// A model without the names of its buffers, and their bytes.
fn model(path: &Path) -> (Value, Vec<Vec<u8>>) {
    let mut json: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let buffers = json["buffers"].as_array_mut().unwrap().iter_mut().map(|buffer| {
        let uri = buffer.as_object_mut().unwrap().remove("uri").unwrap();
        let mut bytes = std::fs::read(path.with_file_name(uri.as_str().unwrap())).unwrap();
        // What is behind its length belongs to no buffer.
        bytes.truncate(buffer["byteLength"].as_u64().unwrap() as usize);
        bytes
    });
    let buffers = buffers.collect();
    (json, buffers)
}

#[test]
fn a_model_killed_while_it_is_replaced_is_the_old_or_the_new_one() {
    let folder = Folder::new();
    folder.file("m.glb", Model::new().with("sheet", &sheet(60, 60), 0).glb());
    let arguments = |convention| ["tangents", "m.glb", "-o", "out/m.gltf", "--quiet", "--convention", convention];
    let path = folder.path("out/m.gltf");
    folder.run(&arguments("dx")).ends(0);
    let before = model(&path);
    let old = contents(&folder, "out");
    folder.run(&arguments("gl")).ends(0);
    let after = model(&path);
    assert_eq!(folder.files("out"), ["m.bin", "m.gltf"]);
    assert!(before != after, "the other convention is another model");

    let mut random = seeded();
    let (mut kills, mut moments) = (0, Moments::for_attempts(30 * KILLS));
    for attempt in 0..50 * KILLS {
        if kills == KILLS {
            break;
        }
        std::fs::remove_dir_all(folder.path("out")).unwrap();
        old.iter().for_each(|(name, bytes)| drop(folder.file(&format!("out/{name}"), bytes)));
        // From the first temporary file on, some looks at the folder.
        let looks = random.below(40);
        let mut looked = 0;
        let is_event = || {
            looked += u64::from(looked > 0 || leftovers(&folder, "out") > 0);
            looked > looks
        };
        let was_killed = killed(&folder, &arguments("gl"), moments.of_attempt(attempt, &mut random, is_event));
        kills += usize::from(was_killed);
        let found = model(&path);
        assert!(found == before || found == after, "neither the old model nor the new one: {:?}", folder.files("out"));
        moments.whole(|| drop(folder.run(&arguments("gl")).ends(0)));
        assert!(model(&path) == after);
        assert_eq!(folder.files("out"), ["m.bin", "m.gltf"]);
    }
    assert_eq!(kills, KILLS);
}
