//! docs/extremes.md, row by row: each row of its tables has one test of its name, which runs on every baker and has its
//! expected values written out.

pub mod blend;
mod bounds;
pub mod normal;
mod parallax;
pub mod shading;
pub mod tangents;

use crate::support::{Format, Image, Subject, assert_each, assert_every_baker, assert_every_parallax, every_baker};
use std::path::Path;
use texbake::{Baker, HeightMap, NormalFormat, NormalOptions, ParallaxOptions, Result, Size};

/// A map that stores these numbers.
fn image<F: Format>(size: Size, format: F, numbers: &[f64]) -> Image<F> {
    Image { size, format, bits: numbers.iter().map(|&number| stored(format, number)).collect() }
}

/// The stored bits of a number, which must be one that the format has.
fn stored(format: impl Format, number: f64) -> u32 {
    use texbake::{Depth, Encoding};
    match format.code() {
        (Encoding::Float, Depth::Float16) => half::f16::from_f64(number).to_bits().into(),
        (Encoding::Float, _) => (number as f32).to_bits(),
        (_, Depth::Bits8) => u32::from(number as i32 as u8),
        _ => u32::from(number as i32 as u16),
    }
}

/// Every baker makes a normal map of these numbers.
pub fn assert_normals(map: &HeightMap, options: &NormalOptions, numbers: &[f64]) {
    assert_every_baker(map, options, &image(map.size(), options.format, numbers));
}

/// The same with one texel, repeated over the map.
pub fn assert_all_normals(map: &HeightMap, options: &NormalOptions, texel: &[f64]) {
    assert_normals(map, options, &texel.repeat(map.size().texels()));
}

/// Every baker makes a parallax map of these numbers.
pub fn assert_parallax(map: &HeightMap, options: &ParallaxOptions, numbers: &[f64]) {
    assert_every_parallax(map, options, &image(map.size(), options.format, numbers));
}

/// What differs, in words.
fn same<T: PartialEq + std::fmt::Debug>(what: &str, got: &T, expected: &T) -> Result<(), String> {
    if got == expected { Ok(()) } else { Err(format!("{what}: got {got:?}, expected {expected:?}")) }
}

/// Every baker refuses with this message.
pub fn assert_refused<T>(run: impl Fn(&Baker) -> Result<T>, message: &str) {
    assert_each(every_baker().iter(), |Subject { name, baker }| match run(baker) {
        Ok(_) => Err(format!("{name} does not refuse: {message}")),
        Err(error) => same(name, &error.to_string().as_str(), &message),
    });
}

/// The names in the first columns of the tables; every other column says something.
fn rows() -> Vec<String> {
    let text = include_str!("../../docs/extremes.md");
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_end().trim_end_matches('|').split(" | ").map(str::trim).collect();
        assert!(cells.len() == 5 && cells.iter().all(|cell| !cell.is_empty()), "five columns: {row}");
        cells[0].trim_end_matches('`').to_owned()
    })
    .collect()
}

/// The names of all tests beside this file.
fn tests() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/extremes");
    let files = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut names = Vec::new();
    for file in files.filter(|file| !file.ends_with("mod.rs")) {
        let text = std::fs::read_to_string(&file).expect("a source");
        let tests = text.split("#[test]\n").skip(1).map(|test| test.trim_start().trim_start_matches("fn "));
        names.extend(tests.map(|test| test.split('(').next().unwrap_or_default().to_owned()));
    }
    names
}

#[test]
fn each_operation_has_a_table() {
    let text = include_str!("../../docs/extremes.md");
    let names: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    assert_eq!(names, ["Bakes", "Parallax maps", "Blends", "Tangents", "Shaders", "Sizes, formats and numbers"]);
    for (name, section) in names.iter().zip(text.split("\n## ").skip(1)) {
        let head = "| extreme | input | mathematics | result | tested on |\n| --- | --- | --- | --- | --- |\n| `";
        assert_eq!(section.matches(head).count(), 1, "{name}");
    }
}

#[test]
fn the_table_and_the_tests_name_the_same_extremes() {
    let (mut rows, mut tests) = (rows(), tests());
    assert!(rows.len() > 50, "{} rows", rows.len());
    rows.sort();
    tests.sort();
    let missing = |from: &[String], of: &[String]| -> Vec<String> {
        of.iter().filter(|name| !from.contains(name)).cloned().collect()
    };
    assert_eq!(missing(&tests, &rows), [""; 0], "rows without a test");
    assert_eq!(missing(&rows, &tests), [""; 0], "tests without a row");
    assert_eq!(rows, tests, "a name twice");
}

/// The format of a list of expected texels.
type Expected<'a> = (NormalFormat, &'a [f64]);
