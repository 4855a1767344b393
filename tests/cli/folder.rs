//! `texbake bake`: folders in, folders out.

use super::support::{Folder, bumps8, bumps16};
use texbake::{Baker, Depth, Encoding, NormalFormat, NormalOptions};

#[test]
fn a_tree_of_height_maps_becomes_a_tree_of_normal_maps() {
    let folder = Folder::new();
    let maps = [
        ("out/wall_normal.png", folder.grey8("tex/wall_height.png", 20, 11, bumps8)),
        ("out/wall_normal_2k.png", folder.grey16("tex/wall_height_2k.png", 40, 22, bumps16)),
        ("out/brick/Rock_4K_normal.png", folder.grey16("tex/brick/Rock_4K_Displacement.PNG", 9, 9, bumps16)),
        ("out/brick/old/a_normal.png", folder.grey8("tex/brick/old/a_H.png", 1, 5, bumps8)),
        ("out/brick/old/b_normal.png", folder.grey8("tex/brick/old/b_bump.png", 5, 1, bumps8)),
        ("out/brick/old/c_normal_1K.png", folder.grey8("tex/brick/old/c_HeightMap_1K.png", 2, 2, bumps8)),
        ("out/d_normal.png", folder.grey8("tex/d_disp.png", 33, 17, bumps8)),
    ];
    folder.grey8("tex/wall_color.png", 4, 4, bumps8);
    folder.file("tex/notes_height.txt", "not an image");
    folder.file("tex/height.png", "not named as a height map");
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    for (output, map) in &maps {
        folder.assert_baked(output, map, &NormalOptions::default());
    }
    assert_eq!(folder.files("out").len(), maps.len());

    // One line for each file while it runs, since nobody watches a terminal; then the table and the summary.
    assert_eq!(run.stderr.lines().count(), 7, "{}", run.stderr);
    assert!(run.line("tex/wall_height.png").contains("baked"), "{}", run.stderr);
    assert!(run.line("[7/7] ").contains(" ms"), "{}", run.stderr);
    let table: Vec<&str> = run.stdout.lines().collect();
    assert_eq!(table.len(), 9, "{}", run.stdout);
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(table[0]), ["file", "size", "depth", "maps", "ms", "result"]);
    let files: Vec<String> = table[1..8].iter().map(|row| words(row)[0].clone()).collect();
    assert_eq!(
        files,
        [
            "tex/brick/Rock_4K_Displacement.PNG",
            "tex/brick/old/a_H.png",
            "tex/brick/old/b_bump.png",
            "tex/brick/old/c_HeightMap_1K.png",
            "tex/d_disp.png",
            "tex/wall_height.png",
            "tex/wall_height_2k.png",
        ]
    );
    assert_eq!(words(table[7])[1..6], ["40", "x", "22", "u16", "normal"]);
    assert!(table[7].ends_with("baked"), "{}", table[7]);
    assert!(table[8].starts_with("7 of 7 files baked; 0.00 Mtexel in "), "{}", table[8]);
}

