//! Disks that are full, files that may not grow: an error that names the file and the way out, and no half file.
//!
//! Each run has a small file system of its own (tmpfs) in a mount namespace of its own, which ends with it.

use crate::cli::support::{Folder, Run, bumps8, bumps16};
use crate::cli::tangents::{Model, sheet};
use std::os::unix::fs::FileTypeExt;
use std::process::Command;
use std::sync::OnceLock;
use texbake::{HeightMap, NormalOptions};

const FULL: &str = "make room, or choose another disk";

/// How a process gets a mount namespace here; `None`, and printed, if it does not.
fn namespace() -> Option<&'static [&'static str]> {
    static WORKS: OnceLock<Option<&[&str]>> = OnceLock::new();
    // The second is for users; the system may forbid it.
    let ways: [&[&str]; 2] = [&["unshare", "-m"], &["unshare", "-rm"]];
    let mounts = |way: &&&[&str]| {
        let mount = "mount -t tmpfs -o size=16k tmpfs /mnt";
        Command::new(way[0]).args(&way[1..]).args(["sh", "-c", mount]).output().is_ok_and(|run| run.status.success())
    };
    let works = *WORKS.get_or_init(|| ways.iter().find(mounts).copied());
    if works.is_none() {
        println!("not tested: this system lets no process mount");
        assert_ne!(std::env::var("TEXBAKE_REQUIRE_MOUNTS").as_deref(), Ok("1"), "TEXBAKE_REQUIRE_MOUNTS=1");
    }
    works
}

/// Runs the program where `disk` is a file system of `kib` KiB that holds what is in `before`; what it holds afterwards
/// is in `after`. `None` if the system does not allow it.
fn run_on_disk(folder: &Folder, options: &str, arguments: &[&str]) -> Option<Run> {
    let namespace = namespace()?;
    let script = format!(
        "mkdir -p disk before && mount -t tmpfs -o mode=755 tmpfs disk && cp -a before/. disk/ \
         && mount -o remount,{options} disk || exit 99
         \"$@\"; status=$?
         rm -rf after && cp -a disk after || exit 99
         exit $status"
    );
    let program = folder.command(&[]);
    let mut command = Command::new(namespace[0]);
    command.args(&namespace[1..]).args(["sh", "-c", &script, "sh"]).arg(program.get_program()).args(arguments);
    command.current_dir(folder.path(".")).env("XDG_RUNTIME_DIR", folder.path("."));
    Some(command.output().unwrap().into())
}

/// A map of noise: its baked maps are as long as they can be.
fn noise(folder: &Folder, name: &str, side: usize) -> HeightMap {
    folder.grey16(name, side, side, |x, y| {
        let hash = (x * 7919 + y * 104_729) as u64;
        (hash.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 48) as u16
    })
}

#[test]
fn a_full_disk_is_an_error_for_every_format() {
    let folder = Folder::new();
    noise(&folder, "h.png", 200);
    folder.file("before/old.txt", "here before");
    for name in ["n.png", "n.tif", "n.exr"] {
        for is_there in [false, true] {
            let old = folder.path("before").join(name);
            let _ = std::fs::remove_file(&old);
            if is_there {
                std::fs::write(&old, "the map of before").unwrap();
            }
            let output = format!("disk/{name}");
            let Some(run) = run_on_disk(&folder, "size=64k", &["normal", "h.png", "-o", &output, "--scale", "9"])
            else {
                return;
            };
            run.ends(1).says(&format!("error: {output}"), &[FULL]);
            let expected: &[&str] = if is_there { &[name, "old.txt"] } else { &["old.txt"] };
            assert_eq!(folder.files("after"), expected);
            if is_there {
                assert_eq!(std::fs::read(folder.path("after").join(name)).unwrap(), b"the map of before");
            }
        }
        std::fs::remove_file(folder.path("before").join(name)).unwrap();
    }
    // The same where there is room.
    if let Some(run) = run_on_disk(&folder, "size=4m", &["normal", "h.png", "-o", "disk/n.png", "--scale", "9"]) {
        run.ends(0);
        assert!(std::fs::metadata(folder.path("after/n.png")).unwrap().len() > 65536);
    }
}

