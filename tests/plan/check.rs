//! Plans that are baked and measured again, and those that are broken on purpose.

use super::{plan, scene, wave};
use crate::cli::support::{Folder, Run, bumps16, png, read_png};
use texbake::plan::predictions;
use texbake::stream::Monitor;
use texbake::{Channels, Codes, Convention, Depth, Encoding, Error, Maps, NormalFormat, NormalMap, Size};

/// Waves that get both maps, noise that gets a normal map, and a flat map that gets none; in folders, and in brackets.
fn textures() -> Folder {
    let folder = Folder::new();
    folder.grey16("tex/wave_h.png", 64, 64, wave);
    folder.grey16("tex/sub/wave_h.png", 64, 64, |x, y| wave(y, x));
    folder.grey16("tex/sub/[a]_h.png", 32, 32, bumps16);
    folder.grey8("tex/flat_h.png", 16, 16, |_, _| 128);
    let materials = "scale = 8\nview = { angle = 60 }\n[[material]]\nfiles = '*a]_h.png'\nscale = 3\nview = { angle = 80 }\nedge = 'clamp'\n\
                     [[material]]\nfiles = 'sub/wave_*'\nscale = 4\nformat = 'tif'\nview = { texels-per-pixel = 2 }";
    folder.file("scene.toml", "folder = 'tex'\n".to_owned() + &scene("normal = 0.3\nparallax = 0.6", materials));
    folder.run(&["plan", "scene.toml", "-o", "texbake.toml"]).ends(0);
    folder
}

fn bake(folder: &Folder, more: &[&str]) -> Run {
    folder.run(&[&["bake", "tex", "--config", "texbake.toml", "--out", "out"][..], more].concat())
}

/// Plans, bakes, changes something, and checks that the check tells it of `file` in these words.
#[track_caller]
fn assert_broken(sabotage: impl FnOnce(&Folder), check: &[&str], file: &str, parts: &[&str]) {
    let folder = textures();
    bake(&folder, &["--backend", "cpu", "-q"]).ends(0);
    sabotage(&folder);
    let run = bake(&folder, check).ends(1);
    let told = run.stderr.lines().find(|line| line.starts_with("error: plan broken: ") && line.contains(file));
    let told = told.unwrap_or_else(|| panic!("nothing about {file} in {}", run.stderr));
    for part in parts {
        assert!(told.contains(part), "{part:?} is not in {told}");
    }
}

fn change(folder: &Folder, from: &str, to: &str) {
    let text = std::fs::read_to_string(folder.path("texbake.toml")).unwrap();
    assert!(text.contains(from), "{from:?} is not in {text}");
    folder.file("texbake.toml", text.replacen(from, to, 1));
}

#[test]
fn predictions_hold_on_every_backend() {
    let folder = textures();
    let mut backends = vec![vec!["--backend", "reference"], vec!["--backend", "cpu"]];
    if cfg!(feature = "gpu") && std::env::var("TEXBAKE_REQUIRE_GPU").is_ok_and(|value| value == "1") {
        backends.push(vec!["--adapter", "vulkan:llvmpipe"]);
    }
    for backend in backends {
        let run = bake(&folder, &[&["--check-plan"][..], &backend].concat()).ends(0);
        assert!(run.stdout.ends_with("the plan holds: 4 height maps\n"), "{}", run.stdout);
        let files = folder.files("out");
        let expected = ["sub/[a]_normal.png", "sub/wave_normal.tif", "wave_normal.png", "wave_parallax.png"];
        assert_eq!(files.iter().filter(|file| !file.contains("sub/wave_parallax")).collect::<Vec<_>>(), expected);
        std::fs::remove_dir_all(folder.path("out")).unwrap();
    }
}

