//! `texbake shaders`.

use super::support::Folder;
use texbake::shading::{LIBRARY, ShaderLanguage};

#[test]
fn every_language_is_written_as_the_library_gives_it() {
    let folder = Folder::new();
    for name in ShaderLanguage::NAMES {
        let language: ShaderLanguage = name.parse().unwrap();
        // Folders that are not there are made; without --lang it is WGSL.
        let out = format!("deep/{name}");
        let all = ["shaders", "-o", &out, "--lang", name];
        let run = folder.run(if *name == "wgsl" { &all[..3] } else { &all }).ends(0);
        let mut written: Vec<String> = run.stdout.lines().map(str::to_owned).collect();
        written.sort();
        let files = folder.files(&out);
        assert_eq!(written, files.iter().map(|file| format!("{out}/{file}")).collect::<Vec<_>>());
        assert_eq!(files.len(), LIBRARY.len(), "nothing else: {files:?}");
        for file in LIBRARY {
            let path = folder.path(&out).join(file.file_name(language));
            assert_eq!(std::fs::read(path).unwrap(), file.in_language(language), "{}", file.name);
        }
    }
}

#[test]
fn files_of_the_same_names_are_replaced_and_others_stay() {
    let folder = Folder::new();
    folder.file("out/lighting.hlsl", "old");
    folder.file("out/mine.hlsl", "mine");
    let run = folder.run(&["shaders", "--lang", "hlsl", "--output", "out", "--quiet"]).ends(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    assert_eq!(std::fs::read_to_string(folder.path("out/mine.hlsl")).unwrap(), "mine");
    assert!(std::fs::read_to_string(folder.path("out/lighting.hlsl")).unwrap().contains("two_lights"));
    assert_eq!(folder.files("out").len(), LIBRARY.len() + 1);
}

#[test]
fn the_list_has_every_function() {
    let folder = Folder::new();
    let list = folder.run(&["shaders", "--list"]).ends(0).stdout;
    assert_eq!(list.lines().count(), LIBRARY.len());
    assert!(list.contains("welsh_offset.wgsl: welsh_offset, limited_offset\n"), "{list}");
    assert!(folder.files(".").is_empty(), "nothing is written");
}

#[test]
fn help_explains_and_mistakes_are_named() {
    let folder = Folder::new();
    let help = folder.run(&["shaders", "--help"]).ends(0).stdout;
    for word in ["--lang", "--output", "--list", "relief_offset", "spirv", "Exit status"] {
        assert!(help.contains(word), "{word}");
    }
    let wrong = folder.run(&["shaders", "--lang", "cg", "-o", "out"]).ends(2).stderr;
    assert!(wrong.contains("wgsl, glsl, hlsl, msl, spirv"), "{wrong}");
    let nowhere = folder.run(&["shaders"]).ends(2).stderr;
    assert!(nowhere.contains("--output <DIR>"), "{nowhere}");
    // A file where a folder should be, and a folder where a file should be.
    folder.file("taken", "");
    let error = folder.run(&["shaders", "-o", "taken/shaders"]).ends(1).stderr;
    assert!(error.contains("taken/shaders/decode_normal.wgsl"), "{error}");
    folder.file("out/lighting.wgsl/x", "");
    let error = folder.run(&["shaders", "-o", "out"]).ends(1).stderr;
    assert!(error.contains("out/lighting.wgsl: it is a folder"), "{error}");
}
