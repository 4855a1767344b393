//! The program on devices that fail, and on maps that are too much for a device.

use crate::cli::support::{Folder, Run, bumps8, bumps16};
use crate::cli::tangents::{Model, sheet};
use std::path::{Path, PathBuf};
use texbake::NormalOptions;

/// Mesa's RADV without a Radeon: it is listed as a real GPU, and every device on it opens as lost.
const LOST: (&str, &str) = ("RADV_FORCE_FAMILY", "NAVI21");

/// RADV's driver file; `None` where it is not installed.
fn radv() -> Option<PathBuf> {
    let files = std::fs::read_dir("/usr/share/vulkan/icd.d").into_iter().flatten().filter_map(Result::ok);
    let found = files.map(|file| file.path()).find(|path| path.to_string_lossy().contains("radeon_icd"));
    if found.is_none() {
        println!("not tested: no RADV");
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no RADV");
    }
    found
}

/// Runs the program where every GPU opens as lost.
fn run_on_lost(folder: &Folder, arguments: &[&str], radv: &Path) -> Run {
    let mut command = folder.command(arguments);
    command.env(LOST.0, LOST.1).env("VK_DRIVER_FILES", radv).env("VK_ICD_FILENAMES", radv);
    command.output().unwrap().into()
}

/// Fails unless a command ends with the loss when it must run on the GPU, and with the CPU's own files when it may not.
/// `out` is the folder that it writes to.
fn assert_lost(folder: &Folder, arguments: &[&str], radv: &Path) {
    let with = |out: &'static str, backend: &[&'static str]| -> Run {
        let arguments: Vec<String> = arguments.iter().map(|argument| argument.replace("OUT", out)).collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).chain(backend.iter().copied()).collect();
        run_on_lost(folder, &arguments, radv)
    };
    for backend in [&["--backend", "gpu"][..], &["--adapter", "NAVI21"]] {
        let run = with("strict", backend).ends(1);
        run.says("RADV NAVI21", &["lost"]);
        assert!(folder.files("strict").is_empty(), "{arguments:?}: {:?}", folder.files("strict"));
    }
    with("auto", &["--backend", "auto"]).ends(0);
    with("cpu", &["--backend", "cpu"]).ends(0);
    let written = folder.files("cpu");
    assert!(!written.is_empty() && folder.files("auto") == written, "{arguments:?}: {written:?}");
    for name in written.iter().filter(|name| !name.ends_with("report.json")) {
        let [auto, cpu] = ["auto", "cpu"].map(|out| std::fs::read(folder.path(&format!("{out}/{name}"))).unwrap());
        assert!(auto == cpu, "{arguments:?}: {name}");
    }
    for out in ["strict", "auto", "cpu"] {
        let _ = std::fs::remove_dir_all(folder.path(out));
    }
}

#[test]
fn every_command_on_a_lost_gpu_runs_on_the_cpu_or_fails_with_its_reason() {
    let Some(radv) = radv() else { return };
    let folder = Folder::new();
    let heights = folder.grey8("tex/h_height.png", 33, 9, bumps8);
    folder.grey16("tex/g_height.png", 20, 31, bumps16);
    folder.run(&["normal", "tex/h_height.png", "-o", "n.png", "--backend", "reference", "-q"]).ends(0);
    folder.assert_baked("n.png", &heights, &NormalOptions::default());
    folder.file("m.glb", Model::new().with("sheet", &sheet(6, 5), 0).glb());
    for arguments in [
        &["normal", "tex/h_height.png", "-o", "OUT/n.png"][..],
        &["parallax", "tex/h_height.png", "-o", "OUT/p.png"],
        &["parallax", "tex/h_height.png", "--normal", "n.png", "-o", "OUT/p.png"],
        &["blend", "n.png", "n.png", "-o", "OUT/b.png"],
        &["tangents", "m.glb", "-o", "OUT/m.glb"],
        &["bake", "tex", "--out", "OUT", "--maps", "normal,parallax"],
    ] {
        assert_lost(&folder, arguments, &radv);
    }
}

#[test]
fn the_report_says_why_a_lost_gpu_was_not_used() {
    let Some(radv) = radv() else { return };
    let folder = Folder::new();
    let heights = folder.grey8("tex/h_height.png", 33, 9, bumps8);
    folder.grey16("tex/g_height.png", 20, 31, bumps16);
    run_on_lost(&folder, &["bake", "tex", "--out", "out", "--report", "report.json"], &radv).ends(0);
    folder.assert_baked("out/h_normal.png", &heights, &NormalOptions::default());
    let report = folder.json("report.json");
    let files = report["files"].as_array().unwrap();
    assert_eq!(files.len(), 2);
    for file in files {
        let reason = file["reason"].as_str().unwrap();
        assert!(reason.starts_with("no real GPU: ") && reason.contains("RADV NAVI21") && reason.contains("lost"));
        assert_eq!((&file["backend"], &file["result"]), (&"cpu".into(), &"baked".into()));
    }
}

#[test]
fn devices_lists_each_adapter_with_its_test() {
    let Some(radv) = radv() else { return };
    let listed = run_on_lost(&Folder::new(), &["devices", "--json"], &radv).ends(0);
    let devices: serde_json::Value = serde_json::from_str(&listed.stdout).unwrap();
    let devices = devices.as_array().unwrap();
    let lost = devices.iter().find(|device| device["name"].as_str().unwrap().contains("NAVI21")).unwrap();
    assert_eq!(lost["kind"], "discrete gpu");
    assert_eq!(lost["picked"], false);
    assert!(lost["self_test"].to_string().contains("lost"), "{lost}");
    let cpu = devices.last().unwrap();
    assert_eq!((&cpu["api"], &cpu["picked"]), (&"cpu".into(), &true.into()));
}

#[test]
fn an_image_one_texel_wider_than_a_dispatch_is_refused_on_a_gpu_and_leaves_no_file() {
    if texbake::Baker::gpu(Some("vulkan:llvmpipe")).is_err() {
        println!("not tested: no lavapipe");
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no lavapipe");
        return;
    }
    let folder = Folder::new();
    let wide = std::fs::File::create(folder.path("wide.raw")).unwrap();
    wide.set_len(65_535 * 256 + 1).unwrap();
    let arguments = ["normal", "wide.raw", "--raw", "16776961x1:u8", "-o", "out/n.tif"];
    let run = folder.run(&[&arguments[..], &["--adapter", "vulkan:llvmpipe"]].concat()).ends(1);
    run.says("rows of 16776961 texels are too wide for it", &["65536 workgroups where 65535 are allowed", "llvmpipe"]);
    assert!(folder.files("out").is_empty(), "{:?}", folder.files("out"));
}
