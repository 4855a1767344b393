//! Maps reduced while they are read, against means in whole numbers.

use super::support::{Folder, Noise, Values, read_all_ways, read_error};
use crate::support::{EDGES, every_baker};
use num_bigint::BigInt;
use num_integer::Integer;
use std::path::Path;
use texbake::io::ReadOptions;
use texbake::stream::Monitor;
use texbake::{BakeOptions, CodesRef, Edges, Grid, HeightMap, Maps, NormalFormat, Scale};

fn shrunk(by: u32, raw: Option<&str>) -> ReadOptions {
    ReadOptions {
        shrink: by.try_into().unwrap(),
        raw: raw.map(|layout| layout.parse().unwrap()),
        ..ReadOptions::default()
    }
}

/// The nearest 16-bit code to the mean height of each square, ties up: with M = 2^B - 1 the height is sum / (n^2 M).
fn means(codes: &[u32], width: usize, by: usize, greatest: u32) -> Vec<u16> {
    let (columns, rows) = (width / by, codes.len() / width / by);
    let mean = |i: usize| {
        let (x, y) = (i % columns * by, i / columns * by);
        let square = (y..y + by).flat_map(|y| (x..x + by).map(move |x| codes[y * width + x]));
        let above = BigInt::from(2 * 65_535) * square.map(BigInt::from).sum::<BigInt>();
        let below = BigInt::from(by * by) * BigInt::from(greatest);
        u16::try_from((above + &below).div_floor(&(2 * below))).unwrap()
    };
    (0..columns * rows).map(mean).collect()
}

/// A file of 16-bit codes without a header.
fn words(folder: &Folder, name: &str, codes: &[u32]) -> std::path::PathBuf {
    folder.file(name, &codes.iter().flat_map(|code| (*code as u16).to_le_bytes()).collect::<Vec<u8>>())
}

#[test]
fn codes_become_the_nearest_16_bit_code_to_their_mean() {
    let folder = Folder::new();
    let mut noise = Noise(1);
    for (by, width, height) in [(1, 6, 4), (2, 6, 4), (3, 9, 12), (4, 4, 8), (7, 14, 7), (64, 128, 128)] {
        let bytes: Vec<u32> = (0..width * height).map(|_| noise.next() % 256).collect();
        let path = folder.file("a.raw", &bytes.iter().map(|byte| *byte as u8).collect::<Vec<u8>>());
        let read = read_all_ways(&path, &shrunk(by, Some(&format!("{width}x{height}:u8")))).unwrap();
        let expected = match by {
            1 => Values::U8(bytes.iter().map(|byte| *byte as u8).collect()),
            _ => Values::U16(means(&bytes, width, by as usize, 255)),
        };
        assert_eq!(read, expected, "u8 by {by}");

        let codes: Vec<u32> = (0..width * height).map(|_| noise.next() % 65_536).collect();
        let read =
            read_all_ways(&words(&folder, "b.raw", &codes), &shrunk(by, Some(&format!("{width}x{height}:u16le"))));
        assert_eq!(read.unwrap(), Values::U16(means(&codes, width, by as usize, 65_535)), "u16 by {by}");
    }
}

#[test]
fn the_ends_of_the_codes_and_ties() {
    let folder = Folder::new();
    let read = |codes: &[u32]| {
        let path = words(&folder, "t.raw", codes);
        read_all_ways(&path, &shrunk(2, Some("2x2:u16le"))).unwrap()
    };
    assert_eq!(read(&[0, 0, 0, 1]), Values::U16(vec![0]));
    assert_eq!(read(&[0, 1, 1, 0]), Values::U16(vec![1])); // 1/2
    assert_eq!(read(&[65_535, 65_535, 65_534, 65_534]), Values::U16(vec![65_535])); // 65534 1/2
    assert_eq!(read(&[65_535; 4]), Values::U16(vec![65_535]));
    // 64 x 64 white codes are the greatest sum that there is.
    for (bytes, layout) in [(vec![255; 4096], "64x64:u8"), (vec![255; 8192], "64x64:u16le")] {
        let path = folder.file("white.raw", &bytes);
        assert_eq!(read_all_ways(&path, &shrunk(64, Some(layout))).unwrap(), Values::U16(vec![65_535]), "{layout}");
    }
}

