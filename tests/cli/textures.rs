//! KTX2 and DDS by the command line and `texbake.toml`.

use super::support::{Folder, bumps8};

/// DXGI_FORMAT of a DDS file.
fn dxgi(folder: &Folder, name: &str) -> u32 {
    let bytes = std::fs::read(folder.path(name)).unwrap();
    assert_eq!(&bytes[..4], b"DDS ", "{name}");
    u32::from_le_bytes(bytes[128..132].try_into().unwrap())
}

/// VkFormat of a KTX2 file.
fn vulkan(folder: &Folder, name: &str) -> u32 {
    let bytes = std::fs::read(folder.path(name)).unwrap();
    assert_eq!(&bytes[1..7], b"KTX 20", "{name}");
    u32::from_le_bytes(bytes[12..16].try_into().unwrap())
}

#[test]
fn a_folder_becomes_blocks() {
    let folder = Folder::new();
    folder.grey8("tex/wall_height.png", 13, 9, bumps8);
    folder.file(
        "tex/texbake.toml",
        "[defaults]\nformat = 'dds'\nmaps = ['normal', 'parallax']\nblock-compression = 'bc5'",
    );
    folder.run(&["bake", "tex", "--out", "out", "--backend", "cpu"]).ends(0);
    assert_eq!([dxgi(&folder, "out/wall_normal.dds"), dxgi(&folder, "out/wall_parallax.dds")], [83, 81]);
    // The command line is stronger, and a format without blocks leaves them.
    folder.run(&["bake", "tex", "--out", "out", "--backend", "cpu", "--block-compression", "bc7"]).ends(0);
    assert_eq!([dxgi(&folder, "out/wall_normal.dds"), dxgi(&folder, "out/wall_parallax.dds")], [98, 81]);
    folder.run(&["bake", "tex", "--out", "out", "--backend", "cpu", "--format", "png"]).ends(0);
    assert_eq!(folder.files("out").len(), 4);
}

#[test]
fn one_file_is_what_was_asked_for() {
    let folder = Folder::new();
    folder.grey8("h.png", 13, 9, bumps8);
    let normal = |more: &[&str]| {
        folder.run(&[&["normal", "h.png", "-o", "n.ktx2", "--backend", "cpu"], more].concat()).ends(0);
        vulkan(&folder, "n.ktx2")
    };
    assert_eq!(normal(&[]), 37);
    assert_eq!(normal(&["--encoding", "snorm", "--channels", "xy"]), 17);
    assert_eq!(normal(&["--bits", "16f"]), 97);
    assert_eq!(normal(&["--block-compression", "bc5", "--encoding", "snorm"]), 142);
    for (arguments, told) in [
        (["--block-compression", "bc7"], "unorm 8 xyz gl in bc7 blocks, 4 levels, scale 1 "),
        (["--block-compression", "bc5"], "unorm 8 xyz gl in bc5 blocks, x and y alone, 4 levels, scale 1 "),
    ] {
        let run = folder.run(&[&["normal", "h.png", "-o", "n.dds", "--mips"], &arguments[..]].concat()).ends(0);
        run.says("n.dds", &[told]);
    }
    let parallax = ["parallax", "h.png", "-o", "p.dds", "--block-compression", "bc5"];
    folder.run(&parallax).ends(0).says("p.dds", &["parallax snorm 8 in bc4 blocks, scale 1 "]);
    for (name, format) in [("n.dds", "DDS"), ("n.ktx2", "KTX2")] {
        folder
            .run(&["check", name])
            .ends(1)
            .says(name, &[&format!("{format} is written, and not read; texbake reads")]);
    }
    folder.run(&["parallax", "h.png", "-o", "p.ktx2", "--backend", "cpu"]).ends(0);
    assert_eq!(vulkan(&folder, "p.ktx2"), 10);
    folder.run(&["blend", "h.png", "h.png", "-o", "b.ktx2"]).ends(1).says("h.png", &["height map"]);
}

#[test]
fn what_does_not_fit_is_told_before_anything_is_baked() {
    let folder = Folder::new();
    folder.grey8("h.png", 13, 9, bumps8);
    for (arguments, message) in [
        (
            ["n.png", "--block-compression", "bc5"],
            "--block-compression is bc5, for n.png: it must be for .ktx2 and .dds",
        ),
        (["n.dds", "--compression", "small"], "--compression is small: it must be left out where no output is a PNG"),
        (["n.dds", "--block-compression", "bc4"], "--block-compression is bc4: it must be bc5 (x and y) or bc7"),
        (["n.dds", "--block-compression", "bc6"], "invalid value 'bc6' for '--block-compression"),
        (["n.ktx2", "--encoding", "biased"], "--encoding is biased with 8 bits, for n.ktx2: it must be unorm or snorm"),
    ] {
        let run = folder.run(&[&["normal", "h.png", "-o"], &arguments[..]].concat()).ends(2);
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
    let arguments = ["parallax", "h.png", "-o", "p.dds", "--bits", "16", "--block-compression", "bc4"];
    folder.run(&arguments).ends(2).says("--bits is 16", &["it must be 8 in blocks"]);
    let roughness = ["normal", "h.png", "-o", "n.dds", "--mips", "--roughness", "r.dds", "--roughness-bits", "16"];
    let run = folder.run(&[&roughness[..], &["--block-compression", "bc5"]].concat()).ends(2);
    run.says("--roughness-bits is 16, for r.dds", &["it must be 8 in blocks"]);
    assert_eq!(folder.files("."), ["h.png"]);
}
