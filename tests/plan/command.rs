//! The command itself: what it writes, and what it does not overwrite.

use super::{scene, wave};
use crate::cli::support::Folder;
use texbake::plan::{Plan, Scene};
use texbake::stream::Monitor;
use texbake::{Baker, Error};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.grey16("tex/wave_h.png", 64, 64, wave);
    folder.file("tex/scene.toml", scene("normal = 1\nparallax = 9", "scale = 2"));
    folder
}

#[test]
fn explain_tells_every_choice_and_the_file_has_its_reason() {
    let folder = folder();
    let run = folder.run(&["plan", "tex/scene.toml", "-o", "tex/texbake.toml", "--explain"]).ends(0);
    for topic in ["maps", "resolution", "normal map", "parallax", "precision", "tangent space"] {
        assert!(run.stdout.contains(&format!("\n  {topic}: ")), "{topic}: {}", run.stdout);
    }
    run.says("tex/texbake.toml:", &["1 height map planned", "texbake bake tex --config tex/texbake.toml"]);
    let written = std::fs::read_to_string(folder.path("tex/texbake.toml")).unwrap();
    assert!(written.starts_with("# Written by texbake plan. "), "{written}");
    // The file lies where bake looks for it.
    let run = folder.run(&["bake", "tex", "--out", "out", "--check-plan"]).ends(0);
    run.says("settings from", &["texbake.toml"]);

    let run = folder.run(&["plan", "tex/scene.toml", "-o", "new/folder/t.toml", "-q"]).ends(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    assert!(folder.path("new/folder/t.toml").exists());
}

#[test]
fn only_a_plan_is_overwritten() {
    let folder = folder();
    let plan = |more: &[&str]| folder.run(&[&["plan", "tex/scene.toml", "-o", "t.toml", "-q"][..], more].concat());
    plan(&[]).ends(0);
    plan(&[]).ends(0);
    folder.file("t.toml", "[defaults]\nscale = 24\n");
    plan(&[]).ends(1).says("error: t.toml", &["did not write this file, and would overwrite it", "--force"]);
    assert_eq!(std::fs::read_to_string(folder.path("t.toml")).unwrap(), "[defaults]\nscale = 24\n");
    plan(&["--force"]).ends(0);
    assert!(std::fs::read_to_string(folder.path("t.toml")).unwrap().contains("[[plan]]"));
    // What is read is never overwritten, nor is what is no settings file by its name.
    let run = folder.run(&["plan", "tex/scene.toml", "-o", "tex/wave_h.png", "--force"]);
    run.ends(1).says("error: tex/wave_h.png", &["settings are TOML", ".toml"]);
    let run = folder.run(&["plan", "tex/scene.toml", "-o", "tex/scene.toml", "--force"]).ends(1);
    run.says("error: tex/scene.toml", &["it is the scene itself", "-o"]);
    // A plan that fails leaves the old one.
    folder.file("tex/scene.toml", scene("normal = 1e-9\nparallax = 9", "scale = 2"));
    let before = std::fs::read(folder.path("t.toml")).unwrap();
    plan(&[]).ends(1).says("error: tex/scene.toml", &["the tolerance normal", "cannot be met", "the best is"]);
    assert!(std::fs::read(folder.path("t.toml")).unwrap() == before);
    assert_eq!(folder.files(""), ["t.toml", "tex/scene.toml", "tex/wave_h.png"]);
}

#[test]
fn help_has_every_key_and_its_scene_is_one() {
    let folder = folder();
    let help = folder.run(&["plan", "--help"]).ends(0).stdout;
    for key in [
        "folder",
        "suffix",
        "[view]",
        "distance",
        "fov",
        "resolution",
        "angle",
        "texels-per-pixel",
        "[tolerance]",
        "normal",
        "parallax",
        "parallax-99",
        "bytes-per-texel",
        "milliseconds",
        "[[material]]",
        "files",
        "scale",
        "size",
        "depth",
        "filter",
        "edge",
        "convention",
        "channel",
        "color-space",
        "raw",
        "format",
        "model",
        "Exit status",
    ] {
        assert!(help.contains(key), "{key}");
    }
    // The example of the help is read as it stands.
    let (_, rest) = help.split_once("\n  folder = ").unwrap();
    let (example, _) = rest.split_once("\nWhat is chosen").unwrap();
    folder.file("textures/walls/a_height.png", "");
    folder.file("wall.glb", "");
    folder.file("help.toml", format!("  folder = {example}"));
    let run = folder.run(&["plan", "help.toml", "-o", "t.toml"]).ends(1);
    run.says("error: help.toml:", &["no height map in textures matches cloth/*, dem_*"]);
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let folder = folder();
    let plans = ["a.toml", "b.toml"].map(|output| {
        folder.run(&["plan", "tex/scene.toml", "-o", output, "-q", "--backend", "cpu"]).ends(0);
        std::fs::read_to_string(folder.path(output)).unwrap()
    });
    assert_eq!(plans[0], plans[1]);
}

#[test]
fn a_plan_that_is_cancelled_says_so() {
    let folder = folder();
    let monitor = Monitor::default();
    monitor.cancel();
    let plan = Plan::new(&Scene::read(&folder.path("tex/scene.toml")).unwrap(), &Baker::cpu(), &monitor, &mut |_| ());
    assert!(matches!(plan, Err(Error::Cancelled)));
}

#[test]
fn the_example_scene_is_planned_and_holds() {
    let folder = Folder::new();
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let scene = format!("{examples}/scene.toml");
    let textures = format!("{examples}/textures");
    folder.run(&["plan", &scene, "-o", "plan.toml", "-q", "--backend", "cpu"]).ends(0);
    let bake = ["bake", &textures, "--config", "plan.toml", "--out", "out", "--check-plan", "--backend", "cpu"];
    let run = folder.run(&bake).ends(0);
    assert!(run.stdout.ends_with("the plan holds: 5 height maps\n"), "{}", run.stdout);
}
