//! Plans of scenes whose answers are worked out by hand, and what becomes of them when they are baked.

mod check;
mod choices;
mod command;
mod parallax;
mod scenes;

use crate::cli::support::Folder;
use texbake::plan::{Decision, FilePlan, Plan, Scene};
use texbake::stream::Monitor;
use texbake::{Baker, Result};

/// The plan of a scene, on the CPU.
fn plan(folder: &Folder, scene: &str) -> Result<Plan> {
    let path = folder.file("scene.toml", scene);
    Plan::new(&Scene::read(&path)?, &Baker::cpu(), &Monitor::default(), &mut |_| ())
}

/// The plan of a scene that shows one map.
#[track_caller]
fn plan_of_one(folder: &Folder, scene: &str) -> FilePlan {
    let mut plan = plan(folder, scene).unwrap();
    assert_eq!(plan.files.len(), 1);
    plan.files.remove(0)
}

/// The message of a scene that cannot be planned.
#[track_caller]
fn plan_error(folder: &Folder, scene: &str) -> String {
    plan(folder, scene).expect_err("it cannot be planned").to_string()
}

/// What is told of one topic.
#[track_caller]
fn decision<'a>(file: &'a FilePlan, topic: &str) -> &'a Decision {
    file.decisions.iter().find(|decision| decision.topic == topic).unwrap_or_else(|| panic!("nothing about {topic}"))
}

/// A setting of `bake`.
fn setting<'a>(file: &'a FilePlan, key: &str) -> Option<&'a str> {
    file.settings.iter().find(|(name, _)| *name == key).map(|(_, value)| value.as_str())
}

/// A scene of one material with these lines, at one texel a pixel, seen at 45 degrees.
fn scene(tolerance: &str, material: &str) -> String {
    format!(
        "[view]\ntexels-per-pixel = 1\nangle = 45\n[tolerance]\n{tolerance}\n[[material]]\nfiles = '*'\n{material}\n"
    )
}

/// One wave of 16-bit heights from 0 to 1 across 64 columns.
fn wave(x: usize, _: usize) -> u16 {
    let phase = std::f64::consts::TAU * (x as f64 + 0.5) / 64.0;
    (65_535.0 * (0.5 + 0.5 * phase.sin()) + 0.5) as u16
}