#[test]
fn files_are_taken_as_they_are() {
    let folder = Folder::new();
    let plain = folder.grey8("a/plain_2k.png", 6, 6, bumps8);
    let named = folder.grey8("b/wall_disp_2k.png", 6, 7, bumps8);
    // The same file under two spellings is one file.
    let twice = ["b/wall_disp_2k.png", "b/../b/wall_disp_2k.png"];
    let run = folder.run(&[&["bake", "a/plain_2k.png", "-o", "o/p", "-q"], &twice[..]].concat()).ends(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    assert_eq!(folder.files("o"), ["p/plain_2k_normal.png", "p/wall_normal_2k.png"]);
    folder.assert_baked("o/p/plain_2k_normal.png", &plain, &NormalOptions::default());
    folder.assert_baked("o/p/wall_normal_2k.png", &named, &NormalOptions::default());
}

#[test]
fn names_suffixes_and_formats_can_be_chosen() {
    let folder = Folder::new();
    folder.grey8("tex/sub/hill_DEM_8k.png", 6, 6, bumps8);
    folder.grey8("tex/height.png", 6, 6, bumps8);
    folder.grey8("tex/wall_height.png", 6, 6, bumps8);
    let run = |arguments: &[&str]| folder.run(&[&["bake", "tex", "-q"], arguments].concat()).ends(0);
    run(&["--out", "a", "--suffix", "_dem", "--suffix", "_x"]);
    assert_eq!(folder.files("a"), ["sub/hill_normal_8k.png"]);
    run(&["--out", "b", "--suffix", "height", "--name", "{stem}_n{size}"]);
    assert_eq!(folder.files("b"), ["n.png", "wall__n.png"]);
    run(&["--out", "c", "--suffix", "_dem", "--name", "{stem}/N{size}"]);
    assert_eq!(folder.files("c"), ["sub/hill/N_8k.png"]);
    run(&["--out", "d", "--suffix", "_dem", "--jobs", "1", "--bits", "16"]);
    assert_eq!(folder.files("d"), ["sub/hill_normal_8k.png"]);
}

#[test]
fn every_output_format_holds_the_reference_in_its_usual_depth() {
    let folder = Folder::new();
    let map = folder.grey16("tex/a_height.png", 17, 13, bumps16);
    let cases: [(&str, &[&str], Encoding, Depth); 5] = [
        ("png", &[], Encoding::Unorm, Depth::Bits8),
        ("tif", &[], Encoding::Unorm, Depth::Bits16),
        ("tif", &["--encoding", "float"], Encoding::Float, Depth::Float32),
        ("exr", &["--bits", "16f"], Encoding::Float, Depth::Float16),
        ("exr", &[], Encoding::Float, Depth::Float32),
    ];
    for (extension, arguments, encoding, depth) in cases {
        folder.run(&[&["bake", "tex", "--out", "out", "-q", "--format", extension], arguments].concat()).ends(0);
        let options = NormalOptions {
            format: NormalFormat { encoding, depth, ..NormalFormat::default() },
            ..NormalOptions::default()
        };
        let expected = folder.path(&format!("expected.{extension}"));
        Baker::reference().normal(&map, &options).unwrap().write(&expected).unwrap();
        let output = folder.path(&format!("out/a_normal.{extension}"));
        assert!(std::fs::read(output).unwrap() == std::fs::read(expected).unwrap(), "{extension} {encoding} {depth}");
    }
}

#[test]
fn two_inputs_for_one_output_fail_both_and_the_others_go_on() {
    let folder = Folder::new();
    let map = folder.grey8("tex/a_height.png", 6, 6, bumps8);
    folder.grey8("tex/wall_height.png", 6, 6, bumps8);
    folder.grey8("tex/wall_disp.png", 6, 6, bumps8);
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(1);
    let [disp, height] = ["tex/wall_disp.png", "tex/wall_height.png"];
    run.says(&format!("wall_normal.png: both {disp} and {height} would be baked into it"), &["failed", "--name"]);
    run.says(&format!("wall_normal.png: both {height} and {disp} would be baked into it"), &["failed", "--name"]);
    assert_eq!(folder.files("out"), ["a_normal.png"]);
    folder.assert_baked("out/a_normal.png", &map, &NormalOptions::default());
    let summary = run.stdout.lines().last().unwrap();
    assert!(summary.starts_with("1 of 3 files baked, 2 failed; "), "{summary}");
}

#[cfg(unix)]
#[test]
fn two_names_of_one_output_folder_are_one() {
    let folder = Folder::new();
    folder.grey8("tex/a/wall_height.png", 6, 6, bumps8);
    folder.grey8("tex/b/wall_height.png", 6, 6, bumps8);
    folder.file("out/b/there", "");
    std::os::unix::fs::symlink(folder.path("out/b"), folder.path("out/a")).unwrap();
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(1);
    run.says("both tex/a/wall_height.png and tex/b/wall_height.png", &["failed", "would be baked into it"]);
    assert_eq!(folder.files("out/b"), ["there"]);
    // The folder that the link leads to need not exist below it.
    let run = folder.run(&["bake", "tex", "--out", "out", "--name", "new/{stem}"]).ends(1);
    run.says("both tex/b/wall_height.png and tex/a/wall_height.png", &["failed", "would be baked into it"]);
    assert_eq!(folder.files("out/b"), ["there"]);
}

#[test]
fn an_output_that_would_overwrite_an_input_fails_and_the_others_go_on() {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 6, 6, bumps8);
    folder.grey8("tex/b_height.png", 6, 6, bumps8);
    let before = std::fs::read(folder.path("tex/b_height.png")).unwrap();
    let run = folder.run(&["bake", "tex", "--out", "tex", "--name", "{stem}_height"]).ends(1);
    for name in ["tex/a_height.png", "tex/b_height.png"] {
        run.says(&format!("failed {name}: "), &["would overwrite this input", "choose another output"]);
    }
    // One file's output is another file's input: the other is baked, once it has an output of its own.
    folder.grey8("tex/c_h.png", 6, 6, bumps8);
    folder.file("texbake.toml", "[[override]]\nglob = 'c_h.png'\nname = 'b_height'\n");
    let run = folder.run(&["bake", "tex/c_h.png", "tex/b_height.png", "--out", "tex"]).ends(1);
    run.says("failed tex/b_height.png: the output of tex/c_h.png would overwrite this input", &[]);
    assert_eq!(std::fs::read(folder.path("tex/b_height.png")).unwrap(), before);
    assert_eq!(folder.files("tex"), ["a_height.png", "b_height.png", "b_normal.png", "c_h.png"]);
}

