//! Bad input: each file's error names it, says why and what to do; the others go on.

use super::support::{Folder, bumps8, png, read_png};

/// Files that cannot be baked, and what is said about them.
fn bad_files(folder: &Folder) -> Vec<(&'static str, &'static [&'static str])> {
    let whole = png(64, 64, png::ColorType::Grayscale, png::BitDepth::Eight, &noise(64 * 64));
    let header = |width: u32, height: u32| {
        let mut bytes = whole.clone();
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let checksum = crc(&bytes[12..29]).to_be_bytes();
        bytes[29..33].copy_from_slice(&checksum);
        bytes
    };
    let mut differing = vec![50; 4 * 4 * 3];
    differing[3 * (4 * 2 + 1)] = 51;
    folder.file("tex/text_height.png", "this is text");
    folder.file("tex/empty_height.png", "");
    folder.file("tex/truncated_height.png", &whole[..whole.len() / 2]);
    folder.file("tex/zero_height.png", header(0, 64));
    folder.file("tex/huge_height.png", header(1 << 30, 1 << 30));
    folder.file("tex/colour_height.png", png(4, 4, png::ColorType::Rgb, png::BitDepth::Eight, &differing));
    folder.file("tex/nan_height.raw", [1.0, 2.0, f32::NAN, 4.0].map(f32::to_le_bytes).concat());
    folder.file("tex/short_height.r32", [0; 15]);
    vec![
        ("text_height.png", &["no format that texbake knows", "texbake reads PNG"]),
        ("empty_height.png", &["empty", "export it again"]),
        ("truncated_height.png", &["truncated", "export it again"]),
        ("zero_height.png", &["dimensions", "export it again"]),
        ("huge_height.png", &["1073741824 x 1073741824", ";"]),
        ("colour_height.png", &["channels differ, first at column 1, row 2", "--channel"]),
        ("nan_height.raw", &["column 0, row 1 is NaN", "replace it"]),
        ("short_height.r32", &["15", ";"]),
    ]
}

const SETTINGS: &str = "[[override]]\nglob = '*.r*'\nraw = '2x2:f32le'\n";

#[test]
fn bad_files_do_not_stop_the_others() {
    let folder = Folder::new();
    let bad = bad_files(&folder);
    folder.file("tex/texbake.toml", SETTINGS);
    folder.grey8("tex/a_height.png", 8, 8, bumps8);
    folder.grey8("tex/z_height.png", 8, 8, bumps8);
    let run = folder.run(&["bake", "tex", "--out", "out", "--report", "report.json"]).ends(1);
    for (name, parts) in &bad {
        run.says(&format!("failed tex/{name}"), parts);
    }
    assert_eq!(folder.files("out"), ["a_normal.png", "z_normal.png"]);
    let summary = run.stdout.lines().last().unwrap();
    assert!(summary.starts_with("2 of 10 files baked, 8 failed; "), "{summary}");

    let report = folder.json("report.json");
    for file in report["files"].as_array().unwrap() {
        let name = file["input"].as_str().unwrap().strip_prefix("tex/").unwrap();
        match bad.iter().find(|(bad, _)| *bad == name) {
            None => assert_eq!((&file["result"], &file["error"]), (&"baked".into(), &serde_json::Value::Null)),
            Some((_, parts)) => {
                assert_eq!(file["result"], "failed");
                let error = file["error"].as_str().unwrap();
                assert!(error.contains(name) && parts.iter().all(|part| error.contains(part)), "{error}");
            }
        }
    }
}

#[test]
fn a_bad_file_alone_gives_its_error_and_no_output() {
    let folder = Folder::new();
    let mut bad = bad_files(&folder);
    bad.push(("missing.png", &["No such file", "check how its path is written"]));
    for (name, parts) in bad {
        let input = format!("tex/{name}");
        let raw: &[&str] = if name.contains(".r") { &["--raw", "2x2:f32le"] } else { &[] };
        let run = folder.run(&[&["normal", &input, "-o", "normal.png", "--quiet"], raw].concat()).ends(1);
        run.says(&format!("error: {input}"), parts);
        assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    }
    assert!(folder.files(".").iter().all(|file| file.starts_with("tex/")), "{:?}", folder.files("."));
}

#[test]
fn sizes_above_the_limit_are_refused_and_can_be_allowed() {
    let folder = Folder::new();
    folder.grey8("wide_height.png", 5000, 2, bumps8);
    let run = folder.run(&["normal", "wide_height.png", "-o", "normal.png", "--max-bytes", "1K"]).ends(1);
    run.says("error: wide_height.png", &["5000 x 2", "limit of 1024", "--max-bytes"]);
    folder.run(&["normal", "wide_height.png", "-o", "normal.png", "--max-bytes", "1M"]).ends(0);
    assert_eq!(read_png(&folder.path("normal.png")).0, 5000);
}

#[test]
fn unknown_extensions_and_formats_name_the_known_ones() {
    let folder = Folder::new();
    folder.grey8("height.png", 3, 3, bumps8);
    for (output, reason) in [("normal.jpg", "extension .jpg is unknown"), ("normal", "no extension")] {
        let run = folder.run(&["normal", "height.png", "-o", output]).ends(1);
        run.says(&format!("error: {output}"), &[reason, "texbake writes .png"]);
    }
    let run = folder.run(&["normal", "height.png", "-o", "normal.png", "--encoding", "snorm"]).ends(2);
    run.says("error: --encoding is snorm with 8 bits, for normal.png: ", &["unorm or biased in PNG"]);
    assert_eq!(folder.files("."), ["height.png"]);
}

#[test]
fn what_a_format_cannot_hold_is_known_before_anything_runs() {
    let folder = Folder::new();
    folder.grey8("tex/h.png", 3, 3, bumps8);
    // Not even the inputs are looked at.
    let cases: [(&[&str], &str); 6] = [
        (
            &["normal", "gone.png", "-o", "n.exr", "--bits", "16"],
            "--encoding is unorm with 16 bits, for n.exr: it must be float with 16f or 32f bits in EXR",
        ),
        (&["normal", "gone.png", "-o", "n.tif", "--bits", "16f"], "--encoding is float with 16f bits, for n.tif"),
        (&["parallax", "gone.png", "-o", "p.png", "--encoding", "snorm"], "for p.png: it must be biased in PNG"),
        (&["blend", "gone.png", "gone.png", "-o", "n.png", "--bits", "32f"], "--encoding is float with 32f bits"),
        (
            &["bake", "tex", "--suffix", "h", "--out", "o", "--format", "exr", "--bits", "8"],
            "--encoding is unorm with 8 bits, for normal.exr",
        ),
        (
            &["bake", "tex", "--suffix", "h", "--out", "o", "--maps", "parallax", "--parallax-encoding", "snorm"],
            "--parallax-encoding is snorm with 8 bits, for parallax.png: it must be biased in PNG",
        ),
    ];
    for (arguments, message) in cases {
        folder.run(arguments).ends(2).says("error: ", &[message]);
    }
    assert_eq!(folder.files("."), ["tex/h.png"]);
}

#[test]
fn targets_that_cannot_be_written_fail_alone() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 3, bumps8);
    folder.grey8("tex/sub/b_height.png", 3, 3, bumps8);
    // Where b's folder should be, there is a file: that stops the system's administrator too.
    folder.file("out/sub", "in the way");
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(1);
    run.says("failed ", &["out", "sub", "a part of its path is a file"]);
    assert_eq!(folder.files("out"), ["a_normal.png", "sub"]);
    assert_eq!(std::fs::read(folder.path("out/sub")).unwrap(), b"in the way");

    let run = folder.run(&["normal", "tex/a_height.png", "-o", "out/sub/n.png"]).ends(1);
    run.says("error: ", &["out", "sub", "choose another folder"]);
    std::fs::create_dir(folder.path("folder.png")).unwrap();
    let run = folder.run(&["normal", "tex/a_height.png", "-o", "folder.png"]).ends(1);
    run.says("folder.png", &["it is a folder", "name of a file"]);
    let run = folder.run(&["normal", "tex/a_height.png", "-o", "n.png", "--report", "out/sub/r.json"]).ends(1);
    run.says("error: out/sub/r.json", &["choose another folder"]);
}

/// Deterministic noise, so that compressed data is as long as the plain.
fn noise(count: usize) -> Vec<u8> {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(1664525).wrapping_add(1013904223);
        (state >> 24) as u8
    };
    (0..count).map(|_| next()).collect()
}

/// CRC-32 as PNG defines it.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum, _| if sum & 1 == 1 { (sum >> 1) ^ 0xedb8_8320 } else { sum >> 1 })
    })
}
