//! Every byte that a bake writes belongs to the version of the kernels: who changes one, raises it.

use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;
use texbake::batch::{Job, KERNEL_VERSION, run};
use texbake::io::{RawLayout, ReadOptions, WriteOptions};
use texbake::stream::Monitor;
use texbake::{
    BakeOptions, Baker, Channels, Convention, Depth, Edges, Encoding, Filter, Maps, NormalFormat, ParallaxFormat, Scale,
};

/// The version that the table below is of.
const VERSION: u32 = 1;

/// The BLAKE3 hash of each output, as a whole file.
const TABLE: &[(&str, &str)] = &[];

const WIDTH: usize = 37;
const HEIGHT: usize = 23;

/// Bumps of 16 bits: each bit of a height is used.
fn height(index: usize) -> u16 {
    let (x, y) = (index % WIDTH, index / WIDTH);
    (x * x * 211 + y * 7919 + x * y * 13) as u16
}

/// A height map without a header, and its layout.
fn input(folder: &Path, kind: &str) -> (std::path::PathBuf, RawLayout) {
    let heights = (0..WIDTH * HEIGHT).map(height);
    let bytes: Vec<u8> = match kind {
        "u8" => heights.map(|height| (height >> 8) as u8).collect(),
        "u16le" => heights.flat_map(u16::to_le_bytes).collect(),
        _ => heights.flat_map(|height| (f32::from(height) / 65536.0).to_le_bytes()).collect(),
    };
    let path = folder.join(format!("{kind}.raw"));
    std::fs::write(&path, bytes).unwrap();
    (path, format!("{WIDTH}x{HEIGHT}:{kind}").parse().unwrap())
}

/// Slopes and the formats of the maps, with the extension of the files: each at least once.
fn cases() -> Vec<(&'static str, BakeOptions)> {
    let normal = |encoding, depth, channels, convention| NormalFormat { encoding, depth, channels, convention };
    let parallax = |encoding, depth| ParallaxFormat { encoding, depth };
    let options = |scale: &str, filter: Filter, edges: &str, normal, parallax| BakeOptions {
        scale: Scale::texels(scale.parse::<texbake::Rational>().unwrap()),
        filter,
        edges: edges.parse::<Edges>().unwrap(),
        normal: Some(normal),
        parallax: Some(parallax),
        ..BakeOptions::default()
    };
    use Channels::{Xy, Xyz};
    use Convention::{Dx, Gl};
    use Depth::{Bits8, Bits16, Float16, Float32};
    use Encoding::{Biased, Float, Snorm, Unorm};
    vec![
        ("png", options("24", Filter::Central, "wrap", normal(Unorm, Bits8, Xyz, Gl), parallax(Biased, Bits8))),
        ("png", options("7/3", Filter::Sobel, "clamp", normal(Biased, Bits16, Xy, Dx), parallax(Unorm, Bits16))),
        ("tif", options("-0.35", Filter::Scharr, "mirror", normal(Snorm, Bits8, Xyz, Gl), parallax(Snorm, Bits8))),
        ("tif", options("100", Filter::Prewitt, "wrap,clamp", normal(Unorm, Bits16, Xy, Gl), parallax(Snorm, Bits16))),
        ("tif", options("3", Filter::Central, "wrap", normal(Float, Float32, Xyz, Dx), parallax(Float, Float32))),
        ("exr", options("24", Filter::Sobel, "wrap", normal(Float, Float32, Xyz, Gl), parallax(Float, Float32))),
        ("exr", options("24", Filter::Central, "clamp", normal(Float, Float16, Xy, Gl), parallax(Float, Float16))),
    ]
}

#[test]
fn a_changed_byte_is_a_new_version() {
    let folder = TempDir::new().unwrap();
    let mut jobs = Vec::new();
    let baker = Arc::new(Baker::cpu());
    for kind in ["u8", "u16le", "f32le"] {
        let (input, raw) = input(folder.path(), kind);
        for (number, (extension, options)) in cases().into_iter().enumerate() {
            let output = |map: &str| Some(folder.path().join(format!("{kind}_{number}_{map}.{extension}")));
            jobs.push(Job {
                input: input.clone(),
                outputs: Maps { normal: output("normal"), parallax: output("parallax") },
                normals: None,
                read: ReadOptions { raw: Some(raw), ..ReadOptions::default() },
                options,
                write: WriteOptions::default(),
                baker: baker.clone(),
            });
        }
    }
    for outcome in run(&jobs, 2, &Monitor::default(), &|_| ()) {
        outcome.result.unwrap();
    }
    let outputs = jobs.iter().flat_map(|job| job.outputs.iter());
    let found: Vec<(String, String)> = outputs
        .map(|path| {
            let hash = blake3::hash(&std::fs::read(path).unwrap()).to_hex();
            (path.file_name().unwrap().to_str().unwrap().to_owned(), hash[..32].to_owned())
        })
        .collect();
    let is_same = found.iter().map(|(name, hash)| (name.as_str(), hash.as_str())).eq(TABLE.iter().copied());
    if !is_same || KERNEL_VERSION != VERSION {
        let lines = found.iter().map(|(name, hash)| format!("    (\"{name}\", \"{hash}\"),\n")).collect::<String>();
        panic!(
            "bakes write other bytes than those of version {VERSION}: maps that users have would count as fresh. Raise \
             KERNEL_VERSION in src/batch/fresh/kernel_version.rs, now {KERNEL_VERSION}, by one if this version was \
             released, set VERSION here to it, and put this table here:\n{lines}"
        );
    }
}
