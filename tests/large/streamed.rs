//! Byte equality of streamed and in-memory results.

use super::files::{KINDS, Kind};
use crate::support::{Random, every_edges, map_f32, map_u8, map_u16, scale};
use std::path::Path;
use texbake::io::{
    NormalReadOptions, ReadOptions, create_normals, create_parallax, default_format, default_parallax_format,
    open_heights,
};
use texbake::stream::Monitor;
use texbake::{
    BakeOptions, Baker, Encoding, Filter, HeightMap, HeightType, Heights, Maps, NormalFormat, NormalMap,
    ParallaxFormat, Result,
};

const OUTPUTS: [&str; 3] = ["png", "tif", "exr"];

/// Both maps in a format that `extension` holds and that is read back as it is.
fn options(extension: &str) -> BakeOptions {
    let path = format!("map.{extension}");
    let (encoding, depth) = default_format(Path::new(&path)).unwrap();
    let normal = NormalFormat { encoding, depth, ..NormalFormat::default() };
    let parallax = default_parallax_format(Path::new(&path)).unwrap();
    // Signed heights would be read with an offset.
    let encoding = if parallax.encoding == Encoding::Snorm { Encoding::Biased } else { parallax.encoding };
    let parallax = Some(ParallaxFormat { encoding, ..parallax });
    BakeOptions { scale: scale("7/2"), filter: Filter::Scharr, normal: Some(normal), parallax, ..Default::default() }
}

/// Streams `input` into two files, and compares what they hold with the maps of the same heights in memory.
fn assert_streams(
    folder: &Path,
    input: &Path,
    read: &ReadOptions,
    map: &HeightMap,
    extension: &str,
    options: &BakeOptions,
) {
    let names = ["normal", "parallax"].map(|name| folder.join(format!("{name}.{extension}")));
    let (normal, parallax) = (options.normal.unwrap(), options.parallax.unwrap());
    let create = |size| -> Result<_> {
        let normal = Some(create_normals(&names[0], size, normal)?.into());
        Ok(Maps { normal, parallax: Some(create_parallax(&names[1], size, parallax)?.into()), roughness: None })
    };
    let open = || Ok(open_heights(input, read)?.rows);
    let baker = Baker::cpu();
    baker.bake_rows(&open, &create, options, &Monitor::default()).unwrap();
    let expected = baker.bake(map, options).unwrap();

    let what = || format!("{} into {extension}, {}", input.display(), options.edges);
    let read = NormalReadOptions { encoding: Some(normal.encoding), ..Default::default() };
    let (found, _) = NormalMap::read_with(&names[0], &read).unwrap();
    assert!(found.codes() == expected.normal.unwrap().codes(), "normals: {}", what());
    let found = HeightMap::read(&names[1]).unwrap();
    let expected = expected.parallax.unwrap();
    let bytes: &[u8] = match found.heights() {
        Heights::U8(codes) => codes,
        Heights::U16(codes) => bytemuck::cast_slice(codes),
        Heights::F32(codes) => bytemuck::cast_slice(codes),
    };
    assert!(bytes == expected.codes().bytes(), "parallax: {}", what());
}

/// Odd sizes, so that the last strip, tile and block are short.
fn maps(width: usize, height: usize) -> [HeightMap; 3] {
    let mut random = Random::new(65);
    [
        map_u8(width, height, |_, _| random.bits() as u8),
        map_u16(width, height, |_, _| random.bits() as u16),
        map_f32(width, height, |_, _| random.below(1000) as f32 / 999.0),
    ]
}

#[test]
fn every_input_edge_and_output() {
    let folder = tempfile::tempdir().unwrap();
    for (map, kind) in maps(37, 45).iter().flat_map(|map| KINDS.map(|kind| (map, kind))) {
        if !kind.holds(map.height_type()) {
            continue;
        }
        let input = folder.path().join(format!("{kind:?}_{}.{}", map.height_type(), kind.extension()));
        kind.write(&input, map);
        for (edges, output) in every_edges().flat_map(|edges| OUTPUTS.map(|output| (edges, output))) {
            let options = BakeOptions { edges, ..options(output) };
            assert_streams(folder.path(), &input, &kind.read(map), map, output, &options);
        }
    }
}

/// Strips above 1 MiB take a way of their own: row by row.
#[test]
fn a_strip_that_is_not_decoded_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for height_type in [HeightType::U8, HeightType::U16, HeightType::F32] {
        let height = (1 << 20) / (1031 * height_type.bytes()) + 2;
        let maps = maps(1031, height);
        let map = maps.iter().find(|map| map.height_type() == height_type).unwrap();
        let input = folder.path().join(format!("{height_type}.tif"));
        Kind::TiffStrip.write(&input, map);
        for (edges, output) in every_edges().zip(OUTPUTS.into_iter().cycle()) {
            let options = BakeOptions { edges, ..options(output) };
            assert_streams(folder.path(), &input, &Kind::TiffStrip.read(map), map, output, &options);
        }
    }
}

/// A map of one row or one column is every edge case at once.
#[test]
fn one_row_and_one_column() {
    let folder = tempfile::tempdir().unwrap();
    for [width, height] in [[1, 1], [1, 53], [53, 1], [2, 2]] {
        for (map, kind) in maps(width, height).iter().flat_map(|map| KINDS.map(|kind| (map, kind))) {
            if !kind.holds(map.height_type()) {
                continue;
            }
            let input = folder.path().join(format!("{kind:?}_{}.{}", map.height_type(), kind.extension()));
            kind.write(&input, map);
            for (edges, output) in every_edges().zip(OUTPUTS.into_iter().cycle()) {
                let options = BakeOptions { edges, ..options(output) };
                assert_streams(folder.path(), &input, &kind.read(map), map, output, &options);
            }
        }
    }
}