#[test]
fn settings_are_read_as_they_were_written() {
    let folder = textures();
    let text = std::fs::read_to_string(folder.path("scene.toml")).unwrap();
    let plan = plan(&folder, &text).unwrap();
    let settings = plan.settings().unwrap();
    let read = predictions("texbake.toml".as_ref(), &settings).unwrap();
    let expected: Vec<_> = plan.files.iter().map(|file| file.prediction.clone()).collect();
    assert_eq!(read, expected);
    assert_eq!(read.len(), 4);
    // Each file has one override, found by its own glob, those in folders last.
    let globs: Vec<&str> = settings.lines().filter_map(|line| line.strip_prefix("glob = ")).collect();
    assert_eq!(globs.len(), 4);
    assert_eq!(globs[2..], ["\"sub/[[]a[]]_h.png\"", "\"sub/wave_h.png\""]);
    // Every choice is a comment before it.
    for file in &plan.files {
        for decision in &file.decisions {
            assert!(settings.contains(&format!("# {}: {};", decision.topic, decision.choice)), "{settings}");
        }
    }
}

#[test]
fn only_a_check_bakes_nothing() {
    let folder = textures();
    bake(&folder, &["-q"]).ends(0);
    let before = std::fs::metadata(folder.path("out/wave_normal.png")).unwrap().modified().unwrap();
    bake(&folder, &["--check-plan=only", "-q"]).ends(0);
    assert_eq!(std::fs::metadata(folder.path("out/wave_normal.png")).unwrap().modified().unwrap(), before);
}

#[test]
fn other_bits_than_planned_are_noticed() {
    let change_bits = |folder: &Folder| change(folder, "bits = 8\nchannels = \"xy\"", "bits = 16\nchannels = \"xy\"");
    let parts = ["16 bits xy, ", "; predicted png of ", " 8 bits xy, "];
    assert_broken(change_bits, &["--check-plan", "-q"], "_normal.png", &parts);
}

#[test]
fn another_scale_is_noticed() {
    let change_scale = |folder: &Folder| change(folder, "scale = 8\n", "scale = 6\n");
    let parts = ["normals are off by ", " at most, ", " predicted"];
    assert_broken(change_scale, &["--check-plan", "-q"], "out/wave_normal.png", &parts);
    let parts = ["its values, from -1 to 1, are off by ", " predicted"];
    // Of steeper relief n_z is smaller.
    let change_scale = |folder: &Folder| change(folder, "scale = 8\n", "scale = 60\n");
    assert_broken(change_scale, &["--check-plan", "-q"], "out/wave_parallax.png", &parts);
}

#[test]
fn another_resolution_or_component_is_noticed() {
    let shrink = |folder: &Folder| {
        change(
            folder,
            "scale = 8\nfilter = \"central\"\nedge = \"wrap\"\nconvention = \"gl\"\ncolor-space = \"linear\"\nshrink = 1",
            "scale = 8\nshrink = 2",
        )
    };
    assert_broken(
        shrink,
        &["--check-plan", "-q"],
        "out/wave_normal.png",
        &["png of 32 x 32", "predicted png of 64 x 64"],
    );
    let channels = |folder: &Folder| change(folder, "channels = \"xy\"", "channels = \"xyz\"");
    assert_broken(channels, &["--check-plan", "-q"], "_normal.png", &[" bits xyz, ", " bits xy, "]);
}

#[test]
fn maps_that_were_replaced_damaged_or_removed_are_noticed() {
    let only = ["--check-plan=only", "-q"];
    let replace = |folder: &Folder| {
        folder.grey16("other_h.png", 64, 64, |x, y| wave(x + 32, y));
        let codes = ["--channels", "xy", "--scale", "8", "--encoding", "biased", "-q"];
        folder.run(&[&["normal", "other_h.png", "-o", "out/wave_normal.png"][..], &codes].concat()).ends(0);
    };
    assert_broken(replace, &only, "out/wave_normal.png", &["normals are off by "]);
    let damage = |folder: &Folder| _ = folder.file("out/wave_parallax.png", "no image");
    assert_broken(damage, &only, "out/wave_parallax.png", &["no format that texbake knows"]);
    let remove = |folder: &Folder| std::fs::remove_file(folder.path("out/wave_normal.png")).unwrap();
    assert_broken(remove, &only, "out/wave_normal.png", &["No such file"]);
}

