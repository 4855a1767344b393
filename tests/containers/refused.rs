//! What no GPU format holds, and files that have neither blocks nor levels.

use crate::io::support::Folder;
use texbake::io::{
    BlockCompression, WriteOptions, check_normals_with, check_parallax_with, create_normals_with, create_parallax_with,
};
use texbake::{Channels, Depth, Encoding, NormalFormat, ParallaxFormat, Size};

fn normal(encoding: Encoding, depth: Depth, channels: Channels) -> NormalFormat {
    NormalFormat { encoding, depth, channels, ..NormalFormat::default() }
}

#[test]
fn each_refusal_names_what_is_wrong_and_what_would_do() {
    use {BlockCompression::*, Channels::*, Depth::*, Encoding::*};
    let folder = Folder::new();
    let size = Size::new(4, 4).unwrap();
    for (name, format, blocks, message) in [
        (
            "n.ktx2",
            normal(Biased, Bits8, Xyz),
            None,
            "encoding is biased with 8 bits, for n.ktx2: it must be unorm or snorm in KTX2 and DDS: \
             a GPU has no biased formats; PNG and TIFF hold them",
        ),
        (
            "n.dds",
            normal(Biased, Bits16, Xy),
            None,
            "encoding is biased with 16 bits, for n.dds: it must be unorm or snorm in KTX2 and DDS: \
             a GPU has no biased formats; PNG and TIFF hold them",
        ),
        (
            "n.dds",
            normal(Biased, Bits8, Xy),
            Some(Bc5),
            "encoding is biased with 8 bits, for n.dds: it must be unorm or snorm with 8 bits in blocks",
        ),
        (
            "n.dds",
            normal(Float, Float32, Xy),
            Some(Bc5),
            "encoding is float with 32f bits, for n.dds: it must be unorm or snorm with 8 bits in blocks",
        ),
        ("n.dds", normal(Unorm, Bits16, Xyz), Some(Bc7), "bits is 16, for n.dds: it must be 8 in blocks"),
        (
            "n.ktx2",
            normal(Snorm, Bits8, Xyz),
            Some(Bc7),
            "encoding is snorm with 8 bits, for n.ktx2: it must be unorm in bc7 blocks, \
             which have no signed numbers; bc5 blocks have them",
        ),
        (
            "n.ktx2",
            normal(Unorm, Bits8, Xyz),
            Some(Bc4),
            "block-compression is bc4: it must be bc5 (x and y) or bc7 (x, y and z) for a normal map; \
             bc4 blocks hold one component",
        ),
        ("n.ktx2", normal(Unorm, Bits8, Xy), Some(Bc7), "block-compression is bc7: it must be bc5 for the channels xy"),
        ("n.ktx2", normal(Snorm, Bits8, Xy), Some(Bc4), "block-compression is bc4: it must be bc5 for the channels xy"),
        (
            "n.png",
            normal(Unorm, Bits8, Xyz),
            Some(Bc5),
            "block-compression is bc5, for n.png: it must be for .ktx2 and .dds: other files have no blocks",
        ),
    ] {
        let (path, options) = (folder.path(name), WriteOptions { blocks, ..WriteOptions::default() });
        assert_eq!(check_normals_with(&path, format, &options).unwrap_err().to_string(), message);
        let created = create_normals_with(&path, size, format, &options);
        assert_eq!(created.map(drop).unwrap_err().to_string(), message);
    }
    for (name, encoding, depth) in [("p.png", Biased, Bits8), ("p.tif", Snorm, Bits8), ("p.exr", Float, Float16)] {
        let (path, format) = (folder.path(name), ParallaxFormat { encoding, depth });
        for (options, parameter) in [
            (WriteOptions { blocks: Some(Bc4), ..WriteOptions::default() }, "block-compression is bc4"),
            (WriteOptions { mips: true, ..WriteOptions::default() }, "mips is on"),
        ] {
            let error = check_parallax_with(&path, format, &options).unwrap_err().to_string();
            assert!(error.starts_with(parameter) && error.contains(".ktx2 and .dds"), "{error}");
            assert!(create_parallax_with(&path, size, format, &options).is_err());
        }
        assert!(check_parallax_with(&path, format, &WriteOptions::default()).is_ok());
    }
    assert_eq!(folder.names(), [""; 0]);
}

#[test]
fn a_dds_above_4_gib_is_refused_and_a_ktx2_is_not() {
    let folder = Folder::new();
    let format = NormalFormat::default();
    for (width, height, mips) in
        [(32768, 32768, false), (1 << 30, 1, false), (1 << 27, 1, true), (28_000, 30_000, true)]
    {
        let options = WriteOptions { mips, ..WriteOptions::default() };
        let size = Size::new(width, height).unwrap();
        let error =
            create_normals_with(&folder.path("n.dds"), size, format, &options).map(drop).unwrap_err().to_string();
        assert!(error.contains("readers of DDS files count to 4 GiB; write .ktx2"), "{error}");
        drop(create_normals_with(&folder.path("n.ktx2"), size, format, &options).unwrap());
    }
    let options = WriteOptions { mips: true, ..WriteOptions::default() };
    drop(create_normals_with(&folder.path("n.dds"), Size::new(28_000, 28_000).unwrap(), format, &options).unwrap());
    assert_eq!(folder.names(), [""; 0]);
}
