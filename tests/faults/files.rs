//! Folders that take no file, and inputs that change, go, or were never files.

use super::paused::Paused;
use super::watched::{PAUSE, reaches};
use crate::cli::support::{Folder, Run, bumps8, bumps16};
use crate::cli::tangents::{Model, sheet};
use crate::io::support::read_last_row;
use std::fs::{self, File, Permissions};
use std::io::{Seek, SeekFrom, Write};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};
use texbake::io::{NormalReadOptions, ReadOptions, open_heights, open_normals};
use texbake::{Codes, Grid, HeightMap, Heights, HeightsMut, NormalOptions};

/// A pipe with a name.
fn fifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// The program as a user whom permissions bind, in a folder of theirs.
fn command_of_user(folder: &Folder, arguments: &[&str]) -> Command {
    const NOBODY: u32 = 65534;
    let command = folder.command(arguments);
    let is_root = fs::metadata("/proc/self").is_ok_and(|this| std::os::unix::fs::MetadataExt::uid(&this) == 0);
    if !is_root {
        return command;
    }
    // The build may lie where only root can go.
    let program = folder.path("texbake");
    if !program.exists() {
        let build = command.get_program();
        fs::hard_link(build, &program).or_else(|_| fs::copy(build, &program).map(drop)).unwrap();
    }
    fs::set_permissions(folder.path("."), Permissions::from_mode(0o777)).unwrap();
    let mut theirs = Command::new(&program);
    theirs.args(command.get_args()).current_dir(folder.path(".")).env("XDG_RUNTIME_DIR", folder.path("."));
    theirs.uid(NOBODY).gid(NOBODY);
    theirs
}

#[test]
fn a_folder_without_permission_to_write_stops_only_what_goes_there() {
    let folder = Folder::new();
    let map = folder.grey8("tex/a_height.png", 5, 5, bumps8);
    folder.grey8("tex/locked/b_height.png", 5, 5, bumps8);
    folder.file("out/locked/b_normal.png", "the map of before");
    for (name, mode) in [("out", 0o777), ("out/locked", 0o555), ("tex/locked", 0o755)] {
        fs::set_permissions(folder.path(name), Permissions::from_mode(mode)).unwrap();
    }
    let run: Run = command_of_user(&folder, &["bake", "tex", "--out", "out"]).output().unwrap().into();
    let run = run.ends(1);
    run.says("failed out/locked/b_normal.png", &["Permission denied", "change its permissions, or choose another"]);
    assert_eq!(folder.files("out"), ["a_normal.png", "locked/b_normal.png"]);
    folder.assert_baked("out/a_normal.png", &map, &NormalOptions::default());
    assert_eq!(fs::read(folder.path("out/locked/b_normal.png")).unwrap(), b"the map of before");

    for (arguments, name) in [
        (["normal", "tex/a_height.png", "-o", "out/locked/n.png"], "out/locked/n.png"),
        (["normal", "tex/a_height.png", "-o", "out/locked/sub/n.png"], "out/locked/sub"),
        (["tangents", "m.glb", "-o", "out/locked/m.gltf"], "out/locked/m."),
    ] {
        folder.file("m.glb", Model::new().with("sheet", &sheet(3, 3), 0).glb());
        let run: Run = command_of_user(&folder, &arguments).output().unwrap().into();
        run.ends(1).says(&format!("error: {name}"), &["Permission denied", "change its permissions"]);
    }
    fs::set_permissions(folder.path("out/locked"), Permissions::from_mode(0o755)).unwrap();
    assert_eq!(folder.files("out"), ["a_normal.png", "locked/b_normal.png"]);
}

