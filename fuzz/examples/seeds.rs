//! Writes the seeds of every target to `corpus/`: the samples that texbake's tests damage.
//!
//! `cargo run --release --example seeds`, in this folder.

#![allow(dead_code, unused_imports, reason = "the tests' own modules, of which only the samples are used")]

// The tests' samples, where the tests have them.
#[path = "../../tests/io"]
mod io {
    pub mod hand_made_png;
    pub mod hand_made_tiff;
    pub mod samples;
    pub mod support;

    pub mod gltf {
        pub mod builder;
        pub mod samples;

        pub use builder::Builder;
    }
}

use io::gltf::samples::{MTL, OBJ, sample};
use io::samples::{height_maps, normal_maps};
use io::support::Folder;
use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Folder::new();
    let maps = [height_maps(&folder), normal_maps(&folder)].concat();
    for (extension, format) in [
        ("png", "png"),
        ("tif", "tiff"),
        ("exr", "exr"),
        ("tga", "tga"),
        ("bmp", "bmp"),
        ("jpg", "jpeg"),
        ("webp", "webp"),
    ] {
        let is_of = |path: &&std::path::PathBuf| path.extension().is_some_and(|found| found == extension);
        for (number, path) in maps.iter().filter(is_of).enumerate() {
            let bytes = std::fs::read(path)?;
            // The first byte chooses options: by default, and red.
            for choice in [0, 1] {
                let data = [&[choice], &bytes[..]].concat();
                let name = format!("{number}_{choice}");
                seed(&format!("heights_{format}"), &name, &data)?;
                if ["png", "tiff", "exr"].contains(&format) {
                    seed(&format!("normals_{format}"), &name, &data)?;
                }
                seed("masks", &format!("{format}_{name}"), &data)?;
            }
        }
    }
    for kind in 0..5 {
        let data = [&[4, 6, kind, 0][..], &vec![63; 5 * 7 * 4]].concat();
        seed("raw", &kind.to_string(), &data)?;
    }

    let model = sample();
    for choice in 0..6 {
        let with = |bytes: Vec<u8>| [vec![choice], bytes].concat();
        seed("gltf", &format!("data_{choice}"), &with(model.gltf_with_data()))?;
        seed("gltf", &format!("file_{choice}"), &with(model.gltf("m.bin")))?;
        seed("glb", &choice.to_string(), &with(model.glb()))?;
        seed("obj", &choice.to_string(), &with([OBJ.as_bytes(), b"\0", MTL.as_bytes()].concat()))?;
    }
    let floats: Vec<u8> = (0..9).flat_map(|i| (i as f32 / 4.0).to_le_bytes()).collect();
    seed("data_uri", "triangle", &floats)?;
    seed("data_uri", "text", b"m%20.bin")?;

    let texts = "24 -0.35 7/3 1.5e-3 1025x1025:u16le wrap,clamp {stem}_{map}{size} maps/{stem} scharr unorm 16f xy dx mikktspace \
                 smooth luma n.X";
    for (number, text) in texts.split_whitespace().enumerate() {
        seed("text", &number.to_string(), text.as_bytes())?;
    }
    let settings = "suffix = ['_dem']\n[defaults]\nscale = 24\nfilter = 'sobel'\nmaps = ['normal', 'parallax']\n\
                    [[override]]\nglob = '**/dem_*'\nscale = 0.35\nbits = 16\nedge = 'wrap,clamp'\n\
                    [[override]]\nglob = '*_x.{png,tif}'\nscale = '7/3'\nsize = '2.0x1.5'\n";
    seed("settings", "both", settings.as_bytes())?;
    seed(
        "settings",
        "example",
        &std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/textures/texbake.toml"))?,
    )?;
    seed("streams", "small", &[5; 64])
}

fn seed(target: &str, name: &str, data: &[u8]) -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join(format!("seed_{name}")), data)
}