#[test]
fn textures_that_fit_on_a_full_disk_are_there() {
    let folder = Folder::new();
    let small: Vec<_> =
        ["a", "c", "e"].map(|name| (name, noise(&folder, &format!("tex/{name}_height.png"), 20))).into();
    for name in ["b", "d"] {
        noise(&folder, &format!("tex/{name}_height.png"), 200);
    }
    let arguments =
        ["bake", "tex", "--out", "disk", "--maps", "normal,parallax", "--jobs", "1", "--report", "report.json"];
    let Some(run) = run_on_disk(&folder, "size=64k", &arguments) else { return };
    let run = run.ends(1);
    for name in ["b", "d"] {
        run.says(&format!("failed disk/{name}_"), &[FULL]);
    }
    let expected =
        ["a_normal.png", "a_parallax.png", "c_normal.png", "c_parallax.png", "e_normal.png", "e_parallax.png"];
    assert_eq!(folder.files("after"), expected);
    for (name, map) in &small {
        folder.assert_baked(&format!("after/{name}_normal.png"), map, &NormalOptions::default());
    }
    let report = folder.json("report.json");
    assert_eq!((&report["totals"]["baked"], &report["totals"]["failed"]), (&3.into(), &2.into()));
}

#[test]
fn a_report_and_a_sidecar_say_when_the_disk_is_full() {
    let folder = Folder::new();
    let map = folder.grey8("h.png", 40, 40, bumps8);
    // What is left after it holds no byte more.
    folder.file("before/filler", vec![7; 64 << 10]);
    let Some(run) = run_on_disk(&folder, "size=64k", &["normal", "h.png", "-o", "n.png", "--report", "disk/r.json"])
    else {
        return;
    };
    run.ends(1).says("error: disk/r.json", &[FULL]);
    assert_eq!(folder.files("after"), ["filler"]);
    folder.assert_baked("n.png", &map, &NormalOptions::default());

    // A map of one texel has room, the sidecar beside it has not; that of another map does not stay in its place.
    folder.grey8("h.png", 1, 1, bumps8);
    let arguments = |output| ["parallax", "h.png", "-o", output, "--json", "--report", "r.json"];
    for (is_there, filler) in [(false, 60), (true, 56)] {
        folder.file("before/filler", vec![7; filler << 10]);
        if is_there {
            folder.run(&arguments("before/p.png")).ends(0);
            std::fs::remove_file(folder.path("before/p.png")).unwrap();
        }
        let Some(run) = run_on_disk(&folder, "size=64k", &arguments("disk/p.png")) else { return };
        run.ends(1).says("error: disk/p.json", &[FULL]);
        assert_eq!(folder.files("after"), ["filler", "p.png"]);
        assert_eq!(folder.json("r.json")["totals"]["baked"], 1);
    }
}

#[test]
fn a_model_that_has_no_room_leaves_the_old_one() {
    let folder = Folder::new();
    folder.file("m.glb", Model::new().with("sheet", &sheet(60, 60), 0).glb());
    for name in ["m.glb", "m.gltf"] {
        let _ = std::fs::remove_dir_all(folder.path("before"));
        let arguments = |output, convention| ["tangents", "m.glb", "-o", output, "--convention", convention];
        let (old, output) = (format!("before/{name}"), format!("disk/{name}"));
        folder.run(&arguments(&old, "dx")).ends(0);
        let before: Vec<_> = folder.files("before");
        let bytes: u64 =
            before.iter().map(|file| std::fs::metadata(folder.path("before").join(file)).unwrap().len()).sum();
        // Room for one file more, or for less, but not for the new model beside the old one.
        for spare in [4 << 10, bytes / 2, bytes * 9 / 10] {
            let size = format!("size={}k", (bytes + spare).next_multiple_of(4096) / 1024 + 8);
            let Some(run) = run_on_disk(&folder, &size, &arguments(&output, "gl")) else { return };
            run.ends(1).says("error: disk/m.", &[FULL]);
            assert_eq!(folder.files("after"), before);
            for file in &before {
                let read = |place: &str| std::fs::read(folder.path(place).join(file)).unwrap();
                assert!(read("after") == read("before"), "{file}");
            }
        }
    }
}