#[test]
fn a_folder_without_height_maps_is_an_error_that_says_what_they_are_called() {
    let folder = Folder::new();
    folder.grey8("tex/wall.png", 6, 6, bumps8);
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(1);
    run.says("error: tex: no height map found", &["_height", "_displacement", "--suffix", "name the files"]);
    let run = folder.run(&["bake", "tex", "--out", "out", "--suffix", "_q"]).ends(1);
    run.says("error: tex: no height map found", &["_q"]);
}

#[test]
fn many_files_give_a_table_of_failures_and_the_slowest() {
    let folder = Folder::new();
    for index in 0..41 {
        folder.grey8(&format!("tex/m{index}_h.png"), 2, 2, bumps8);
    }
    let run = folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    let lines: Vec<&str> = run.stdout.lines().collect();
    // What it is, the header, ten files and the summary.
    assert_eq!((lines.len(), lines[0]), (13, "of 41 files the 10 slowest:"), "{}", run.stdout);
    let milliseconds = |row: &&str| row.split_whitespace().rev().nth(1).unwrap().parse::<f64>().unwrap();
    assert!(lines[2..12].iter().all(|row| row.ends_with("baked")), "{}", run.stdout);
    assert!(lines[2..12].is_sorted_by(|a, b| milliseconds(a) >= milliseconds(b)), "{}", run.stdout);
    folder.file("tex/bad_h.png", "");
    let run = folder.run(&["bake", "tex", "--out", "out", "--force"]).ends(1);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert_eq!((lines.len(), lines[0]), (14, "of 42 files 1 not baked, and the 10 slowest:"), "{}", run.stdout);
    assert!(lines[2].contains("tex/bad_h.png") && lines[2].ends_with("failed"), "{}", lines[2]);
    assert!(lines[13].starts_with("41 of 42 files baked, 1 failed; "), "{}", lines[13]);
}

#[cfg(unix)]
#[test]
fn links_are_followed_but_not_in_circles() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 3, 3, bumps8);
    folder.grey8("shared/b_height.png", 3, 3, bumps8);
    symlink(folder.path("tex"), folder.path("tex/again")).unwrap();
    symlink(folder.path("shared"), folder.path("tex/shared")).unwrap();
    symlink(folder.path("gone.txt"), folder.path("tex/gone.txt")).unwrap();
    folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    assert_eq!(folder.files("out"), ["a_normal.png", "shared/b_normal.png"]);
    symlink(folder.path("gone_height.png"), folder.path("tex/gone_height.png")).unwrap();
    folder.run(&["bake", "tex", "--out", "out"]).ends(1).says("failed tex/gone_height.png", &["No such file"]);
}

#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_unicode_are_baked_and_reported() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let map = folder.grey8("tex/plain_height.png", 6, 6, bumps8);
    let name = folder.path("tex").join(OsStr::from_bytes(b"w\xe4nd_height.png"));
    std::fs::rename(folder.path("tex/plain_height.png"), name).unwrap();
    folder.run(&["bake", "tex", "--out", "out", "--report", "report.json"]).ends(0);
    folder.assert_baked("out/w\u{fffd}nd_normal.png", &map, &NormalOptions::default());
    assert_eq!(folder.json("report.json")["files"][0]["input"], "tex/w\u{fffd}nd_height.png");
}

#[test]
fn hidden_files_and_folders_are_left_alone() {
    let folder = Folder::new();
    folder.grey8("tex/wall_h.png", 9, 8, bumps8);
    folder.grey8("tex/.git/x_h.png", 9, 8, bumps8);
    folder.file("tex/._wall_h.png", "macOS keeps notes beside files on shares");
    folder.run(&["bake", "tex", "--out", "out"]).ends(0);
    assert_eq!(folder.files("out"), ["wall_normal.png"]);
    // Unless they are asked for.
    folder.run(&["bake", "tex/.git", "--out", "own"]).ends(0);
    assert_eq!(folder.files("own"), ["x_normal.png"]);
}