#[test]
fn floats_are_summed_in_f64_and_rounded_once() {
    let folder = Folder::new();
    let read = |heights: &[f32]| {
        let bytes: Vec<u8> = heights.iter().flat_map(|height| height.to_le_bytes()).collect();
        read_all_ways(&folder.file("f.raw", &bytes), &shrunk(2, Some("4x2:f32le"))).unwrap()
    };
    // In f32 the ones would be lost beside 2^24, and the sum of the greatest floats would be infinite.
    let wide = 16_777_216.0;
    assert_eq!(
        read(&[wide, 1.0, f32::MAX, f32::MAX, 1.0, 2.0, f32::MAX, f32::MAX]),
        Values::F32(vec![4_194_305.0, f32::MAX])
    );
    assert_eq!(
        read(&[0.5, -0.25, 1e-45, 0.0, 3.0, 0.0, 0.0, 1e-45]),
        Values::F32(vec![0.8125, 0.0]) // half of the least float is a tie, which goes to the even 0
    );
}

#[test]
fn every_file_format_is_reduced() {
    let folder = Folder::new();
    let mut noise = Noise(5);
    let codes: Vec<u32> = (0..12 * 6).map(|_| noise.next() % 65_536).collect();
    let expected = Values::U16(means(&codes, 12, 3, 65_535));
    let bytes: Vec<u8> = codes.iter().flat_map(|code| (*code as u16).to_be_bytes()).collect();
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 12, 6);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    assert_eq!(read_all_ways(&folder.file("h.png", &png), &shrunk(3, None)).unwrap(), expected);

    let path = folder.path("h.tif");
    let mut encoder = tiff::encoder::TiffEncoder::new(std::fs::File::create(&path).unwrap()).unwrap();
    let samples: Vec<u16> = codes.iter().map(|code| *code as u16).collect();
    encoder.write_image::<tiff::encoder::colortype::Gray16>(12, 6, &samples).unwrap();
    assert_eq!(read_all_ways(&path, &shrunk(3, None)).unwrap(), expected);
}

#[test]
fn a_factor_that_does_not_fit_is_refused() {
    let folder = Folder::new();
    let path = folder.file("t.raw", &[0; 24]);
    let error = |by| HeightMap::read_with(&path, &shrunk(by, Some("6x4:u8"))).unwrap_err().to_string();
    for by in [3, 4, 5, 12] {
        let range = "it must be a divisor of both sides of the map, which has 6 x 4 texels";
        assert_eq!(error(by), format!("shrink is {by}: {range}"));
    }
    assert_eq!(error(65), "shrink is 65: it must be from 1 to 64");
    // What is wrong in the file is said of the file's own texels.
    let mut heights = [0.0f32; 24];
    heights[21] = f32::NAN;
    let path = folder.file("n.raw", &heights.iter().flat_map(|height| height.to_le_bytes()).collect::<Vec<u8>>());
    let message = read_error(&path, &shrunk(2, Some("6x4:f32le")));
    assert!(message.starts_with("the height at column 3, row 3 is NaN"), "{message}");
}

/// The codes of a normal map baked from a file, as they come out of the stream.
fn baked_from(baker: &texbake::Baker, path: &Path, read: &ReadOptions, options: &BakeOptions) -> Vec<u8> {
    let folder = Folder::new();
    let output = folder.path("n.png");
    let open = || Ok(texbake::io::open_heights(path, read)?.rows);
    let create = |size| {
        let sink = texbake::io::create_normals(&output, size, options.normal.unwrap())?;
        Ok(Maps { normal: Some(sink.into()), parallax: None, roughness: None })
    };
    baker.bake_rows(&open, &create, options, &Monitor::default()).unwrap();
    let map = texbake::NormalMap::read(&output).unwrap();
    let CodesRef::U8(codes) = map.codes() else { panic!("8 bits") };
    codes.to_vec()
}

#[test]
fn a_reduced_file_bakes_as_the_map_reduced_by_hand_on_every_backend() {
    let folder = Folder::new();
    let (width, height, by) = (36, 24, 4);
    let mut noise = Noise(9);
    let codes: Vec<u32> = (0..width * height).map(|_| noise.next() % 65_536).collect();
    let path = words(&folder, "t.raw", &codes);
    let by_hand = Grid::new(width / by, height / by, means(&codes, width, by, 65_535)).unwrap().into();
    let read = shrunk(by as u32, Some("36x24:u16le"));
    for edge in EDGES {
        let normal = Some(NormalFormat::default());
        let options = BakeOptions { scale: Scale::texels(3), edges: Edges::both(edge), normal, ..Default::default() };
        let expected = texbake::Baker::reference().bake(&by_hand, &options).unwrap().normal.unwrap();
        let CodesRef::U8(expected) = expected.codes() else { panic!("8 bits") };
        for subject in every_baker() {
            assert!(baked_from(&subject.baker, &path, &read, &options) == expected, "{}, {edge}", subject.name);
        }
    }
}
