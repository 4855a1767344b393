//! `texbake check`: what is printed, and how it ends.

use super::support::{Folder, bumps16, png, read_png};
use texbake::{CodesRef, Depth, Encoding};

/// Columns and rows of the maps.
const SIDE: usize = 32;

/// A folder with a sound map, `sound.png`.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.grey16("height.png", SIDE, SIDE, smooth);
    folder.run(&["normal", "height.png", "-o", "sound.png", "--scale", "10", "-q"]).ends(0);
    folder
}

/// Heights that tile.
fn smooth(x: usize, y: usize) -> u16 {
    let turn = |i: usize, n: usize| (i * n) as f64 / SIDE as f64 * std::f64::consts::TAU;
    (32_768.0 + 12_000.0 * (turn(x, 2) + turn(y, 1)).sin() + 9000.0 * (turn(y, 3) - turn(x, 1)).cos()) as u16
}

/// The 8-bit RGB file `name`, with other codes in some texels.
fn plant(folder: &Folder, name: &str, to: &str, texels: &[(usize, usize, [u8; 3])]) {
    let (width, height, codes) = read_png(&folder.path(name));
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits") };
    let mut codes = codes.to_vec();
    for (x, y, texel) in texels {
        codes[3 * (y * width + x)..][..3].copy_from_slice(texel);
    }
    folder.file(to, png(width, height, png::ColorType::Rgb, png::BitDepth::Eight, &codes));
}

/// The file `name` with an sRGB chunk behind its header.
fn tag_srgb(folder: &Folder, name: &str, to: &str) {
    let bytes = std::fs::read(folder.path(name)).unwrap();
    // Length 1, type, perceptual intent, and the checksum of type and intent.
    let chunk = [0, 0, 0, 1, b's', b'R', b'G', b'B', 0, 0xae, 0xce, 0x1c, 0xe9];
    folder.file(to, [&bytes[..33], &chunk, &bytes[33..]].concat());
}

#[test]
fn sound_maps_are_ok() {
    let folder = folder();
    for (output, more) in [("n.tif", &["--bits", "16"][..]), ("n.exr", &[]), ("dx.png", &["--convention", "dx"])] {
        folder.run(&[&["normal", "height.png", "-o", output, "--scale", "10", "-q"], more].concat()).ends(0);
    }
    let run = folder.run(&["check", "sound.png", "n.tif", "n.exr", "--tiles"]).ends(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("sound.png: ok\nn.tif: ok\nn.exr: ok\n", ""));
    assert_eq!(folder.run(&["check", "dx.png", "--convention", "dx"]).ends(0).stdout, "dx.png: ok\n");
}

#[test]
fn a_map_of_two_channels_in_a_png_is_guessed() {
    let folder = folder();
    folder.run(&["normal", "height.png", "-o", "xy.png", "--channels", "xy", "--scale", "10", "-q"]).ends(0);
    let run = folder.run(&["check", "xy.png"]).ends(1);
    assert!(run.stdout.contains("below-zero: 1024 texels (100%) of z below zero"), "{}", run.stdout);
    assert!(run.stdout.contains("read it with --channels xy\n"), "{}", run.stdout);
    assert_eq!(folder.run(&["check", "xy.png", "--channels", "xy"]).ends(0).stdout, "xy.png: ok\n");
}

#[test]
fn a_map_of_two_channels_in_a_png_is_not_repaired_unless_it_is_said_what_it_is() {
    let folder = folder();
    folder.run(&["normal", "height.png", "-o", "xy.png", "--channels", "xy", "--scale", "10", "-q"]).ends(0);
    let repair = |more: &[&str]| folder.run(&[&["check", "xy.png", "--repair", "-o", "new/n.png"], more].concat());
    let run = repair(&[]).ends(1);
    assert!(run.stdout.contains("  misread: the third channel is no z"), "{}", run.stdout);
    run.says("error: xy.png: it was not repaired", &["--channels xy, or with --channels xyz if it is as it should be"]);
    assert_eq!(folder.files("new"), [""; 0]);
    // Two channels stay two; --channels xyz takes the user by the word. Missing folders are made.
    repair(&["--channels", "xy"]).ends(0);
    let (_, _, codes) = read_png(&folder.path("new/n.png"));
    assert!(matches!(codes.as_ref(), CodesRef::U8(codes) if codes.chunks_exact(3).all(|texel| texel[2] == 0)));
    repair(&["--channels", "xyz"]);
    assert_eq!(folder.files("new"), ["n.png"]);
}

