//! The whole program on damaged files: a result or a reason, no panic, no half file and none that nobody asked for.

use super::damage::variant;
use super::gltf::samples::models;
use super::samples::{height_maps, normal_maps, raw_maps};
use super::support::{Folder, Noise};
use std::path::Path;
use std::process::Command;

/// Variants of each file: starting a program takes longer than reading a small file.
const VARIANTS: u32 = 4;

/// Runs the program on variants of a file, which lies alone in a folder with `beside`.
#[track_caller]
fn assert_ends_well(sample: &Path, beside: &[&Path], arguments: &[&str], output: &str) {
    let whole = std::fs::read(sample).unwrap();
    let seed = whole.len() as u64;
    let mut noise = Noise(seed);
    for number in 0..VARIANTS {
        let folder = Folder::new();
        let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
        beside.iter().for_each(|path| _ = std::fs::copy(path, folder.path(&name(path))).unwrap());
        folder.file(&name(sample), &variant(&whole, &mut noise));
        let before = folder.names();

        let mut command = Command::new(env!("CARGO_BIN_EXE_texbake"));
        let done = command.args(arguments).args(["--max-bytes", "64M"]).current_dir(folder.path("")).output().unwrap();
        let stderr = String::from_utf8_lossy(&done.stderr);
        let what = format!("variant {number} of {}, seed {seed}: {stderr}", sample.display());
        assert!(!stderr.contains("panicked"), "{what}");
        let mut expected = before;
        match done.status.code() {
            Some(0) => expected.push(output.to_owned()),
            Some(1) => assert!(stderr.contains(&name(sample)) || stderr.contains("column"), "{what}"),
            status => panic!("status {status:?}: {what}"),
        }
        expected.sort();
        assert_eq!(folder.names(), expected, "{what}");
    }
}

#[test]
fn maps() {
    let folder = Folder::new();
    let flat = folder.path("flat.png");
    let mut encoder = png::Encoder::new(std::fs::File::create(&flat).unwrap(), 24, 40);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[128, 128, 255].repeat(24 * 40)).unwrap();
    for path in height_maps(&folder) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let channel = if name == "layers.exr" { "Z" } else { "r" };
        assert_ends_well(
            &path,
            &[],
            &["normal", name, "-o", "out.tif", "--channel", channel, "--backend", "cpu", "-q"],
            "out.tif",
        );
        let mask = ["blend", "flat.png", "flat.png", "--mask", name, "--mask-channel", channel, "-o", "out.png"];
        assert_ends_well(&path, &[&flat], &[&mask[..], &["--backend", "cpu", "-q"]].concat(), "out.png");
    }
    for path in normal_maps(&folder) {
        let name = path.file_name().unwrap().to_str().unwrap();
        assert_ends_well(&path, &[], &["blend", name, name, "-o", "out.exr", "--backend", "cpu", "-q"], "out.exr");
    }
    for (layout, path) in raw_maps(&folder) {
        let name = path.file_name().unwrap().to_str().unwrap();
        assert_ends_well(
            &path,
            &[],
            &["normal", name, "--raw", layout, "-o", "out.png", "--backend", "cpu", "-q"],
            "out.png",
        );
    }
}

#[test]
fn models_and_what_lies_beside_them() {
    let folder = Folder::new();
    let [glb, gltf, data, obj] = &models(&folder)[..] else { panic!("four models") };
    let (bin, mtl) = (folder.path("m.bin"), folder.path("m.mtl"));
    let tangents = |name| ["tangents", name, "-o", "out.glb", "--all", "--backend", "cpu", "-q"];
    assert_ends_well(glb, &[], &tangents("m.glb"), "out.glb");
    assert_ends_well(gltf, &[&bin], &tangents("m.gltf"), "out.glb");
    assert_ends_well(data, &[], &tangents("data.gltf"), "out.glb");
    assert_ends_well(obj, &[&mtl], &tangents("m.obj"), "out.glb");
    assert_ends_well(&mtl, &[obj], &tangents("m.obj"), "out.glb");
}

#[test]
fn settings() {
    let settings = include_str!("../../examples/textures/texbake.toml");
    let mut noise = Noise(settings.len() as u64);
    for number in 0..40 {
        let folder = Folder::new();
        let text = variant(settings.as_bytes(), &mut noise);
        folder.file("texbake.toml", &text);
        let mut encoder = png::Encoder::new(std::fs::File::create(folder.path("a_height.png")).unwrap(), 2, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[0, 50, 100, 150]).unwrap();

        let mut command = Command::new(env!("CARGO_BIN_EXE_texbake"));
        let arguments = ["bake", ".", "--out", "baked", "--backend", "cpu", "-q"];
        let done = command.args(arguments).current_dir(folder.path("")).output().unwrap();
        let stderr = String::from_utf8_lossy(&done.stderr);
        let what = format!("variant {number}, seed {}: {stderr}\n{}", settings.len(), String::from_utf8_lossy(&text));
        assert!(!stderr.contains("panicked"), "{what}");
        match done.status.code() {
            Some(0) => assert!(folder.path("baked").is_dir(), "{what}"),
            // Settings that are none are wrong arguments; a suffix or a format that no file has is a failure.
            Some(1 | 2) => assert!(!stderr.is_empty() && !folder.path("baked").join("a_normal.png").exists(), "{what}"),
            status => panic!("status {status:?}: {what}"),
        }
    }
}
