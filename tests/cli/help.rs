//! What the program says about itself, and about wrong arguments.

use super::support::{Folder, bumps8};

#[test]
fn help_names_every_command_and_option() {
    let folder = Folder::new();
    let top = folder.run(&["--help"]).ends(0).stdout;
    for word in [
        "normal",
        "parallax",
        "bake",
        "blend",
        "tangents",
        "preview",
        "devices",
        "Exit status",
        "texbake bake textures --out baked",
    ] {
        assert!(top.contains(word), "{word}");
    }
    let shared = [
        "--scale",
        "--size",
        "--depth",
        "--filter",
        "--edge",
        "--precision",
        "--encoding",
        "--bits",
        "--channels",
        "--convention",
        "--channel",
        "--color-space",
        "--raw",
        "--max-bytes",
        "--backend",
        "--adapter",
        "--report",
        "--quiet",
    ];
    let normal = folder.run(&["normal", "--help"]).ends(0).stdout;
    let bake = folder.run(&["bake", "--help"]).ends(0).stdout;
    for option in shared {
        assert!(normal.contains(&format!("{option} ")) || normal.contains(&format!("{option}\n")), "{option}");
        assert!(bake.contains(&format!("{option} ")) || bake.contains(&format!("{option}\n")), "{option}");
    }
    for option in
        ["--out ", "--suffix ", "--name ", "--format ", "--config ", "--jobs ", "[[override]]", "texbake.toml"]
    {
        assert!(bake.contains(option), "{option}");
    }
    for option in ["--maps ", "--parallax-encoding ", "--parallax-bits ", "{map}"] {
        assert!(bake.contains(option), "{option}");
    }
    // A metre in a 16-bit elevation model is one of 65535 units.
    let words = normal.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("65535 for 16-bit elevation in metres"), "{normal}");
    assert!(folder.run(&["devices", "--help"]).ends(0).stdout.contains("--json"));
    let version = folder.run(&["--version"]).ends(0).stdout;
    assert_eq!(version.trim_end(), format!("texbake {}", env!("CARGO_PKG_VERSION")));
}

#[test]
fn what_help_shows_works() {
    let folder = Folder::new();
    folder.grey8("height.png", 8, 8, bumps8);
    folder.grey8("mask.png", 8, 8, bumps8);
    for name in ["normal.png", "a.png", "b.png", "base_normal.png", "detail_normal.png", "dx.tif", "n.png"] {
        folder.run(&["normal", "height.png", "-o", name, "--scale", "3", "-q"]).ends(0);
    }
    for (command, count) in [("parallax", 3), ("blend", 6)] {
        let help = folder.run(&[command, "--help"]).ends(0).stdout;
        let begin = format!("  texbake {command} ");
        let examples: Vec<&str> = help.lines().filter(|line| line.starts_with(&begin)).collect();
        assert_eq!(examples.len(), count, "{help}");
        for example in examples {
            // A remark may follow in brackets.
            let arguments: Vec<&str> = example.split("   (").next().unwrap().split_whitespace().skip(1).collect();
            assert_eq!(folder.run(&arguments).ends(0).stdout, "", "{example}");
        }
    }
    assert!(folder.path("parallax.json").exists());
}

#[test]
fn written_lines_of_help_fit_the_usual_width() {
    let folder = Folder::new();
    // What is written by hand below the options: the same at 80 columns, which many terminals have, and at 110.
    let text = |command: &str, columns: &str| {
        let output = folder.command(&[command, "--help"]).env("COLUMNS", columns).output().unwrap();
        let help = String::from_utf8(output.stdout).unwrap();
        help.split_once("--quiet").unwrap().1.to_owned()
    };
    for command in ["normal", "parallax", "bake", "blend", "tangents"] {
        assert_eq!(text(command, "80"), text(command, "110"), "{command}");
    }
}

#[test]
fn help_says_what_codes_and_precision_mean() {
    let folder = Folder::new();
    for command in ["blend", "parallax"] {
        let help = folder.run(&[command, "--help"]).ends(0).stdout;
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("128 (or 32768) reads as exactly 0"), "{help}");
        assert!(words.contains("correctly rounded for 8- and 16-bit maps; floats are computed as IEEE f32"), "{help}");
    }
}

#[test]
fn without_arguments_it_shows_its_help() {
    let run = Folder::new().run(&[]).ends(2);
    assert!(run.stderr.contains("Usage: texbake <COMMAND>"), "{}", run.stderr);
}

#[test]
fn wrong_arguments_end_with_2_and_say_what_is_right() {
    let folder = Folder::new();
    folder.grey8("h.png", 3, 3, bumps8);
    let cases: [(&[&str], &[&str]); 18] = [
        (&["frobnicate"], &["unrecognized subcommand 'frobnicate'"]),
        (&["normal", "h.png"], &["--output <FILE>"]),
        (&["bake", "."], &["--out <FOLDER>"]),
        (&["bake", "--out", "o"], &["<PATH>..."]),
        (&["normal", "h.png", "-o", "n.png", "--scales", "1"], &["--scales", "'--scale'"]),
        (
            &["normal", "h.png", "-o", "n.png", "--scale", "x"],
            &["'x' for '--scale", "it must be an integer, a decimal"],
        ),
        (&["normal", "h.png", "-o", "n.png", "--scale", "99999999"], &["--scale is 99999999", "16777215"]),
        (&["normal", "h.png", "-o", "n.png", "--scale", "1", "--size", "1x1"], &["cannot be used with", "--size"]),
        (&["normal", "h.png", "-o", "n.png", "--size", "1x1"], &["--depth is missing", "with --size"]),
        (&["normal", "h.png", "-o", "n.png", "--depth", "1"], &["--size is missing", "with --depth"]),
        (&["normal", "h.png", "-o", "n.png", "--size", "1x0"], &["'1x0' for '--size", "above zero"]),
        (&["normal", "h.png", "-o", "n.png", "--edge", "repeat"], &["'repeat' for '--edge", "wrap, clamp or mirror"]),
        (&["normal", "h.png", "-o", "n.png", "--filter", "sobl"], &["'sobl'", "central, sobel, scharr, prewitt"]),
        (&["normal", "h.png", "-o", "n.png", "--encoding", "unorm", "--bits", "32f"], &["--bits is 32f", "8 or 16"]),
        (&["normal", "h.png", "-o", "n.png", "--raw", "3x3"], &["'3x3' for '--raw"]),
        (&["normal", "h.png", "-o", "n.png", "--max-bytes", "lots"], &["'lots' for '--max-bytes", "512M or 4G"]),
        (
            &["normal", "h.png", "-o", "n.png", "--backend", "cpu", "--adapter", "x"],
            &["--adapter is x", "--backend gpu"],
        ),
        (&["bake", ".", "--out", "o", "--name", "{name}"], &["'{name}' for '--name", "{stem} and {size}"]),
    ];
    for (arguments, parts) in cases {
        let run = folder.run(arguments).ends(2);
        for part in parts {
            assert!(run.stderr.contains(part), "{arguments:?}: {part:?} is not in {}", run.stderr);
        }
    }
    assert_eq!(folder.files("."), ["h.png"]);
}