#[test]
fn floats_from_0_to_1_are_guessed_and_can_be_read() {
    let folder = folder();
    folder.run(&["normal", "height.png", "-o", "signed.exr", "--scale", "10", "-q"]).ends(0);
    let signed = texbake::NormalMap::read(folder.path("signed.exr")).unwrap();
    let CodesRef::F32(components) = signed.codes() else { panic!("floats") };
    let stored = components.iter().map(|v| (v + 1.0) / 2.0).collect();
    let stored = texbake::NormalMap::new(signed.size(), signed.format(), texbake::Codes::F32(stored)).unwrap();
    stored.write(folder.path("blender.exr")).unwrap();
    let run = folder.run(&["check", "blender.exr"]).ends(1);
    assert!(run.stdout.contains("as if stored as unorm; read it with --encoding unorm\n"), "{}", run.stdout);
    let run = folder.run(&["check", "blender.exr", "--repair", "-o", "n.exr"]).ends(1);
    run.says("error: blender.exr", &["--encoding unorm, or with --encoding float if it is as it should be"]);
    assert_eq!(folder.run(&["check", "blender.exr", "--encoding", "unorm"]).ends(0).stdout, "blender.exr: ok\n");
    let run = folder.run(&["diff", "signed.exr", "blender.exr", "--tolerance", "0.001"]).ends(1);
    run.says("warning: blender.exr", &["as if stored as unorm; read it with --encoding unorm"]);
    let compare = ["diff", "signed.exr", "blender.exr", "--encoding", "float,unorm", "--tolerance", "0.001"];
    assert_eq!(folder.run(&compare).ends(0).stderr, "");
    // Blends and parallax maps read it so too.
    let blend = ["blend", "blender.exr", "sound.png", "--base-encoding", "unorm", "-o", "b.exr", "-q"];
    assert_eq!(folder.run(&blend).ends(0).stderr, "");
    let parallax = ["parallax", "height.png", "--normal", "blender.exr", "--normal-encoding", "unorm", "-o", "p.png"];
    folder.run(&[&parallax[..], &["-q"]].concat()).ends(0);
}

#[test]
fn eight_bits_in_the_input_are_told_of_the_repaired_map_too() {
    let folder = folder();
    let (width, height, codes) = read_png(&folder.path("sound.png"));
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits") };
    let wide: Vec<u8> = codes.iter().flat_map(|code| [*code, *code]).collect();
    folder.file("wide.png", png(width, height, png::ColorType::Rgb, png::BitDepth::Sixteen, &wide));
    let run = folder.run(&["check", "wide.png", "--repair", "-o", "mended.png"]).ends(1);
    let mended = run.stdout.split_once("\nmended.png: 1 fault\n").unwrap().1;
    assert!(mended.starts_with("  eight-bit: every code is one of 8 bits"), "{mended}");
    assert!(mended.contains("which cannot be mended (found in the input); bake it again"), "{mended}");
}

#[test]
fn written_lines_of_help_fit_a_terminal() {
    for (command, first) in [("check", "Faults, each"), ("diff", "The angle of a texel")] {
        let output = Folder::new().command(&[command, "--help"]).env("COLUMNS", "100").output().unwrap();
        let help = String::from_utf8(output.stdout).unwrap();
        let written = &help[help.find(first).unwrap()..];
        let long: Vec<_> = written.lines().filter(|line| line.chars().count() > 78).collect();
        assert_eq!(long, [""; 0], "{command}");
        assert_eq!(
            written.lines().filter(|line| line.starts_with("  texbake ")).count(),
            if command == "diff" { 3 } else { 4 }
        );
    }
}

#[test]
fn every_fault_is_named_with_its_place_and_its_remedy() {
    let folder = folder();
    plant(&folder, "sound.png", "bad.png", &[(3, 4, [200, 128, 200]), (30, 31, [255, 128, 126]), (9, 9, [128; 3])]);
    let run = folder.run(&["check", "bad.png", "sound.png"]).ends(1);
    let lines: Vec<_> = run.stdout.lines().collect();
    assert_eq!(
        lines,
        [
            "bad.png: 3 faults",
            "  zero-vector: 1 texel (0.098%) of (0, 0, 0), first at column 9, row 9; texbake check --repair makes them \
             flat",
            "  non-unit: 1 texel (0.098%) of a length that rounding a unit vector cannot give, first at column \
             3, row 4, worst 0.8042 at column 3, row 4; texbake check --repair gives them their length",
            "  below-zero: 1 texel (0.098%) of z below zero, pointing into the surface, first at column 30, row 31; if \
             the map is in tangent space at all, texbake check --repair raises z to the least above zero",
            "sound.png: ok",
        ]
    );
    let run = folder.run(&["check", "sound.png", "--convention", "dx"]).ends(1);
    assert!(
        run.stdout.contains("\n  green: green (or red) seems to point the other way, green up (gl) "),
        "{}",
        run.stdout
    );
    tag_srgb(&folder, "sound.png", "srgb.png");
    let run = folder.run(&["check", "srgb.png"]).ends(1);
    assert!(
        run.stdout.starts_with("srgb.png: 1 fault\n  srgb: the file says that its codes are sRGB"),
        "{}",
        run.stdout
    );
}

