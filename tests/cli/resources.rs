//! `--memory` and `--threads` hold, whatever the files, and change no byte.

#![cfg(target_os = "linux")]

use super::support::{Folder, bumps8, bumps16, peak_bytes};
use crate::faults::watched::{PAUSE, reaches};
use crate::io::hand_made_png::of_chunks;
use crate::large::files::Kind;
use crate::support::{map_f32, map_u16};
use std::collections::BTreeSet;
use std::io::Write;
use std::process::{Child, Command, Stdio};

const MEBIBYTE: u64 = 1 << 20;

/// First column, first row, and the steps of the passes of an interlaced PNG (PNG, third edition, section 8.1).
const ADAM7: [[usize; 4]; 7] =
    [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

/// An interlaced 16-bit PNG: it is decoded whole.
fn interlaced(width: usize, height: usize) -> Vec<u8> {
    let mut rows = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    for [left, top, across, down] in ADAM7 {
        for y in (top..height).step_by(down) {
            let codes = (left..width).step_by(across).flat_map(|x| bumps16(x, y).to_be_bytes());
            rows.write_all(&[0].into_iter().chain(codes).collect::<Vec<u8>>()).unwrap();
        }
    }
    of_chunks([width as u32, height as u32], [16, 0, 1], &[(b"IDAT", rows.finish().unwrap())])
}

/// A folder `tex` of files that are read row by row, in strips, in blocks, and whole; and of how many.
fn textures() -> (Folder, usize) {
    let folder = Folder::new();
    folder.file(
        "tex/texbake.toml",
        "[defaults]\nscale = 24\n[[override]]\nglob = '*.raw'\nraw = '1700x1300:u16le'\nedge = 'clamp'\n",
    );
    for (name, width, height) in [("large", 2500, 1800), ("small", 300, 200)] {
        let path = |kind: &str| folder.path(&format!("tex/{name}_{kind}"));
        folder.grey16(&format!("tex/{name}_plain_height.png"), width, height, bumps16);
        folder.file(&format!("tex/{name}_interlaced_height.png"), interlaced(width, height));
        Kind::TiffStrips.write(&path("strips_height.tif"), &map_u16(width, height, bumps16));
        let floats = map_f32(width / 2, height / 2, |x, y| f32::from(bumps16(x, y)) / 65535.0);
        Kind::ExrLines.write(&path("lines_height.exr"), &floats);
        Kind::ExrTiles.write(&path("tiles_height.exr"), &floats);
        let grey = image::GrayImage::from_fn(2 * width as u32, 2 * height as u32, |x, y| {
            image::Luma([bumps8(x as usize / 16, y as usize / 16)])
        });
        grey.save(path("whole_height.jpg")).unwrap();
    }
    Kind::Raw.write(&folder.path("tex/raw_height.raw"), &map_u16(1700, 1300, bumps16));
    // Enough of those that are decoded whole for all at once to be too many.
    for copy in 0..4 {
        for file in ["interlaced_height.png", "whole_height.jpg"] {
            let name = format!("tex/copy{copy}_{file}");
            std::fs::hard_link(folder.path(&format!("tex/large_{file}")), folder.path(&name)).unwrap();
        }
    }
    let files = folder.files("tex").len() - 1;
    (folder, files)
}

fn bake(folder: &Folder, out: &str, memory: Option<u64>) -> Command {
    let mut command = folder.command(&["bake", "tex", "--out", out, "--jobs", "8", "--backend", "cpu"]);
    command.args(memory.iter().flat_map(|mebibytes| ["--memory".into(), format!("{mebibytes}M")]));
    command
}

/// The number before `M` behind `words`.
#[track_caller]
fn mebibytes(text: &str, words: &str) -> u64 {
    let (_, rest) = text.split_once(words).unwrap_or_else(|| panic!("{words:?} is not in: {text}"));
    rest.split_once('M').and_then(|(number, _)| number.parse().ok()).unwrap_or_else(|| panic!("no number: {text}"))
}

/// What the program takes before any file, as it says.
fn least(folder: &Folder) -> u64 {
    let least = told_least(bake(folder, "none", Some(1)));
    assert_eq!(folder.files("none"), [""; 0]);
    least
}

/// The same, of a command with `--memory 1M`.
#[track_caller]
fn told_least(mut command: Command) -> u64 {
    let run = super::support::Run::from(command.output().unwrap()).ends(2);
    mebibytes(&run.stderr, "--memory is 1M: it must be above ")
}

fn outputs(folder: &Folder, out: &str) -> Vec<(String, Vec<u8>)> {
    let read = |name: String| (name.clone(), std::fs::read(folder.path(out).join(name)).unwrap());
    folder.files(out).into_iter().map(read).collect()
}

#[test]
fn the_bound_holds_and_changes_no_byte() {
    let (folder, files) = textures();
    let least = least(&folder);

    // With next to nothing for rows the large ones fail, each by itself, and say what they need.
    let tight = super::support::Run::from(bake(&folder, "tight", Some(least + 5)).output().unwrap()).ends(1);
    let failed: Vec<&str> = tight.stderr.lines().filter(|line| line.contains(" failed tex/")).collect();
    let given = |line: &str| mebibytes(line, "memory is ");
    let needed = |line: &str| mebibytes(line, ": it must be at least ");
    assert!(failed.iter().all(|line| given(line) == least + 5 && needed(line) > least + 5), "{failed:?}");
    tight.says("failed tex/large_whole_height.jpg", &["memory is ", "it must be at least "]);
    assert!(!failed.is_empty() && failed.len() < files, "{failed:?}");
    assert_eq!(folder.files("tight").len(), files - failed.len());
    let most = failed.iter().map(|line| needed(line)).max().unwrap();

    let unbounded = peak_bytes(&mut quiet(bake(&folder, "unbounded", None)));
    let expected = outputs(&folder, "unbounded");
    assert_eq!(expected.len(), files);
    // The largest by itself, and some at once. The program may take a little more than it did before.
    for memory in [most + 2, 2 * most - least] {
        assert!(unbounded > (memory + memory / 4) * MEBIBYTE, "unbounded, it takes {unbounded} bytes: no more");
        let out = format!("bounded{memory}");
        let peak = peak_bytes(&mut quiet(bake(&folder, &out, Some(memory))));
        assert!(peak <= memory * MEBIBYTE, "--memory {memory}M: {peak} bytes");
        assert!(outputs(&folder, &out) == expected, "--memory {memory}M changes bytes");
    }
    assert!(outputs(&folder, "tight").iter().all(|output| expected.contains(output)));
}

fn quiet(mut command: Command) -> Child {
    command.arg("-q").stdout(Stdio::null()).stderr(Stdio::inherit()).spawn().unwrap()
}

#[test]
fn every_kind_of_output_is_within_the_bound() {
    let folder = Folder::new();
    let levels: &[&str] = &["-o", "n.ktx2", "--mips", "--roughness", "r.ktx2"];
    for ([width, height], outputs) in [
        ([16384, 1024], levels),
        // Each level of the odd size is summed from the largest one.
        ([16383, 1023], levels),
        ([16384, 512], &["-o", "n.dds", "--mips", "--block-compression", "bc5", "--channels", "xy"]),
        ([4096, 2048], &["-o", "n.exr"]),
        // Sixteen rows would be too long for a block.
        ([60_000, 300], &["-o", "n.exr"]),
        ([60_000, 300], &["-o", "n.tif", "--bits", "16"]),
        ([60_000, 300], &["-o", "n.png", "--compression", "small"]),
    ] {
        let file = std::fs::File::create(folder.path("h.raw")).unwrap();
        file.set_len(2 * width * height).unwrap();
        let layout = format!("{width}x{height}:u16le");
        let bake = |memory: &str| {
            let mut command = folder.command(&["normal", "h.raw", "--raw", &layout, "--backend", "cpu"]);
            command.args(outputs).args(["--memory", memory]);
            command
        };
        let least = told_least(bake("1M"));
        let tight = super::support::Run::from(bake(&format!("{}M", least + 2)).output().unwrap()).ends(1);
        let memory = least + 2 + mebibytes(&tight.stderr, ": it must be at least ");
        let peak = peak_bytes(&mut quiet(bake(&format!("{memory}M"))));
        assert!(peak <= memory * MEBIBYTE, "{layout}, {outputs:?}: --memory {memory}M: {peak} bytes");
    }
}

/// Each tile holds the tiles beside it, which are decoded whole.
#[test]
fn tiles_are_within_the_bound() {
    let folder = Folder::new();
    for (x, y) in (0..9).map(|tile| (tile % 3, tile / 3)) {
        folder.file(&format!("tex/tile_{x}_{y}.png"), interlaced(1500, 1100));
    }
    let bake = |out, memory| {
        let mut command = bake(&folder, out, memory);
        command.args(["--neighbours", "tile_{x}_{y}.png"]);
        command
    };
    let least = told_least(bake("none", Some(1)));
    let tight = super::support::Run::from(bake("tight", Some(least + 2)).output().unwrap()).ends(1);
    let needed = tight.stderr.lines().filter(|line| line.contains(" failed tex/"));
    let memory = 2 + needed.map(|line| mebibytes(line, ": it must be at least ")).max().unwrap();
    let unbounded = peak_bytes(&mut quiet(bake("unbounded", None)));
    assert!(unbounded > (memory + memory / 4) * MEBIBYTE, "unbounded, they take {unbounded} bytes: no more");
    let peak = peak_bytes(&mut quiet(bake("bounded", Some(memory))));
    assert!(peak <= memory * MEBIBYTE, "--memory {memory}M: {peak} bytes");
    assert!(outputs(&folder, "bounded") == outputs(&folder, "unbounded"), "--memory {memory}M changes bytes");
}

#[test]
fn an_interrupt_reaches_those_that_wait_for_memory() {
    let folder = Folder::new();
    const FILES: usize = 6;
    // Sparse, and so many rows that no machine is done before the signal comes; a band of 8192 texels is some mebibytes.
    let file = folder.file("tex/a0_height.raw", "");
    std::fs::File::options().write(true).open(&file).unwrap().set_len(8192 * 65536).unwrap();
    for index in 1..FILES {
        std::fs::hard_link(&file, folder.path(&format!("tex/a{index}_height.raw"))).unwrap();
    }
    let least = least(&folder);
    let bake = |memory: u64| {
        let mut command = bake(&folder, "out", Some(memory));
        command.args(["--raw", "8192x65536:u8", "--report", "r.json"]);
        command
    };
    let tight = super::support::Run::from(bake(least + 1).output().unwrap()).ends(1);
    let one = mebibytes(&tight.stderr, ": it must be at least ");
    // Room for one, and not for two.
    let mut child = bake(least + one + one / 2).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = || !folder.files("out").is_empty();
    assert!(reaches(&mut child, PAUSE, begun), "it ended by itself");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    super::support::Run::from(child.wait_with_output().unwrap()).ends(130);
    assert_eq!(folder.files("out"), [""; 0]);
    let report = folder.json("r.json");
    let count = |key: &str| report["totals"][key].as_u64().unwrap() as usize;
    assert_eq!((count("stopped") + count("not_begun"), count("failed")), (FILES, 0), "{}", report["totals"]);
    assert!(count("stopped") > 0, "{}", report["totals"]);
}

/// The cores on which the threads of a process may run, as the system writes them.
fn cores(child: &Child) -> BTreeSet<String> {
    let threads = std::fs::read_dir(format!("/proc/{}/task", child.id())).into_iter().flatten();
    let allowed = threads.filter_map(|thread| {
        let status = std::fs::read_to_string(thread.ok()?.path().join("status")).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"))?;
        Some(line.trim().to_owned())
    });
    allowed.collect()
}

#[test]
fn one_thread_takes_one_core() {
    let folder = Folder::new();
    folder.grey16("tex/a_height.png", 700, 3000, bumps16);
    folder.grey8("tex/b_height.png", 900, 1000, bumps8);
    let mips = ["--format", "ktx2", "--mips", "--maps", "normal,parallax,roughness"];
    let maps = |out: &str, more: &[&str]| {
        folder.command(&[&["bake", "tex", "--out", out, "--backend", "cpu", "-q"], &mips[..], more].concat())
    };
    let one = |out| maps(out, &["--threads", "1", "--jobs", "4"]);
    let mut child = one("one").stderr(Stdio::inherit()).spawn().unwrap();
    // From the first output on, all threads are there.
    assert!(reaches(&mut child, PAUSE, || !folder.files("one").is_empty()), "it ended too soon");
    let cores = cores(&child);
    assert!(child.wait().unwrap().success());
    assert_eq!(cores.len(), 1, "{cores:?}");
    assert!(cores.iter().all(|cores| cores.parse::<usize>().is_ok()), "one core, not {cores:?}");

    assert!(maps("all", &[]).status().unwrap().success());
    assert_eq!(folder.files("all").len(), 6);
    assert!(outputs(&folder, "one") == outputs(&folder, "all"));
}

#[test]
fn no_threads_and_no_memory_are_refused() {
    let folder = Folder::new();
    folder.grey8("h.png", 9, 9, bumps8);
    for (arguments, words) in [
        (["--threads", "0"], ["invalid value '0' for '--threads <N>'", "it must be a whole number from 1 to 65535"]),
        (
            ["--memory", "-1"],
            ["invalid value '-1' for '--memory", "it must be a whole number of bytes from 1 to 16777215T"],
        ),
        (["--memory", "99999999999G"], ["for '--memory <BYTES>'", "from 1 to 16777215T"]),
        (["--threads", "-1"], ["invalid value '-1' for '--threads <N>'", "it must be a whole number from 1 to 65535"]),
        (["--memory", "0"], ["--memory", "0"]),
        (["--memory", "lots"], ["invalid value 'lots' for '--memory <BYTES>'", ""]),
    ] {
        let arguments = [&["normal", "h.png", "-o", "n.png", "--backend", "cpu"], &arguments[..]].concat();
        let run = folder.run(&arguments).ends(2);
        assert!(words.iter().all(|words| run.stderr.contains(words)), "{arguments:?}: {}", run.stderr);
    }
    for jobs in ["0", "-1", "many", "99999999999999999999"] {
        let run = folder.run(&["bake", "h.png", "--out", "out", "--jobs", jobs]).ends(2);
        let words = format!("invalid value '{jobs}' for '--jobs <N>': it must be a whole number from 1 to 65535");
        assert!(run.stderr.contains(&words), "{}", run.stderr);
    }
    assert_eq!(folder.files("."), ["h.png"]);
}
