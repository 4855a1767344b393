//! An interrupt ends a run cleanly, a second one at once.

use super::watched::{PAUSE, reaches};
use crate::cli::support::{Folder, Run, read_png};
use crate::cli::tangents::{Model, sheet};
use std::process::{Command, Output, Stdio};

/// So many that no machine is done before the signal comes.
const FILES: usize = 400;

/// What a run says that gets a signal as soon as `is_time`, or that ends before; it is told the process's number.
fn signalled(mut command: Command, signal: &str, is_time: impl Fn(&str) -> bool) -> Output {
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let id = child.id().to_string();
    if reaches(&mut child, PAUSE, || is_time(&id)) {
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
    }
    child.wait_with_output().unwrap()
}

#[test]
fn an_interrupted_folder_leaves_whole_files_and_says_what_is_missing() {
    let folder = Folder::new();
    let heights: Vec<u8> = (0..1u32 << 20).map(|i| (i.wrapping_mul(2654435761) >> 24) as u8).collect();
    let file = folder.file("tex/m0_height.raw", heights);
    for index in 1..FILES {
        std::fs::hard_link(&file, folder.path(&format!("tex/m{index}_height.raw"))).unwrap();
    }
    let arguments = ["bake", "tex", "--out", "out", "--raw", "1024x1024:u8", "--report", "report.json"];
    let has_output = |_: &str| folder.files("out").iter().any(|file| file.ends_with(".png"));
    let run = Run::from(signalled(folder.command(&arguments), "-INT", has_output)).ends(130);

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
fn an_interrupted_folder_of_two_maps_leaves_both_of_a_texture_or_none_and_can_be_completed() {
    const TEXTURES: usize = 150;
    for signal in ["-INT", "-TERM"] {
        let folder = Folder::new();
        for index in 0..TEXTURES {
            folder.file(&format!("tex/m{index:03}_height.raw"), vec![index as u8; 200 * 200]);
        }
        let arguments = ["bake", "tex", "--out", "out", "--raw", "200x200:u8", "--maps", "normal,parallax"];
        let has_output = |_: &str| folder.files("out").iter().any(|file| file.ends_with(".png"));
        let run = Run::from(signalled(folder.command(&arguments), signal, has_output)).ends(130);
        let outputs = folder.files("out");
        let textures = outputs.len() / 2;
        for pair in outputs.chunks(2) {
            let stem = pair[0].strip_suffix("_normal.png").unwrap_or_else(|| panic!("{outputs:?}"));
            assert_eq!(pair[1], format!("{stem}_parallax.png"), "{outputs:?}");
            pair.iter().for_each(|file| assert_eq!(read_png(&folder.path("out").join(file)).0, 200));
        }
        let summary = run.stdout.lines().last().unwrap();
        assert!(summary.starts_with(&format!("{textures} of {TEXTURES} files baked, ")), "{summary}");
        assert!(run.stderr.contains("interrupted: what is being written is dropped"), "{}", run.stderr);

        folder.run(&[&arguments[..], &["--quiet"]].concat()).ends(0);
        assert_eq!(folder.files("out").len(), 2 * TEXTURES);
    }
}

#[test]
fn an_interrupted_file_leaves_nothing() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    // A machine that is done before the signal comes gets more to do.
    for rows in [4096u64, 16384, 65536] {
        std::fs::File::create(folder.path("heights.raw")).unwrap().set_len(4096 * rows).unwrap();
        let layout = format!("4096x{rows}:u8");
        let command = folder.command(&["normal", "heights.raw", "--raw", &layout, "-o", "out/normal.png"]);
        let output = signalled(command, "-INT", |_| !folder.files("out").is_empty());
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

#[test]
fn an_interrupted_blend_leaves_nothing() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    for rows in [4096, 16384, 65535] {
        sparse_tiff(&folder, "map.tif", 4096, rows);
        let command = folder.command(&["blend", "map.tif", "map.tif", "-o", "out/n.tif", "--report", "r.json"]);
        let output = signalled(command, "-INT", |_| !folder.files("out").is_empty());
        if output.status.code() == Some(0) {
            std::fs::remove_file(folder.path("out/n.tif")).unwrap();
            continue;
        }
        let run = Run::from(output).ends(130);
        assert!(run.stderr.ends_with("out/n.tif was not written\n"), "{}", run.stderr);
        assert_eq!(folder.files("out"), [""; 0]);
        assert_eq!(folder.json("r.json")["result"], "stopped");
        return;
    }
    panic!("no run was interrupted");
}

#[test]
fn an_interrupted_model_leaves_nothing() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    // Many primitives of the same bytes, each of another accessor.
    let mut model = Model::new().with("sheet", &sheet(200, 200), 0);
    let first = model.json["meshes"][0]["primitives"][0].clone();
    let texcoords = model.json["accessors"][first["attributes"]["TEXCOORD_0"].as_u64().unwrap() as usize].clone();
    for _ in 0..400 {
        let mut primitive = first.clone();
        primitive["attributes"]["TEXCOORD_0"] = model.push("accessors", texcoords.clone()).into();
        model.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }
    folder.file("model.glb", model.glb());
    let command = folder.command(&["tangents", "model.glb", "-o", "out/m.glb", "--report", "r.json"]);
    let run = Run::from(signalled(command, "-TERM", listens)).ends(130);
    assert!(run.stderr.contains("interrupted: "), "{}", run.stderr);
    assert!(run.stderr.ends_with("out/m.glb was not written\n"), "{}", run.stderr);
    assert_eq!(folder.files("out"), [""; 0]);
    assert_eq!(folder.json("r.json")["result"], "stopped");
}