#[test]
fn seams_are_notes_unless_maps_shall_tile() {
    let folder = Folder::new();
    folder.grey16("height.png", SIDE, SIDE, |x, y| smooth(x, y) / 2 + 500 * x as u16);
    folder.run(&["normal", "height.png", "-o", "n.png", "--scale", "10", "-q"]).ends(0);
    let run = folder.run(&["check", "n.png"]).ends(0);
    assert!(run.stdout.starts_with("n.png: ok\n  note: seam: columns "), "{}", run.stdout);
    let run = folder.run(&["check", "n.png", "--tiles"]).ends(1);
    assert!(run.stdout.starts_with("n.png: 1 fault\n  seam: columns "), "{}", run.stdout);
}

#[test]
fn json_holds_the_same() {
    let folder = folder();
    plant(&folder, "sound.png", "bad.png", &[(3, 4, [200, 128, 200])]);
    let run = folder.run(&["check", "bad.png", "missing.png", "sound.png", "--json"]).ends(1);
    let list: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let [bad, missing, sound] = &list.as_array().unwrap()[..] else { panic!("{list}") };
    assert_eq!((&bad["file"], &bad["ok"], &bad["width"]), (&"bad.png".into(), &false.into(), &SIDE.into()));
    assert_eq!((&bad["encoding"], &bad["bits"], &bad["convention"]), (&"unorm".into(), &"8".into(), &"gl".into()));
    let finding = &bad["findings"][0];
    assert_eq!(
        (&finding["problem"], &finding["severity"], &finding["texels"]),
        (&"non-unit".into(), &"fault".into(), &1.into())
    );
    assert_eq!(finding["at"], serde_json::json!({ "x": 3, "y": 4 }));
    assert_eq!(finding["share"], 1.0 / 1024.0);
    assert!((finding["worst"].as_f64().unwrap() - (2.0 * 145f64 * 145.0).sqrt() / 255.0).abs() < 1e-12);
    assert_eq!(bad["texels"]["non-unit"], serde_json::json!({ "count": 1, "first": { "x": 3, "y": 4 } }));
    assert_eq!(missing["ok"], false);
    assert!(missing["error"].as_str().unwrap().starts_with("missing.png: "), "{missing}");
    assert_eq!(
        (&sound["ok"], &sound["findings"], &sound["green"]["likely"]),
        (&true.into(), &serde_json::json!([]), &"gl".into())
    );
    run.says("error: missing.png", &["check how its path is written"]);
}

#[test]
fn a_repair_mends_what_it_can_and_leaves_the_input() {
    let folder = folder();
    plant(&folder, "sound.png", "bad.png", &[(3, 4, [200, 128, 200]), (30, 31, [255, 128, 126]), (9, 9, [128; 3])]);
    let before = std::fs::read(folder.path("bad.png")).unwrap();
    let run = folder.run(&["check", "bad.png", "--repair", "-o", "mended.png"]).ends(0);
    assert!(run.stdout.starts_with("bad.png: 3 faults\n"), "{}", run.stdout);
    assert!(run.stdout.contains("\nmended.png: ok\n"), "{}", run.stdout);
    run.says(
        "mended.png: repaired",
        &["unorm 8 xyz gl", "made flat: 0 texels of NaN, infinity or beyond 65536, 1 of (0, 0, 0)"],
    );
    let (_, _, codes) = read_png(&folder.path("mended.png"));
    let CodesRef::U8(codes) = codes.as_ref() else { panic!("8 bits") };
    let texel = |x: usize, y: usize| &codes[3 * (SIDE * y + x)..][..3];
    // (145, 0, 145) is 45 degrees: 127.5 (1 + 1 / sqrt(2)) is 217.7; the least z is 1 of 255.
    assert_eq!(
        (texel(3, 4), texel(9, 9), texel(30, 31)),
        (&[218, 128, 218][..], &[128, 128, 255][..], &[255, 128, 128][..])
    );
    assert_eq!(std::fs::read(folder.path("bad.png")).unwrap(), before);

    // Green turned around, in another format.
    let turned = ["check", "sound.png", "--repair", "--flip-green", "--output-bits", "32f", "-o", "turned.exr"];
    folder.run(&turned).ends(0).says("turned.exr: repaired", &["float 32f xyz dx"]);
    assert!(folder.run(&["check", "turned.exr"]).ends(1).stdout.contains("  green: "));
    folder.run(&["check", "turned.exr", "--convention", "dx"]).ends(0);
    let biased = ["check", "sound.png", "--repair", "--output-encoding", "biased", "-o", "biased.png"];
    folder.run(&biased).ends(0);
    folder.run(&["check", "biased.png", "--encoding", "biased"]).ends(0);
}