#[test]
fn texels_without_a_direction_and_single_wrong_texels_are_noticed() {
    let only = ["--check-plan=only", "-q"];
    let folder = Folder::new();
    // Too steep for two components.
    folder.grey8("tex/blocks_h.png", 64, 64, |x, y| if (x / 8 + y / 8) % 2 == 0 { 0 } else { 255 });
    folder.file("scene.toml", "folder = 'tex'\n".to_owned() + &scene("normal = 1.5\nparallax = 99", "scale = 16"));
    folder.run(&["plan", "scene.toml", "-o", "texbake.toml"]).ends(0);
    let text = std::fs::read_to_string(folder.path("texbake.toml")).unwrap();
    folder.file("texbake.toml", text.replace("encoding = \"unorm\"", "encoding = \"biased\""));
    // Biased codes of 128 are zero: no vector at all.
    let grey = png(64, 64, ::png::ColorType::Rgb, ::png::BitDepth::Eight, &[128; 3 * 64 * 64]);
    std::fs::create_dir_all(folder.path("out")).unwrap();
    folder.file("out/blocks_normal.png", grey);
    bake(&folder, &only).ends(1).says("error: plan broken: ", &["blocks_normal.png", "normals are off by 180 degrees"]);

    let one_texel = |folder: &Folder| {
        let (width, height, Codes::U8(mut codes)) = read_png(&folder.path("out/wave_parallax.png")) else {
            panic!("it has 8 bits")
        };
        codes[5 * 64 + 17] = 255 - codes[5 * 64 + 17];
        let changed = png(width, height, ::png::ColorType::Grayscale, ::png::BitDepth::Eight, &codes);
        folder.file("out/wave_parallax.png", changed);
    };
    let parts = ["its values, from -1 to 1, are off by ", " predicted"];
    assert_broken(one_texel, &only, "out/wave_parallax.png", &parts);
}

#[test]
fn floats_that_are_no_numbers_are_noticed() {
    let folder = Folder::new();
    folder.grey16("wave_h.png", 64, 64, wave);
    folder.file("scene.toml", scene("normal = 0.0001\nparallax = 9", "scale = 2\nformat = 'exr'"));
    folder.run(&["plan", "scene.toml", "-o", "texbake.toml"]).ends(0);
    let bake =
        |more: &[&str]| folder.run(&[&["bake", ".", "--config", "texbake.toml", "--out", "out"][..], more].concat());
    bake(&["--check-plan", "-q"]).ends(0);
    for value in [f32::NAN, 0.0, f32::INFINITY] {
        let format = NormalFormat {
            encoding: Encoding::Float,
            depth: Depth::Float32,
            channels: Channels::Xy,
            convention: Convention::Gl,
        };
        let codes = Codes::F32(vec![value; 64 * 64 * 2]);
        let map = NormalMap::new(Size::new(64, 64).unwrap(), format, codes).unwrap();
        map.write(folder.path("out/wave_normal.exr")).unwrap();
        bake(&["--check-plan=only", "-q"]).ends(1).says("error: plan broken: ", &["wave_normal.exr"]);
    }
}

#[test]
fn settings_and_predictions_that_were_changed_by_hand_are_noticed() {
    let check = ["--check-plan", "-q"];
    let precision = |folder: &Folder| change(folder, "precision = \"exact\"", "precision = \"fast\"");
    assert_broken(precision, &check, "_h.png", &["precision is fast, and the plan has exact"]);
    assert_broken(|_| (), &["--check-plan", "-q", "--precision", "fast"], "wave_h.png", &["precision is fast"]);
    let scale = |folder: &Folder| change(folder, "scale = 8\n", "scale = 8.001\n");
    assert_broken(scale, &check, "wave_h.png", &["scale is 8.001, and the plan has 8"]);
    let loosened = |folder: &Folder| {
        let text = std::fs::read_to_string(folder.path("texbake.toml")).unwrap();
        let line = text.lines().find(|line| line.starts_with("degrees = 0.")).unwrap().to_owned();
        change(folder, &line, "degrees = 90.0");
    };
    assert_broken(loosened, &check, "_h.png", &["90 degrees are predicted, and the scene allows 0.3"]);
    // A height map that came later is no error, but it is told.
    let folder = textures();
    folder.grey8("tex/new_h.png", 16, 16, |_, _| 128);
    let run = bake(&folder, &["--check-plan"]).ends(0);
    run.says("warning: tex", &["new_h.png", "the plan does not have it, and it gets no map"]);
}

