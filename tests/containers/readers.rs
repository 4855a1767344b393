//! Files as other tools read them: Pillow and texture2ddecoder the DDS ones, ktx-parse the KTX2 ones.
//!
//! `tests/run.sh` fetches them and names their folder in TEXBAKE_TEXTURE_READERS. Without it these tests print so and
//! pass; with TEXBAKE_REQUIRE_TEXTURE_READERS=1 they fail.

use super::made::{KINDS, Kind, Level, Made, bc7};
use super::parsed::by_specification;
use crate::io::support::Folder;
use crate::support::fetched;
use base64::prelude::{BASE64_STANDARD, Engine as _};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use texbake::Codes;

fn bytes(value: &Value) -> Vec<u8> {
    BASE64_STANDARD.decode(value.as_str().expect("text")).expect("base64")
}

/// The JSON list that a script prints, one entry for each file.
fn list(command: &mut Command, files: &[&Path]) -> Vec<Value> {
    let output = command.args(files).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let list: Vec<Value> = serde_json::from_slice(&output.stdout).expect("a list");
    assert_eq!(list.len(), files.len());
    list
}

fn script(name: &str) -> String {
    format!("{}/tests/containers/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn read_dds(readers: &Path, files: &[&Path]) -> Vec<Value> {
    list(Command::new(readers.join("venv/bin/python3")).arg(script("read_dds.py")), files)
}

fn read_ktx2(readers: &Path, files: &[&Path]) -> Vec<Value> {
    list(Command::new("node").arg(script("read_ktx2.mjs")).arg(readers.join("package")), files)
}

fn paths(all: &[Made]) -> Vec<&Path> {
    all.iter().map(|made| made.path.as_path()).collect()
}

/// The files of one container.
fn made(folder: &Folder, ktx2: bool) -> Vec<Made> {
    Made::all(folder).into_iter().filter(|made| made.is_ktx2() == ktx2).collect()
}

/// Whether ktx-parse finds in a file what was written into it.
fn ktx_parse_agrees(found: &Value, made: &Made) -> bool {
    let (kind, levels) = (&made.kind, &made.levels);
    let type_size = if kind.blocks.is_some() { 1 } else { kind.depth.bytes() };
    let [width, height] = [levels[0].width, levels[0].height];
    let header = serde_json::json!([kind.vulkan, type_size, width, height, 0, 0, 1, levels.len(), 0]);
    let model = match kind.vulkan {
        139 | 140 => 131,
        141 | 142 => 132,
        145 => 134,
        _ => 1,
    };
    let stored: Vec<Vec<u8>> = found["levels"].as_array().unwrap().iter().map(bytes).collect();
    let expected: Vec<Vec<u8>> = match kind.blocks {
        None => levels.iter().map(|level| kind.texel_bytes(level)).collect(),
        Some(_) => by_specification(&made.bytes(), made).unwrap_or_default(),
    };
    // Primaries 0: unspecified; transfer function 1: linear; flags 0: alpha is straight.
    let fields = ["model", "primaries", "transfer", "flags"].map(|name| found[name].as_u64().unwrap());
    let texts = ["orientation", "writer"].map(|name| found[name].as_str().unwrap().trim_end_matches('\0').to_owned());
    found["header"] == header
        && fields == [model, 0, 1, 0]
        && texts == ["rd".to_owned(), "texbake".to_owned()]
        && stored == expected
}

#[test]
fn ktx_parse_reads_what_was_written() {
    let Some(readers) = fetched("TEXTURE_READERS") else { return };
    let folder = Folder::new();
    let all = made(&folder, true);
    for (found, made) in read_ktx2(&readers, &paths(&all)).iter().zip(&all) {
        assert!(ktx_parse_agrees(found, made), "{}", made.path.display());
    }
    // The comparison is awake: sRGB in the header, in the descriptor, and a level, not the last in the file, that stands
    // elsewhere.
    let made = &Made::new(&folder, KINDS[2], (17, 9), true, "ktx2");
    let (dfd_at, level_1_at) = (80 + 24 * made.levels.len(), 80 + 24);
    for (at, value) in [(12, 43), (dfd_at + 4 + 8 + 2, 2), (level_1_at, made.bytes()[level_1_at] ^ 4)] {
        let mut changed = made.bytes();
        changed[at] = value;
        let path = folder.file("changed.ktx2", &changed);
        let found = &read_ktx2(&readers, &[&path])[0];
        assert!(!ktx_parse_agrees(found, made), "byte {at} may be {value}");
    }
}

/// By how much each decoded component of a level is off, greatest first: RGBA texels against the codes of the map.
fn greatest_error(kind: &Kind, level: &Level, rgba: &[u8]) -> u8 {
    let Codes::U8(codes) = &level.codes else { panic!("blocks are of 8 bits") };
    let kept = if kind.bytes == 8 {
        1
    } else if kind.vulkan == 145 {
        3
    } else {
        2
    };
    let texels = codes.chunks_exact(kind.channels).zip(rgba.chunks_exact(4));
    let errors = texels.flat_map(|(codes, rgba)| codes.iter().zip(rgba).take(kept).map(|(a, b)| a.abs_diff(*b)));
    errors.max().expect("a level has texels")
}

/// The greatest error of BC4 and BC5 blocks: half a step of the block's range over 7, and less than one for rounding.
fn allowed(kind: &Kind, level: &Level) -> u8 {
    let Codes::U8(codes) = &level.codes else { panic!("blocks are of 8 bits") };
    let mut widest = 0;
    for block_y in 0..level.height.div_ceil(4) {
        for block_x in 0..level.width.div_ceil(4) {
            for channel in 0..kind.channels.min(2) {
                let texels = (0..16).map(|at| (block_x * 4 + at % 4, block_y * 4 + at / 4));
                let inside = texels.filter(|(x, y)| *x < level.width && *y < level.height);
                let block: Vec<u8> =
                    inside.map(|(x, y)| codes[(y * level.width + x) * kind.channels + channel]).collect();
                widest = widest.max(block.iter().max().unwrap() - block.iter().min().unwrap());
            }
        }
    }
    (widest as f64 / 14.0 + 1.0).floor() as u8
}

#[test]
fn pillow_and_texture2ddecoder_read_what_was_written() {
    let Some(readers) = fetched("TEXTURE_READERS") else { return };
    let folder = Folder::new();
    let all = made(&folder, false);
    let (mut read_by_pillow, mut decoded) = (0, 0);
    for (found, made) in read_dds(&readers, &paths(&all)).iter().zip(&all) {
        let (name, kind, largest) = (made.path.display(), &made.kind, &made.levels[0]);
        let stored = by_specification(&made.bytes(), made).unwrap();
        let pillow = &found["pillow"];
        if pillow["refused"].is_null() {
            assert_eq!(pillow["size"], serde_json::json!([largest.width, largest.height]), "{name}");
            let texels = bytes(&pillow["texels"]);
            match (kind.dxgi, pillow["mode"].as_str().unwrap()) {
                (28, "RGBA") => assert!(texels == kind.texel_bytes(largest), "{name}"),
                (80, "L") => assert_close(&name, kind, largest, &spread(&texels, 1)),
                (83, "RGB") => assert_close(&name, kind, largest, &spread(&texels, 3)),
                (84, "RGB") => {
                    // Pillow gives signed codes + 128.
                    let signed: Vec<u8> = texels.iter().map(|code| code ^ 0x80).collect();
                    assert_close_signed(&name, kind, largest, &spread(&signed, 3));
                }
                (98, "RGBA") => assert_bc7(&name, largest, &stored[0], &texels),
                (dxgi, mode) => panic!("{name}: Pillow gives {mode} for {dxgi}"),
            }
            read_by_pillow += 1;
        }
        let Some(levels) = found["blocks"].as_array() else { continue };
        assert_eq!(levels.len(), made.levels.len(), "{name}");
        for ((rgba, level), blocks) in levels.iter().map(bytes).zip(&made.levels).zip(&stored) {
            match kind.vulkan {
                145 => assert_bc7(&name, level, blocks, &rgba),
                _ => assert_close(&name, kind, level, &rgba),
            }
        }
        decoded += 1;
    }
    println!("Pillow read {read_by_pillow} of {} files, texture2ddecoder {decoded}", all.len());
    assert!(read_by_pillow >= 7 * 7 * 2 && decoded >= 5 * 7 * 2);
}

/// Texels of one or three samples as RGBA.
fn spread(texels: &[u8], samples: usize) -> Vec<u8> {
    texels.chunks_exact(samples).flat_map(|texel| [texel, &[0; 4][samples..]].concat()).collect()
}

fn assert_close(name: &impl std::fmt::Display, kind: &Kind, level: &Level, rgba: &[u8]) {
    let (error, allowed) = (greatest_error(kind, level, rgba), allowed(kind, level));
    assert!(error <= allowed, "{name}, {} x {}: off by {error}, not {allowed}", level.width, level.height);
}

/// The same of signed codes, moved to where unsigned ones are.
fn assert_close_signed(name: &impl std::fmt::Display, kind: &Kind, level: &Level, rgba: &[u8]) {
    let Codes::U8(codes) = &level.codes else { panic!("blocks are of 8 bits") };
    let codes = Codes::U8(codes.iter().map(|code| code ^ 0x80).collect());
    let rgba: Vec<u8> = rgba.iter().map(|code| code ^ 0x80).collect();
    assert_close(name, kind, &Level { codes, ..level.clone() }, &rgba);
}

/// Fails unless a decoder gives the texels that BC7 defines, with an alpha of one or a step below it.
fn assert_bc7(name: &impl std::fmt::Display, level: &Level, blocks: &[u8], rgba: &[u8]) {
    assert!(rgba == bc7(blocks, level), "{name}, {} x {}", level.width, level.height);
    assert!(rgba.iter().skip(3).step_by(4).all(|alpha| *alpha >= 254), "{name}: alpha");
}