#[test]
fn floats_without_direction_are_made_flat() {
    let folder = Folder::new();
    let mut codes = [0.0, 0.0, 1.0].repeat(16);
    codes[3 * 6] = f32::NAN;
    let size = texbake::Size::new(4, 4).unwrap();
    let format = texbake::NormalFormat { encoding: Encoding::Float, depth: Depth::Float32, ..Default::default() };
    let map = texbake::NormalMap::new(size, format, texbake::Codes::F32(codes)).unwrap();
    map.write(folder.path("nan.exr")).unwrap();
    let run = folder.run(&["check", "nan.exr", "--repair", "-o", "mended.exr"]).ends(0);
    assert!(
        run.stdout
            .contains("no-direction: 1 texel (6.2%) of NaN, infinity or more than 65536, first at column 2, row 1"),
        "{}",
        run.stdout
    );
    run.says("mended.exr: repaired", &["made flat: 1 texel of NaN, infinity or beyond 65536, 0 of (0, 0, 0)"]);
    let mended = texbake::NormalMap::read(folder.path("mended.exr")).unwrap();
    assert_eq!(mended.codes(), CodesRef::F32(&[0.0, 0.0, 1.0].repeat(16)));
}

#[test]
fn wrong_input_is_named_and_the_others_are_checked() {
    let folder = folder();
    folder.grey16("grey.png", 8, 8, bumps16);
    folder.file("text.png", "this is text");
    let run = folder.run(&["check", "grey.png", "text.png", "missing.png", "sound.png"]).ends(1);
    run.says("error: grey.png", &["height map"]);
    run.says("error: text.png", &["no format that texbake knows"]);
    run.says("error: missing.png", &["No such file"]);
    assert_eq!(run.stdout, "sound.png: ok\n");
    folder.run(&["check", "sound.png", "--max-bytes", "16"]).ends(1).says("error: sound.png", &["--max-bytes"]);
}

#[test]
fn wrong_arguments_end_with_2() {
    let folder = folder();
    let cases: [(&[&str], &str); 10] = [
        (&["check"], "<FILE>..."),
        (
            &["check", "sound.png", "--repair", "-o", "n.exr", "--output-encoding", "unorm"],
            "--output-encoding is unorm with 8 bits, for n.exr",
        ),
        (
            &["check", "sound.png", "--repair", "-o", "n.png", "--output-encoding", "float", "--output-bits", "8"],
            "--output-bits is 8: it must be 16f or 32f",
        ),
        (&["check", "sound.png", "--repair"], "--output <FILE>"),
        (&["check", "sound.png", "-o", "n.png"], "--repair"),
        (&["check", "sound.png", "--flip-green"], "--repair"),
        (&["check", "sound.png", "sound.png", "--repair", "-o", "n.png"], "--repair takes one FILE, not 2"),
        (&["check", "sound.png", "--repair", "-o", "./sound.png"], "never overwrites it"),
        (&["check", "sound.png", "--encoding", "snorm"], "snorm"),
        (
            &["check", "sound.png", "--repair", "-o", "n.png", "--output-bits", "32f"],
            "--output-encoding is float with 32f",
        ),
    ];
    let files = folder.files(".");
    for (arguments, part) in cases {
        let run = folder.run(arguments);
        let expected = if arguments.contains(&"snorm") { 1 } else { 2 };
        assert_eq!(run.status, expected, "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
    }
    assert_eq!(folder.files("."), files);
}

#[test]
fn help_says_what_each_fault_is() {
    let help = Folder::new().run(&["check", "--help"]).ends(0).stdout;
    for word in [
        "no-direction",
        "zero-vector",
        "misread",
        "non-unit",
        "rounding",
        "below-zero",
        "at-zero",
        "green",
        "srgb",
        "seam",
        "eight-bit",
        "banding",
        "Exit status",
        "--repair",
        "--tiles",
        "--max-bytes",
    ] {
        assert!(help.contains(word), "{word}: {help}");
    }
}