#[test]
fn a_check_that_is_cancelled_says_so() {
    let folder = textures();
    let text = std::fs::read_to_string(folder.path("texbake.toml")).unwrap();
    let prediction = predictions("texbake.toml".as_ref(), &text).unwrap().remove(0);
    let (maps, monitor) = (Maps::default(), Monitor::default());
    assert!(prediction.check(&folder.path("tex").join(&prediction.file), &maps, &monitor).is_ok());
    monitor.cancel();
    let cancelled = prediction.check(&folder.path("tex").join(&prediction.file), &maps, &monitor);
    assert!(matches!(cancelled, Err(Error::Cancelled)), "{cancelled:?}");
}

#[cfg(unix)]
#[test]
fn a_name_may_have_any_character() {
    let folder = Folder::new();
    folder.grey16("tex/back\\slash_h.png", 32, 32, bumps16);
    folder.file("tex/scene.toml", scene("normal = 0.3\nparallax = 9", "scale = 3"));
    folder.run(&["plan", "tex/scene.toml", "-o", "texbake.toml"]).ends(0);
    let run = bake(&folder, &["--check-plan"]).ends(0);
    assert!(run.stdout.ends_with("the plan holds: 1 height map\n"), "{}", run.stdout);
}

#[test]
fn maps_that_were_not_planned_and_height_maps_that_changed_are_noticed() {
    let check = ["--check-plan", "-q"];
    let none =
        |folder: &Folder| change(folder, "maps = \"normal,parallax\"\nscale = 8", "maps = \"normal\"\nscale = 8");
    assert_broken(none, &check, "wave_h.png", &["a parallax map was planned, and none is baked"]);
    let more = |folder: &Folder| {
        change(folder, "glob = \"flat_h.png\"\nmaps = \"none\"", "glob = \"flat_h.png\"\nmaps = \"normal\"")
    };
    assert_broken(more, &check, "out/flat_normal.png", &["no normal map was planned, and one is baked"]);
    let bumpy = |folder: &Folder| _ = folder.grey8("tex/flat_h.png", 16, 16, |x, _| x as u8);
    assert_broken(bumpy, &check, "flat_h.png", &["without a normal map, normals are off by"]);
    let lost = |folder: &Folder| std::fs::remove_file(folder.path("tex/wave_h.png")).unwrap();
    assert_broken(lost, &check, "wave_h.png", &["the plan has this height map, and it was not found"]);
}

#[test]
fn a_check_needs_predictions() {
    let folder = textures();
    let run = folder.run(&["bake", "tex", "--out", "out", "--check-plan", "--config", "scene.toml"]).ends(2);
    assert!(run.stderr.contains("error: "), "{}", run.stderr);
    folder.file("plain.toml", "[defaults]\nscale = 3\n");
    let run = folder.run(&["bake", "tex", "--out", "out", "--check-plan", "--config", "plain.toml"]).ends(2);
    run.says("error: --check-plan", &["plain.toml has no predictions", "that texbake plan wrote"]);
    std::fs::remove_file(folder.path("texbake.toml")).unwrap();
    let run = folder.run(&["bake", "tex", "--out", "out", "--check-plan"]).ends(2);
    run.says("error: --check-plan", &["there is no settings file"]);
    // A prediction that was changed by hand is an error with its line.
    let folder = textures();
    change(&folder, "tangent-space", "tangents-space");
    let run = bake(&folder, &["--check-plan"]).ends(2);
    run.says("error: texbake.toml:", &["unknown field `tangents-space`", "run texbake plan again"]);
    for (from, to, what) in [
        ("tangent-space = \"cotangent frame\"", "tangent-space = \"frame\"", "frame: it must be tangents, cotangent"),
        ("method = \"steps ", "method = \"stairs ", "method is stairs "),
    ] {
        let folder = textures();
        change(&folder, from, to);
        bake(&folder, &["--check-plan"]).ends(2).says("error: texbake.toml:", &[what, "run texbake plan again"]);
    }
}
