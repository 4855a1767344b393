//! The program on devices that fail.

use crate::support::map_u8;
use std::path::Path;
use std::process::{Command, Output};
use texbake::{Baker, NormalOptions};

/// Mesa's RADV without a Radeon: it is listed as a real GPU, and every device on it opens as lost.
const LOST: (&str, &str) = ("RADV_FORCE_FAMILY", "NAVI21");

fn texbake(folder: &Path, arguments: &[&str], radv: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_texbake"));
    command.args(arguments).current_dir(folder);
    command.env(LOST.0, LOST.1).env("VK_DRIVER_FILES", radv).env("VK_ICD_FILENAMES", radv);
    command.env("XDG_RUNTIME_DIR", folder).output().unwrap()
}

/// RADV's driver file; `None` where it is not installed.
fn radv() -> Option<std::path::PathBuf> {
    let files = std::fs::read_dir("/usr/share/vulkan/icd.d").into_iter().flatten().filter_map(Result::ok);
    let found = files.map(|file| file.path()).find(|path| path.to_string_lossy().contains("radeon_icd"));
    if found.is_none() {
        println!("not tested: no RADV");
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no RADV");
    }
    found
}

#[test]
fn a_gpu_that_opens_as_lost_leaves_the_bake_to_the_cpu_or_fails_with_its_reason() {
    let Some(radv) = radv() else { return };
    let folder = tempfile::tempdir().unwrap();
    let heights = map_u8(33, 9, |x, y| (x * y) as u8);
    let texbake::Heights::U8(codes) = heights.heights() else { unreachable!() };
    std::fs::write(folder.path().join("h.raw"), codes).unwrap();
    let bake = |more: &[&str]| {
        let arguments = [&["normal", "h.raw", "--raw", "33x9:u8", "-o", "n.tif", "--bits", "8"], more].concat();
        texbake(folder.path(), &arguments, &radv)
    };

    let strict = bake(&["--backend", "gpu"]);
    let said = String::from_utf8_lossy(&strict.stderr);
    assert_eq!(strict.status.code(), Some(1), "{said}");
    assert!(said.contains("RADV NAVI21") && said.contains("lost"), "{said}");
    assert!(!folder.path().join("n.tif").exists());

    let auto = bake(&[]);
    let said = [auto.stdout, auto.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert_eq!(auto.status.code(), Some(0), "{said}");
    assert!(said.contains("no real GPU: ") && said.contains("RADV NAVI21") && said.contains("lost"), "{said}");
    let expected = Baker::reference().normal(&heights, &NormalOptions::default()).unwrap();
    let file = std::fs::read(folder.path().join("n.tif")).unwrap();
    let rows = expected.codes().bytes();
    assert!(file.windows(rows.len()).any(|window| window == rows), "the reference's rows");
}

#[test]
fn devices_lists_each_adapter_with_its_test() {
    let Some(radv) = radv() else { return };
    let folder = tempfile::tempdir().unwrap();
    let listed = texbake(folder.path(), &["devices", "--json"], &radv);
    assert_eq!(listed.status.code(), Some(0));
    let devices: serde_json::Value = serde_json::from_slice(&listed.stdout).unwrap();
    let devices = devices.as_array().unwrap();
    let lost = devices.iter().find(|device| device["name"].as_str().unwrap().contains("NAVI21")).unwrap();
    assert_eq!(lost["kind"], "discrete gpu");
    assert_eq!(lost["picked"], false);
    assert!(lost["self_test"].to_string().contains("lost"), "{lost}");
    let cpu = devices.last().unwrap();
    assert_eq!((&cpu["api"], &cpu["picked"]), (&"cpu".into(), &true.into()));
}