#[test]
fn an_input_without_permission_to_read_fails_alone() {
    let folder = Folder::new();
    let map = folder.grey8("tex/a_height.png", 5, 5, bumps8);
    folder.grey8("tex/b_height.png", 5, 5, bumps8);
    folder.grey8("tex/locked/c_height.png", 5, 5, bumps8);
    fs::create_dir(folder.path("out")).unwrap();
    for (name, mode) in [("out", 0o777), ("tex/b_height.png", 0o000), ("tex/locked", 0o000)] {
        fs::set_permissions(folder.path(name), Permissions::from_mode(mode)).unwrap();
    }
    let run: Run = command_of_user(&folder, &["bake", "tex", "--out", "out"]).output().unwrap().into();
    let run = run.ends(1);
    run.says("failed tex/b_height.png", &["Permission denied", "change its permissions, or choose another file"]);
    run.says("error: tex/locked", &["Permission denied"]);
    assert_eq!(folder.files("out"), ["a_normal.png"]);
    folder.assert_baked("out/a_normal.png", &map, &NormalOptions::default());
    fs::set_permissions(folder.path("tex/locked"), Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn outputs_that_cannot_have_their_name_are_refused_and_leave_nothing() {
    let folder = Folder::new();
    folder.grey8("tex/h_height.png", 5, 5, bumps8);
    let long = format!("{}.png", "n".repeat(300));
    fs::create_dir(folder.path("folder.png")).unwrap();
    symlink("circle.png", folder.path("circle.png")).unwrap();
    fifo(&folder.path("pipe.png"));
    let cases = [
        (long.as_str(), ["File name too long", "choose a shorter or plainer name"]),
        ("folder.png", ["it is a folder", "give the name of a file"]),
        ("circle.png", ["circle.png", "symbolic links"]),
        ("pipe.png", ["it is a device or a pipe", "give the name of a file"]),
    ];
    let before = folder.files(".");
    for (output, parts) in cases {
        let run = folder.run(&["normal", "tex/h_height.png", "-o", output]).ends(1);
        run.says("error: ", &[&[output], &parts[..]].concat());
    }
    assert_eq!(folder.files("."), before);

    let name = format!("{{stem}}_{{map}}{}", "n".repeat(300));
    let run = folder.run(&["bake", "tex", "--out", "out", "--name", &name]).ends(1);
    run.says("failed out/h_normal", &["File name too long", "choose a shorter or plainer name"]);
    assert_eq!(folder.files("out"), [""; 0]);
}

#[test]
fn a_file_that_is_input_and_output_stays() {
    let folder = Folder::new();
    folder.grey8("h.png", 5, 5, bumps8);
    fs::hard_link(folder.path("h.png"), folder.path("hard.png")).unwrap();
    symlink("h.png", folder.path("soft.png")).unwrap();
    let before = fs::read(folder.path("h.png")).unwrap();
    for output in ["h.png", "./h.png", "hard.png", "soft.png"] {
        let run = folder.run(&["normal", "h.png", "-o", output]).ends(1);
        run.says("error: h.png", &["the output of h.png would overwrite this input", "choose another output"]);
    }
    assert_eq!(fs::read(folder.path("h.png")).unwrap(), before);
    assert_eq!(folder.files("."), ["h.png", "hard.png", "soft.png"]);
}

#[test]
fn pipes_and_devices_are_refused_and_not_waited_for() {
    let folder = Folder::new();
    folder.grey8("h.png", 4, 4, bumps8);
    folder.run(&["normal", "h.png", "-o", "n.png"]).ends(0);
    for name in ["pipe.png", "pipe.glb", "pipe.gltf", "pipe.obj"] {
        fifo(&folder.path(name));
    }
    let before = folder.files(".");
    let refused = ["it is a pipe or a device", "write what it gives into a file, and name that"];
    let cases: [&[&str]; 11] = [
        &["normal", "pipe.png", "-o", "o.png"],
        &["normal", "pipe.png", "-o", "o.png", "--raw", "4x4:u8"],
        &["normal", "/dev/zero", "-o", "o.png"],
        &["normal", "/dev/zero", "-o", "o.png", "--raw", "4x4:u8"],
        &["normal", "/dev/stdin", "-o", "o.png"],
        &["bake", "pipe.png", "--out", "out"],
        &["blend", "n.png", "pipe.png", "-o", "o.png"],
        &["check", "pipe.png"],
        &["tangents", "pipe.glb", "-o", "o.glb"],
        &["tangents", "pipe.gltf", "-o", "o.glb"],
        &["tangents", "pipe.obj", "-o", "o.glb"],
    ];
    for arguments in cases {
        let command = folder.command(arguments).stdin(Stdio::piped()).output().unwrap();
        let run = Run::from(command).ends(1);
        run.says("pipe or a device", &refused);
    }
    assert_eq!(folder.files("."), before);

    // A report may go into a pipe that somebody reads.
    let run = folder.run(&["normal", "h.png", "-o", "o.png", "--report", "pipe.obj"]).ends(1);
    run.says("error: pipe.obj", &["it is a pipe that nobody reads", "start what reads it first, or name a file"]);
    let reader = Command::new("cat").arg(folder.path("pipe.obj")).stdout(Stdio::piped()).spawn().unwrap();
    loop {
        let run = folder.run(&["normal", "h.png", "-o", "o.png", "--report", "pipe.obj"]);
        if run.status == 0 {
            break;
        }
    }
    let report: serde_json::Value = serde_json::from_slice(&reader.wait_with_output().unwrap().stdout).unwrap();
    assert_eq!(report["totals"]["baked"], 1);
}

#[test]
fn inputs_that_change_after_they_were_found_fail_alone() {
    let folder = Folder::new();
    let first = folder.grey8("tex/a_height.png", 6, 6, bumps8);
    for name in ["b", "c", "d", "e", "f", "g", "h"] {
        folder.grey16(&format!("tex/{name}_height.png"), 40, 40, bumps16);
    }
    let last = folder.grey16("tex/i_height.png", 7, 5, bumps16);
    let mut run = Paused::spawn(folder.command(&["bake", "tex", "--out", "out", "--jobs", "1", "--report", "r.json"]));
    assert!(reaches(&mut run.child, PAUSE, || folder.path("out/a_normal.png").exists()), "it ended");
    // It waits at the line of the first texture, and has not opened another.
    let path = |name: &str| folder.path(&format!("tex/{name}_height.png"));
    File::options().write(true).open(path("b")).unwrap().set_len(100).unwrap();
    let other_size = folder.grey8("tex/c_height.png", 9, 3, bumps8);
    for name in ["d", "e", "f", "g", "h"] {
        fs::remove_file(path(name)).unwrap();
    }
    fs::create_dir(path("e")).unwrap();
    fifo(&path("f"));
    symlink("g_height.png", path("g")).unwrap();
    symlink("/dev/zero", path("h")).unwrap();

    let run = run.go_on().ends(1);
    for (name, parts) in [
        ("b", ["the file ends before its last row", "copy or export it again"]),
        ("d", ["it went after it was found", "put it back, or run again without it"]),
        ("e", ["is a directory", "it is a folder"]),
        ("f", ["it is a pipe or a device", "write what it gives into a file"]),
        ("g", ["symbolic links", "failed"]),
        ("h", ["it is a pipe or a device", "write what it gives into a file"]),
    ] {
        run.says(&format!("failed tex/{name}_height.png"), &parts);
    }
    assert_eq!(folder.files("out"), ["a_normal.png", "c_normal.png", "i_normal.png"]);
    for (name, map) in [("a", &first), ("c", &other_size), ("i", &last)] {
        folder.assert_baked(&format!("out/{name}_normal.png"), map, &NormalOptions::default());
    }
    assert_eq!(folder.json("r.json")["totals"]["failed"], 6);
}

/// A file that was written an hour ago, as most are: a change makes it younger.
fn age(path: &Path) {
    let file = File::options().write(true).open(path).unwrap();
    file.set_modified(SystemTime::now() - Duration::from_secs(3600)).unwrap();
}

const SIDE: usize = 300;

/// Height maps in every format that is read row by row, and their heights.
fn maps(folder: &Folder) -> Vec<(&'static str, HeightMap)> {
    let png = folder.grey16("h.png", SIDE, SIDE, bumps16);
    let heights: Vec<u8> = (0..SIDE * SIDE).map(|i| bumps8(i % SIDE, i / SIDE)).collect();
    let raw: HeightMap = Grid::new(SIDE, SIDE, heights.clone()).unwrap().into();
    folder.file("h.raw", heights);
    for output in ["h.tif", "h.exr"] {
        folder.run(&["parallax", "h.png", "-o", output, "--quiet"]).ends(0);
    }
    let read = |name: &str| HeightMap::read(folder.path(name)).unwrap();
    vec![("h.png", png), ("h.raw", raw), ("h.tif", read("h.tif")), ("h.exr", read("h.exr"))]
}

fn bytes(map: &HeightMap) -> Vec<u8> {
    match map.heights() {
        Heights::U8(heights) => heights.to_vec(),
        Heights::U16(heights) => bytemuck::cast_slice(heights).to_vec(),
        Heights::F32(heights) => bytemuck::cast_slice(heights).to_vec(),
    }
}

/// Reads a map as a bake does that needs its last row first, and does `between` before the second reading.
fn read_twice(path: &Path, between: impl FnOnce()) -> texbake::Result<Vec<u8>> {
    let raw = path.extension().is_some_and(|extension| extension == "raw");
    let raw = raw.then(|| format!("{SIDE}x{SIDE}:u8").parse().unwrap());
    let mut rows = open_heights(path, &ReadOptions { raw, ..ReadOptions::default() })?.rows;
    let bytes = rows.height_type().bytes();
    let mut words = vec![0xaaaa_aaaau32; SIDE * SIDE];
    let mut read = |count: usize, is_last: bool| {
        let heights = match bytes {
            1 => HeightsMut::U8(&mut bytemuck::cast_slice_mut(&mut words)[..count]),
            2 => HeightsMut::U16(&mut bytemuck::cast_slice_mut(&mut words)[..count]),
            _ => HeightsMut::F32(&mut bytemuck::cast_slice_mut(&mut words)[..count]),
        };
        if is_last { read_last_row(rows.as_mut(), heights) } else { rows.read(heights) }
    };
    read(SIDE, true)?;
    between();
    read(SIDE * SIDE, false)?;
    Ok(bytemuck::cast_slice(&words)[..SIDE * SIDE * bytes].to_vec())
}

#[test]
fn a_map_that_changes_between_two_readings_is_an_error() {
    let folder = Folder::new();
    for (name, map) in maps(&folder) {
        let path = folder.path(name);
        let original = fs::read(&path).unwrap();
        let restore = || {
            let _ = fs::remove_file(&path).or_else(|_| fs::remove_dir(&path));
            fs::write(&path, &original).unwrap();
            age(&path);
        };
        let changes: [(&str, &dyn Fn()); 9] = [
            ("other bytes of the same length", &|| {
                let mut file = File::options().write(true).open(&path).unwrap();
                file.seek(SeekFrom::Start(original.len() as u64 / 2)).unwrap();
                file.write_all(b"!").unwrap();
            }),
            ("the same bytes, written again", &|| fs::write(&path, &original).unwrap()),
            ("cut", &|| File::options().write(true).open(&path).unwrap().set_len(99).unwrap()),
            ("longer", &|| File::options().append(true).open(&path).unwrap().write_all(b"more").unwrap()),
            ("another size in its place", &|| drop(folder.grey8(name, 20, SIDE, bumps8))),
            ("another file", &|| {
                fs::copy(&path, folder.path("copy")).unwrap();
                fs::rename(folder.path("copy"), &path).unwrap();
            }),
            ("nothing", &|| fs::remove_file(&path).unwrap()),
            ("a folder", &|| {
                fs::remove_file(&path).unwrap();
                fs::create_dir(&path).unwrap();
            }),
            ("a pipe", &|| {
                fs::remove_file(&path).unwrap();
                fifo(&path);
            }),
        ];
        for (what, change) in changes {
            restore();
            let error = read_twice(&path, change).expect_err(what).to_string();
            let expected = "it changed or went while it was read; run again once it is complete";
            assert_eq!(error, format!("{}: {expected}", path.display()), "{what}");
        }
        restore();
        assert!(read_twice(&path, || ()).unwrap() == bytes(&map), "{name} unchanged");
    }
}

#[test]
fn a_normal_map_that_changes_while_it_is_read_is_an_error() {
    let folder = Folder::new();
    folder.grey16("h.png", SIDE, SIDE, bumps16);
    for name in ["n.png", "n.tif", "n.exr"] {
        folder.run(&["normal", "h.png", "-o", name, "--quiet"]).ends(0);
        let path = folder.path(name);
        age(&path);
        let read = |change: bool| {
            let mut rows = open_normals(&path, &NormalReadOptions::default()).unwrap().rows;
            let mut codes = Codes::zeroed(rows.format().depth, 3 * SIDE * SIDE);
            rows.read(codes.as_mut().slice(0..3 * SIDE))?;
            if change {
                File::options().append(true).open(&path).unwrap().write_all(b"more").unwrap();
            }
            rows.read(codes.as_mut().slice(3 * SIDE..3 * SIDE * SIDE))
        };
        read(false).unwrap();
        assert!(read(true).unwrap_err().to_string().contains("it changed or went while it was read"), "{name}");
    }
}

/// A map of zeros whose bytes are a hole in its file.
fn sparse_raw(folder: &Folder, name: &str, rows: u64) -> String {
    let path = folder.file(name, "");
    File::options().write(true).open(&path).unwrap().set_len(4096 * rows).unwrap();
    age(&path);
    format!("4096x{rows}:u8")
}

/// Runs a bake that takes long enough for `meddle` to come in between; `ended` says whether it came too late.
fn meddled(meddle: impl Fn(&Folder), judge: impl Fn(&Folder, Run)) {
    // A machine that is done too early gets more to do.
    for rows in [4096, 16384, 65536] {
        let folder = Folder::new();
        let layout = sparse_raw(&folder, "h.raw", rows);
        fs::create_dir(folder.path("out")).unwrap();
        let mut command = folder.command(&["normal", "h.raw", "--raw", &layout, "-o", "out/n.png"]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        assert!(reaches(&mut child, PAUSE, || !folder.files("out").is_empty()), "it ended without an output");
        meddle(&folder);
        let run = Run::from(child.wait_with_output().unwrap());
        if run.status != 0 {
            judge(&folder, run.ends(1));
            return;
        }
    }
    panic!("every bake was done too early");
}

#[test]
fn an_input_that_is_written_during_the_bake_leaves_no_map() {
    let write = |folder: &Folder| {
        let mut file = File::options().write(true).open(folder.path("h.raw")).unwrap();
        file.write_all(b"!").unwrap();
    };
    let cut = |folder: &Folder| File::options().write(true).open(folder.path("h.raw")).unwrap().set_len(5000).unwrap();
    let remove = |folder: &Folder| fs::remove_file(folder.path("h.raw")).unwrap();
    let changes: [&dyn Fn(&Folder); 3] = [&write, &cut, &remove];
    for change in changes {
        meddled(change, |folder, run| {
            run.says("error: h.raw: ", &["it changed or went while it was read", "run again once it is complete"]);
            assert_eq!(folder.files("out"), [""; 0]);
        });
    }
}

#[test]
fn an_output_folder_that_goes_during_the_bake_is_an_error() {
    meddled(
        |folder| fs::remove_dir_all(folder.path("out")).unwrap(),
        |folder, run| {
            run.says("error: ", &["out/n.png: its folder went while it was written; run it again"]);
            assert!(!folder.path("out").exists());
        },
    );
    meddled(
        |folder| fs::rename(folder.path("out"), folder.path("other")).unwrap(),
        |folder, run| {
            run.says("error: ", &["out/n.png: its folder went while it was written; run it again"]);
            assert!(folder.files("other").iter().all(|name| name.starts_with(".texbake-")));
            // What was left in the other folder goes with the next bake into it.
            folder.grey8("small.png", 3, 3, bumps8);
            folder.run(&["normal", "small.png", "-o", "other/n.png"]).ends(0);
            assert_eq!(folder.files("other"), ["n.png"]);
        },
    );
}