#[test]
fn an_interrupted_picture_leaves_nothing() {
    let folder = Folder::new();
    folder.grey8("height.png", 64, 64, |x, y| (x * y) as u8);
    // Relief so high that a ray takes sixty thousand steps.
    let high = ["--scale", "700", "--elevations", "5", "--panel", "128", "--backend", "cpu"];
    let command = folder.command(&[&["preview", "height.png", "-o", "out/sheet.png"][..], &high].concat());
    let run = Run::from(signalled(command, "-INT", listens)).ends(130);
    assert!(run.stderr.contains("interrupted: "), "{}", run.stderr);
    assert!(run.stderr.ends_with("out/sheet.png was not written\n"), "{}", run.stderr);
    assert_eq!(folder.files("out"), [""; 0]);
}

#[test]
fn an_interrupted_model_leaves_the_old_one_with_its_buffer() {
    let folder = Folder::new();
    folder.file("small.glb", Model::new().with("sheet", &sheet(3, 3), 0).glb());
    folder.run(&["tangents", "small.glb", "-o", "out/m.gltf"]).ends(0);
    let read = || folder.files("out").into_iter().map(|name| std::fs::read(folder.path("out").join(name)).unwrap());
    let before: Vec<_> = read().collect();
    folder.file("model.glb", Model::new().with("sheet", &sheet(1200, 1200), 0).glb());
    let command = folder.command(&["tangents", "model.glb", "-o", "out/m.gltf"]);
    let run = Run::from(signalled(command, "-INT", listens)).ends(130);
    assert!(run.stderr.ends_with("out/m.gltf was not written\n"), "{}", run.stderr);
    assert_eq!(folder.files("out"), ["m.bin", "m.gltf"]);
    assert!(read().eq(before));
    folder.run(&["tangents", "model.glb", "-o", "out/m.gltf"]).ends(0);
    assert_eq!(folder.files("out"), ["m.bin", "m.gltf"]);
}

#[test]
fn an_interrupted_check_or_diff_leaves_nothing() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    sparse_tiff(&folder, "map.tif", 4096, 65535);
    let arguments: [&[&str]; 3] = [
        &["check", "map.tif", "--json"],
        &["diff", "map.tif", "map.tif", "--heatmap", "out/heat.tif"],
        &["check", "map.tif", "--repair", "--channels", "xyz", "-o", "out/n.tif"],
    ];
    for arguments in arguments {
        let run = Run::from(signalled(folder.command(arguments), "-TERM", listens)).ends(130);
        assert!(run.stderr.contains("interrupted: "), "{arguments:?}: {}", run.stderr);
        assert_eq!((run.stdout.as_str(), folder.files("out")), ("", Vec::new()), "{arguments:?}");
    }
}

#[test]
fn an_interrupt_while_the_repaired_map_is_checked_keeps_it() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    // A machine that is done before the signal comes gets more to do.
    for rows in [4096, 16384, 65535] {
        sparse_tiff(&folder, "map.tif", 4096, rows);
        let arguments = ["check", "map.tif", "--repair", "--channels", "xyz", "-o", "out/n.tif"];
        let output = signalled(folder.command(&arguments), "-INT", |_| folder.files("out") == ["n.tif"]);
        if [Some(0), Some(1)].contains(&output.status.code()) {
            std::fs::remove_file(folder.path("out/n.tif")).unwrap();
            continue;
        }
        let run = Run::from(output).ends(130);
        assert!(!run.stdout.contains("\nout/n.tif: "), "{}", run.stdout);
        assert_eq!(folder.files("out"), ["n.tif"]);
        return;
    }
    panic!("no run was interrupted");
}

/// Whether a process catches SIGTERM, as Linux says; elsewhere after a while.
fn listens(id: &str) -> bool {
    let Ok(status) = std::fs::read_to_string(format!("/proc/{id}/status")) else {
        std::thread::sleep(std::time::Duration::from_millis(500));
        return true;
    };
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    const SIGTERM: u64 = 15;
    caught >> (SIGTERM - 1) & 1 == 1
}

/// A plain RGB TIFF of 8 bits whose samples are a hole in the file: large, and made at once.
fn sparse_tiff(folder: &Folder, name: &str, width: u32, height: u32) {
    // One row to a strip; the strips' offsets and lengths follow the directory of ten entries.
    let offsets = 8 + 2 + 10 * 12 + 4;
    let (lengths, bits) = (offsets + 4 * height, offsets + 8 * height);
    let samples = bits + 6;
    let row = 3 * width;
    let entries: [(u16, u16, u32, u32); 10] = [
        (256, 4, 1, width),
        (257, 4, 1, height),
        (258, 3, 3, bits),
        (259, 3, 1, 1), // no compression
        (262, 3, 1, 2), // RGB
        (273, 4, height, offsets),
        (277, 3, 1, 3),
        (278, 4, 1, 1),
        (279, 4, height, lengths),
        (284, 3, 1, 1), // samples side by side
    ];
    let mut bytes = [b"II*\0".as_slice(), &8u32.to_le_bytes(), &10u16.to_le_bytes()].concat();
    for (tag, kind, count, value) in entries {
        bytes.extend([tag, kind].iter().flat_map(|part| part.to_le_bytes()));
        bytes.extend([count, value].iter().flat_map(|part| part.to_le_bytes()));
    }
    bytes.extend([0; 4]);
    bytes.extend((0..height).flat_map(|strip| (samples + strip * row).to_le_bytes()));
    bytes.extend((0..height).flat_map(|_| row.to_le_bytes()));
    bytes.extend([8, 0, 8, 0, 8, 0]);
    let path = folder.file(name, bytes);
    let file = std::fs::File::options().write(true).open(path).unwrap();
    file.set_len(u64::from(samples) + u64::from(row) * u64::from(height)).unwrap();
}
