//! A folder of textures, and which of them a run bakes.

use crate::cli::support::{Folder, RECORD, bumps8, bumps16};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Three textures in two folders.
pub fn textures() -> Folder {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 9, 8, bumps8);
    folder.grey16("tex/b_height.png", 8, 9, bumps16);
    folder.grey8("tex/sub/c_height.png", 7, 7, bumps8);
    folder
}

/// The result of each texture of a run that ends with `status`, by the input's name: `baked: new`, `fresh`.
#[track_caller]
pub fn results_of(folder: &Folder, arguments: &[&str], status: i32) -> BTreeMap<String, String> {
    let report = folder.path("report.json");
    folder.run(&[&["bake", "tex", "--out", "out", "--report", "report.json", "-q"], arguments].concat()).ends(status);
    let results = results(&serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap());
    std::fs::remove_file(report).unwrap();
    results
}

/// The same of a report.
pub fn results(report: &Value) -> BTreeMap<String, String> {
    let result = |file: &Value| {
        let name = Path::new(file["input"].as_str().unwrap()).file_name().unwrap().to_str().unwrap();
        let name = name.strip_suffix("_height.png").unwrap_or(name).to_owned();
        let why = file.get("stale").map(|why| format!(": {}", why.as_str().unwrap()));
        (name, file["result"].as_str().unwrap().to_owned() + &why.unwrap_or_default())
    };
    report["files"].as_array().unwrap().iter().map(result).collect()
}

/// What a run of `arguments` bakes, and why; fails unless the others are fresh.
#[track_caller]
pub fn baked(folder: &Folder, arguments: &[&str]) -> Vec<String> {
    let results = results_of(folder, arguments, 0).into_iter();
    let stale = results.filter(|(_, result)| result != "fresh");
    stale.map(|(name, result)| format!("{name} {}", result.strip_prefix("baked: ").unwrap_or(&result))).collect()
}

pub fn record(folder: &Folder) -> PathBuf {
    folder.path("out").join(RECORD)
}

/// The lines of the record after its header.
pub fn lines(folder: &Folder) -> Vec<Value> {
    lines_of(folder, "out")
}

/// The same of the record in another folder.
pub fn lines_of(folder: &Folder, out: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.path(out).join(RECORD)).unwrap();
    text.lines().skip(1).map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Rewrites the lines of the record.
pub fn change_lines(folder: &Folder, mut change: impl FnMut(&mut Value)) {
    let text = std::fs::read_to_string(record(folder)).unwrap();
    let mut changed = text.lines().next().unwrap().to_owned() + "\n";
    for mut line in lines(folder) {
        change(&mut line);
        changed += &format!("{line}\n");
    }
    std::fs::write(record(folder), changed).unwrap();
}

/// Bakes `input` into `out`: why each texture was baked, by its name.
#[track_caller]
pub fn stale(folder: &Folder, input: &str, out: &str, arguments: &str) -> BTreeMap<String, String> {
    let arguments: Vec<&str> = arguments.split_whitespace().collect();
    folder.run(&[&["bake", input, "--out", out, "--report", "r.json", "-q"], &arguments[..]].concat()).ends(0);
    let results = results(&folder.json("r.json")).into_iter().filter(|(_, result)| result != "fresh");
    results.map(|(name, result)| (name, result.strip_prefix("baked: ").unwrap_or(&result).to_owned())).collect()
}

/// The bytes of each output.
pub fn contents(folder: &Folder) -> BTreeMap<String, Vec<u8>> {
    contents_of(folder, "out")
}

/// The bytes of each file in a folder.
pub fn contents_of(folder: &Folder, out: &str) -> BTreeMap<String, Vec<u8>> {
    let read = |name: String| {
        let bytes = std::fs::read(folder.path(out).join(&name)).unwrap();
        (name, bytes)
    };
    folder.files(out).into_iter().map(read).collect()
}
