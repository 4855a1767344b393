//! Every option that decides over a byte bakes again what it is for, and no other does.

use super::support::{contents_of, lines_of, stale};
use crate::cli::support::{Folder, bumps8, bumps16, png};
use std::collections::{BTreeMap, BTreeSet};

/// An option by its name in the report, the folder of the inputs, arguments, those that are added to change the option,
/// and the reason that is given then: none if nothing is baked, the beginning of one that ends with a star.
type Case = (&'static str, &'static str, &'static str, &'static str, &'static str);

const CASES: &[Case] = &[
    ("scale", "tex", "", "--scale 24", "scale 1 -> 24"),
    ("scale", "tex", "--size 2x2", "--depth 0.1", "scale 2 x 2 by 0.2 high -> 2 x 2 by 0.1 high"),
    ("filter", "tex", "", "--filter sobel", "filter central -> sobel"),
    ("edge", "tex", "", "--edge wrap,clamp", "edge wrap -> wrap,clamp"),
    ("maps", "tex", "--name {stem}", "--maps parallax", "maps normal -> parallax"),
    ("maps", "tex", "", "--maps normal,parallax", "new"),
    ("encoding", "tex", "", "--encoding biased", "encoding unorm -> biased"),
    ("bits", "tex", "", "--bits 16", "bits 8 -> 16"),
    ("channels", "tex", "", "--channels xy", "channels xyz -> xy"),
    ("convention", "tex", "", "--convention dx", "convention gl -> dx"),
    ("parallax_encoding", "tex", "--maps parallax", "--parallax-encoding unorm", "parallax-encoding biased -> unorm"),
    ("parallax_bits", "tex", "--maps parallax", "--parallax-bits 16", "parallax-bits 8 -> 16"),
    ("iterations", "tex", "--maps parallax", "--iterations 9", ""),
    ("precision", "tex", "--bits 16 --backend cpu", "--precision fast", "precision exact -> fast"),
    ("compression", "tex", "", "--compression balanced", "compression fast -> balanced"),
    ("compression", "tex", "", "--compression small", "compression fast -> small"),
    ("compression", "tex", "--format tif", "--config without_effect.toml", ""),
    ("mips", "tex", "--format ktx2", "--mips", "mips false -> true"),
    ("mips", "tex", "--format dds --block-compression bc5", "--mips", "mips false -> true"),
    ("roughness_method", "tex", ROUGH, "--roughness-method toksvig", "roughness-method lean -> toksvig"),
    ("base_roughness", "tex", ROUGH, "--base-roughness 0.25", "base-roughness 0 -> 0.25"),
    ("roughness_bits", "tex", ROUGH, "--roughness-bits 16", "roughness-bits 8 -> 16"),
    ("roughness_method", "tex", "--format ktx2", "--config without_effect.toml", ""),
    ("base_roughness", "tex", "--format ktx2 --mips", "--config without_effect.toml", ""),
    ("roughness_bits", "tex", "--format dds", "--config without_effect.toml", ""),
    ("block_compression", "tex", "--format dds", "--block-compression bc7", "block-compression none -> bc7"),
    ("block_compression", "tex", "--format ktx2", "--block-compression bc5", "block-compression none -> bc5"),
    ("neighbours", "tiles", "", "--neighbours t_{x}_{y}_height.png", "neighbours off -> on"),
    ("neighbours", "tiles", "--neighbours t_{x}_{y}_height.png", "--overlap 1", "neighbour-*"),
    ("channel", "colours", "--channel r", "", "channel g -> r"),
    ("color_space", "tex", "", "--color-space srgb", "color-space linear -> srgb"),
    ("raw", "raw", "--raw 16x16:u16le", "", "raw 16x16:u16be -> 16x16:u16le"),
    ("shrink", "tex", "", "--shrink 2", "shrink 1 -> 2"),
    ("max_bytes", "tex", "", "--max-bytes 1G", ""),
];

/// All that a roughness map needs.
const ROUGH: &str = "--format dds --mips --maps normal,roughness";

/// What stands in the place of an argument that cannot be left out, or be given twice.
fn before(option: &str, arguments: &str) -> String {
    match (option, arguments) {
        ("channel", _) => "--channel g".into(),
        ("raw", _) => "--raw 16x16:u16be".into(),
        ("scale", "--size 2x2") => "--size 2x2 --depth 0.2".into(),
        _ => arguments.into(),
    }
}

fn inputs() -> Folder {
    let folder = Folder::new();
    folder.grey8("tex/a_height.png", 32, 32, bumps8);
    folder.grey16("tex/b_height.png", 16, 32, bumps16);
    for x in 0..2usize {
        folder.grey8(&format!("tiles/t_{x}_0_height.png"), 16, 16, |column, row| bumps8(x * 16 + column, row));
    }
    let colours: Vec<u8> = (0..16 * 16 * 3u32).map(|index| (index.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    folder.file("colours/a_height.png", png(16, 16, png::ColorType::Rgb, png::BitDepth::Eight, &colours));
    let settings = "compression = 'small'\nroughness-method = 'toksvig'\nbase-roughness = 0.25\nroughness-bits = 16\n";
    folder.file("without_effect.toml", format!("[defaults]\n{settings}"));
    folder.file("raw/a_height.raw", &colours[..16 * 16 * 2]);
    folder
}

#[test]
fn each_bakes_again_what_it_is_for() {
    let folder = inputs();
    for (number, (option, input, arguments, change, reason)) in CASES.iter().enumerate() {
        let (out, clean) = (format!("out{number}"), format!("clean{number}"));
        let what = format!("{option}: {arguments} {change}");
        let first = before(option, arguments);
        let changed = format!("{arguments} {change}");
        let all = stale(&folder, input, &out, &first);
        assert!(!all.is_empty() && all.values().all(|reason| reason == "new"), "{what}: {all:?}");
        assert_eq!(stale(&folder, input, &out, &first), BTreeMap::new(), "{what}");
        let old = contents_of(&folder, &out);
        let found = stale(&folder, input, &out, &changed);
        let is_expected = |found: &String| match reason.strip_suffix('*') {
            Some(start) => found.starts_with(start),
            None => found == reason,
        };
        if reason.is_empty() {
            assert_eq!(found, BTreeMap::new(), "{what}");
        } else {
            assert!(found.keys().eq(all.keys()) && found.values().all(is_expected), "{what}: {found:?}");
        }
        assert_eq!(stale(&folder, input, &out, &changed), BTreeMap::new(), "{what}");
        // It was needed, or it was not.
        stale(&folder, input, &clean, &changed);
        let [now, clean] = [&out, &clean].map(|folder_name| contents_of(&folder, folder_name));
        assert!(now == clean, "{what}: other bytes than those of a clean bake");
        assert_eq!(now == old, reason.is_empty(), "{what}: whether the bytes are others");
    }
    // Nothing else is compared; devices and given normal maps have tests of their own, and so have tiles.
    let mut tried: BTreeSet<String> = CASES.iter().map(|(option, ..)| option.replace('_', "-")).collect();
    tried.extend(["device", "normals"].map(str::to_owned));
    for number in 0..CASES.len() {
        for line in lines_of(&folder, &format!("out{number}")) {
            let mut compared = line["options"].as_object().unwrap().keys();
            assert!(compared.all(|name| tried.contains(name) || name.starts_with("neighbour-")), "{line}");
        }
    }
}

/// The report has a field for each option.
#[test]
fn none_is_forgotten() {
    let folder = inputs();
    stale(&folder, "tex", "out", "");
    let report = folder.json("r.json");
    let options: BTreeSet<&str> =
        report["files"][0]["options"].as_object().unwrap().keys().map(String::as_str).collect();
    let tried: BTreeSet<&str> = CASES.iter().map(|(option, ..)| *option).collect();
    assert_eq!(options, tried);
}