#[test]
fn a_read_only_disk_is_an_error() {
    let folder = Folder::new();
    folder.grey8("h.png", 4, 4, bumps8);
    folder.file("before/n.png", "the map of before");
    for output in ["disk/n.png", "disk/new.png", "disk/sub/new.png"] {
        let Some(run) = run_on_disk(&folder, "ro", &["normal", "h.png", "-o", output]) else { return };
        run.ends(1).says("error: disk/", &["Read-only file system", "choose another folder"]);
        assert_eq!(folder.files("after"), ["n.png"]);
    }
}

/// Runs the program where a file may have 8 KiB.
fn run_with_small_files(folder: &Folder, arguments: &[&str]) -> Run {
    let program = folder.command(&[]);
    let mut command = Command::new("sh");
    // In units of 512 bytes, as POSIX says.
    command.args(["-c", "ulimit -f 16; exec \"$@\"", "sh"]).arg(program.get_program()).args(arguments);
    command.current_dir(folder.path(".")).output().unwrap().into()
}

#[test]
fn a_file_that_may_not_grow_is_an_error() {
    let folder = Folder::new();
    let small = folder.grey8("tex/a_height.png", 9, 9, bumps8);
    noise(&folder, "tex/b_height.png", 200);
    for format in ["png", "tif", "exr"] {
        let out = format!("out-{format}");
        let run = run_with_small_files(&folder, &["bake", "tex", "--out", &out, "--format", format]).ends(1);
        run.says(&format!("failed {out}/b_normal."), &["File too large", "raise the limit on the size of files"]);
        assert_eq!(folder.files(&out), [format!("a_normal.{format}")]);
    }
    folder.assert_baked("out-png/a_normal.png", &small, &NormalOptions::default());

    folder.file("m.glb", Model::new().with("sheet", &sheet(60, 60), 0).glb());
    for output in ["models/m.glb", "models/m.gltf"] {
        let run = run_with_small_files(&folder, &["tangents", "m.glb", "-o", output]).ends(1);
        run.says("error: models/m.", &["File too large", "raise the limit on the size of files"]);
        assert_eq!(folder.files("models"), [""; 0]);
    }
}

#[test]
fn devices_are_written_and_never_replaced() {
    let folder = Folder::new();
    let map = folder.grey16("h.png", 9, 9, bumps16);
    let bake = |report: &str| folder.run(&["normal", "h.png", "-o", "n.png", "--report", report, "--quiet"]);
    bake("/dev/full").ends(1).says("error: /dev/full", &[FULL]);
    folder.assert_baked("n.png", &map, &NormalOptions::default());
    bake("/dev/null").ends(0);
    let run = bake("/dev/stdout").ends(0);
    let report: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report["totals"]["baked"], 1);
    for device in ["/dev/full", "/dev/null"] {
        assert!(std::fs::metadata(device).unwrap().file_type().is_char_device(), "{device}");
    }
    std::os::unix::fs::symlink("/dev/full", folder.path("full.png")).unwrap();
    let run = folder.run(&["normal", "h.png", "-o", "full.png"]).ends(1);
    run.says("error: ", &["full.png: it is a device or a pipe; give the name of a file"]);

    // What was printed on a full disk is lost, and nothing may look as if it were not.
    let full = || std::fs::File::options().write(true).open("/dev/full").unwrap();
    for arguments in [&["check", "n.png", "--json"][..], &["bake", "h.png", "--out", "out"], &["devices"]] {
        let run = Run::from(folder.command(arguments).stdout(full()).output().unwrap()).ends(1);
        run.says("error: standard output: ", &[FULL]);
    }
}
