//! Height maps, normal maps and masks from files of any bytes.

use crate::explained::assert_explained;
use crate::memory::bounded;
use crate::{choice, file, path};
use std::path::Path;
use texbake::inspect::{CheckOptions, check};
use texbake::io::{ColorSpace, HeightFile, NormalFile, NormalReadOptions, RawKind, RawLayout, ReadOptions};
use texbake::io::{open_heights, open_normals};
use texbake::stream::{Monitor, RowSource};
use texbake::{
    Baker, BlendInputs, BlendMethod, BlendOptions, Channels, Codes, Convention, Depth, Encoding, Error, Grid,
    HeightMap, HeightType, Heights, HeightsMut, NormalFormat, NormalMap, NormalOptions, Size,
};

/// The most bytes that a decoder may hold, and the most of a map.
const MAX_BYTES: u64 = 4 << 20;

/// What reading a map may take: the decoder, the map, and what stands beside the rows of a PNG.
const HELD_BYTES: usize = 2 * MAX_BYTES as usize + (64 << 20) + (4 << 20);

/// Maps up to here are baked, written and read again.
const SMALL: usize = 64 * 64;

const CHANNELS: [Option<&str>; 8] =
    [None, Some("r"), Some("g"), Some("b"), Some("a"), Some("luma"), Some("Y"), Some("n.X")];

/// Reads a height map with any options: the first byte chooses them.
pub fn assert_heights(extension: &str, data: &[u8]) {
    let Some((choice, bytes)) = choice(data) else { return };
    let options = ReadOptions {
        channel: CHANNELS[choice % 8].map(|name| name.parse().expect("any name")),
        color_space: if choice / 8 % 4 == 3 { ColorSpace::Srgb } else { ColorSpace::Linear },
        max_bytes: MAX_BYTES,
        ..ReadOptions::default()
    };
    let path = file(&format!("h.{extension}"), bytes);
    if let Some(map) = heights(&path, &options, choice / 32) {
        if extension == "png" {
            let side = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("a header")) as usize;
            assert_eq!((map.size().width(), map.size().height()), (side(16), side(20)), "the header's size");
        }
        assert_bakes(&map);
    }
}

/// Reads headerless heights: the first bytes choose the layout, and whether the file's length is what it says.
pub fn assert_raw(data: &[u8]) {
    let [width, height, kind, wrong, bytes @ ..] = data else { return };
    let kinds = [RawKind::U8, RawKind::U16Le, RawKind::U16Be, RawKind::F32Le, RawKind::F32Be];
    let kind = kinds[usize::from(*kind) % 5];
    let code = [1, 2, 2, 4, 4][kinds.iter().position(|one| *one == kind).unwrap_or(0)];
    let (width, height) = (usize::from(*width) + 1, usize::from(*height) + 1);
    let size = Size::new(width, height).expect("a small size");
    let mut bytes = bytes.to_vec();
    if wrong % 4 != 0 {
        bytes.resize(width * height * code, *wrong);
    }
    let path = file("h.raw", &bytes);
    let raw = Some(RawLayout { size, kind });
    let options = ReadOptions { raw, max_bytes: MAX_BYTES, ..ReadOptions::default() };
    let read = heights(&path, &options, usize::from(*wrong));
    assert!(read.is_none() || bytes.len() == width * height * code, "a file of another length is another map");
    if let Some(map) = read {
        assert_eq!(map.size(), size);
        assert_eq!(raw_bytes(&map, kind), bytes, "heights are the bytes of the file");
        assert_bakes(&map);
    }
}

fn raw_bytes(map: &HeightMap, kind: RawKind) -> Vec<u8> {
    match (map.heights(), kind) {
        (Heights::U8(heights), _) => heights.to_vec(),
        (Heights::U16(heights), RawKind::U16Le) => heights.iter().flat_map(|h| h.to_le_bytes()).collect(),
        (Heights::U16(heights), _) => heights.iter().flat_map(|h| h.to_be_bytes()).collect(),
        (Heights::F32(heights), RawKind::F32Le) => heights.iter().flat_map(|h| h.to_le_bytes()).collect(),
        (Heights::F32(heights), _) => heights.iter().flat_map(|h| h.to_be_bytes()).collect(),
    }
}

/// A map that is read whole and in pieces, if it is one.
fn heights(path: &Path, options: &ReadOptions, seed: usize) -> Option<HeightMap> {
    let whole = bounded(HELD_BYTES, || HeightMap::read_with(path, options));
    match whole {
        Ok((map, _)) => {
            let pieces = bounded(2 * HELD_BYTES, || heights_in_pieces(path, options, seed)).expect("it was read whole");
            assert!(bits(pieces.heights()) == bits(map.heights()), "whole and in pieces it is the same map");
            Some(map)
        }
        Err(error) => {
            assert_explained(path, &error);
            // Where only the whole map is too large, its rows may be read.
            if !matches!(error, Error::TooLarge { .. }) {
                let again = bounded(2 * HELD_BYTES, || heights_in_pieces(path, options, seed));
                assert_explained(path, &again.expect_err("whole it was refused"));
            }
            None
        }
    }
}

/// The last row, wherever the rows stand.
fn read_last_row(rows: &mut dyn RowSource, row: HeightsMut<'_>) -> Result<(), Error> {
    rows.rewind()?;
    rows.skip(rows.size().height() - 1)?;
    rows.read(row)?;
    rows.rewind()
}

/// The last row, then the map in pieces of changing size, then the last row again.
fn heights_in_pieces(path: &Path, options: &ReadOptions, seed: usize) -> Result<HeightMap, Error> {
    let HeightFile { mut rows, .. } = open_heights(path, options)?;
    let size = rows.size();
    let (width, height) = (size.width(), size.height());
    let mut all = Codes::zeroed(depth(rows.height_type()), size.texels());
    all.as_mut().bytes_mut().fill(0xa5);
    let mut last = [Codes::zeroed(depth(rows.height_type()), width), Codes::zeroed(depth(rows.height_type()), width)];
    if seed % 2 == 0 {
        read_last_row(rows.as_mut(), room(&mut last[0], 0..width))?;
    }
    let (mut row, mut step) = (0, seed);
    while row < height {
        let end = (row + 1 + step % 5).min(height);
        rows.read(room(&mut all, row * width..end * width))?;
        (row, step) = (end, step.wrapping_mul(31) + 7);
    }
    read_last_row(rows.as_mut(), room(&mut last[1], 0..width))?;
    for last in last.iter().skip(seed % 2) {
        assert!(last.as_ref().bytes() == all.as_ref().slice((height - 1) * width..height * width).bytes(), "last row");
    }
    match all {
        Codes::U8(heights) => Ok(Grid::new(width, height, heights)?.into()),
        Codes::U16(heights) => Ok(Grid::new(width, height, heights)?.into()),
        Codes::F32(heights) => Grid::new(width, height, heights)?.try_into(),
        Codes::F16(_) => unreachable!("heights are no half floats"),
    }
}

fn depth(height_type: HeightType) -> Depth {
    match height_type {
        HeightType::U8 => Depth::Bits8,
        HeightType::U16 => Depth::Bits16,
        HeightType::F32 => Depth::Float32,
    }
}

fn room(codes: &mut Codes, range: std::ops::Range<usize>) -> HeightsMut<'_> {
    match codes {
        Codes::U8(codes) => HeightsMut::U8(&mut codes[range]),
        Codes::U16(codes) => HeightsMut::U16(&mut codes[range]),
        Codes::F32(codes) => HeightsMut::F32(&mut codes[range]),
        Codes::F16(_) => unreachable!("heights are no half floats"),
    }
}

/// Of floats their bits, for minus zero is another height.
fn bits(heights: Heights<'_>) -> Vec<u32> {
    match heights {
        Heights::U8(heights) => heights.iter().map(|height| (*height).into()).collect(),
        Heights::U16(heights) => heights.iter().map(|height| (*height).into()).collect(),
        Heights::F32(heights) => heights.iter().map(|height| height.to_bits()).collect(),
    }
}

/// Small maps are baked, and the normal map is written and read.
fn assert_bakes(map: &HeightMap) {
    if map.size().texels() > SMALL {
        return;
    }
    let (encoding, depth, name) = match map.height_type() {
        HeightType::U8 => (Encoding::Unorm, Depth::Bits8, "n.png"),
        HeightType::U16 => (Encoding::Snorm, Depth::Bits16, "n.tif"),
        HeightType::F32 => (Encoding::Float, Depth::Float32, "n.exr"),
    };
    let format = NormalFormat { encoding, depth, ..NormalFormat::default() };
    let options = NormalOptions { format, ..NormalOptions::default() };
    let normals = Baker::reference().normal(map, &options).expect("finite heights have normals");
    assert_written(&normals, name);
}

/// What is written is read as the same format and bytes.
fn assert_written(normals: &NormalMap, name: &str) {
    let path = path(name);
    normals.write(&path).expect("it is written");
    let NormalFormat { encoding, channels, convention, .. } = normals.format();
    let options = NormalReadOptions {
        encoding: Some(encoding),
        channels: Some(channels),
        convention,
        ..NormalReadOptions::default()
    };
    let (again, warnings) = NormalMap::read_with(&path, &options).expect("what was written is read");
    assert_eq!((again.size(), again.format()), (normals.size(), normals.format()), "{name}");
    assert!(again.codes().bytes() == normals.codes().bytes(), "{name} holds other codes than were written");
    assert!(warnings.is_empty(), "{name}: {warnings:?}");
}

/// Reads a normal map with any options: the first byte chooses them.
pub fn assert_normals(extension: &str, data: &[u8]) {
    let Some((choice, bytes)) = choice(data) else { return };
    let encodings = [Encoding::Unorm, Encoding::Snorm, Encoding::Biased, Encoding::Float];
    let options = NormalReadOptions {
        encoding: encodings.get(choice % 5).copied(),
        channels: [Channels::Xyz, Channels::Xy].get(choice / 5 % 3).copied(),
        convention: if choice / 15 % 2 == 0 { Convention::Gl } else { Convention::Dx },
        max_bytes: MAX_BYTES,
    };
    let path = file(&format!("n.{extension}"), bytes);
    match bounded(HELD_BYTES, || NormalMap::read_with(&path, &options)) {
        Err(error) => {
            assert_explained(&path, &error);
            if !matches!(error, Error::TooLarge { .. }) {
                let again = bounded(2 * HELD_BYTES, || normals_in_pieces(&path, &options, choice));
                assert_explained(&path, &again.map(|_| ()).expect_err("whole it was refused"));
            }
        }
        Ok((map, _)) => {
            let format = map.format();
            assert!(options.channels.is_none_or(|asked| asked == format.channels), "{format:?} for {options:?}");
            assert_eq!(format.convention, options.convention);
            let (size, codes) = bounded(2 * HELD_BYTES, || normals_in_pieces(&path, &options, choice)).expect("twice");
            assert!(size == map.size() && codes.as_ref().bytes() == map.codes().bytes(), "whole and in pieces");
            if size.texels() <= SMALL {
                assert_checked_and_written(map);
            }
        }
    }
}

fn normals_in_pieces(path: &Path, options: &NormalReadOptions, seed: usize) -> Result<(Size, Codes), Error> {
    let NormalFile { mut rows, .. } = open_normals(path, options)?;
    let (size, format) = (rows.size(), rows.format());
    let per_row = size.width() * format.channels.count();
    let mut all = Codes::zeroed(format.depth, per_row * size.height());
    all.as_mut().bytes_mut().fill(0xa5);
    let (mut row, mut step) = (0, seed);
    while row < size.height() {
        let end = (row + 1 + step % 5).min(size.height());
        rows.read(all.as_mut().slice(row * per_row..end * per_row))?;
        (row, step) = (end, step.wrapping_mul(31) + 7);
    }
    Ok((size, all))
}

/// `check` answers, with numbers that there can be, and the map is written as it is.
fn assert_checked_and_written(map: NormalMap) {
    let name = match map.format().encoding {
        Encoding::Unorm | Encoding::Biased => "w.png",
        Encoding::Snorm => "w.tif",
        Encoding::Float => "w.exr",
    };
    assert_written(&map, name);
    let texels = map.size().texels() as u64;
    let findings = check(map.into_rows(), &CheckOptions::default(), &Monitor::default()).expect("rows in memory");
    for finding in findings.list {
        assert!(!finding.what.is_empty(), "{finding:?}");
    }
    assert!(findings.census.zero_vectors.count <= texels && findings.census.no_direction.count <= texels);
}

/// Blends two flat maps through a mask from a file: rows to rows is map to map, and black is the first map.
pub fn assert_mask(data: &[u8]) {
    let Some((choice, bytes)) = choice(data) else { return };
    let extension = if choice % 16 == 15 { "tga" } else { "mask" };
    let options = ReadOptions {
        channel: CHANNELS[choice % 8].map(|name| name.parse().expect("any name")),
        max_bytes: MAX_BYTES,
        ..ReadOptions::default()
    };
    let path = file(&format!("m.{extension}"), bytes);
    let Ok((mask, _)) = HeightMap::read_with(&path, &options) else { return };
    if mask.size().texels() > SMALL {
        return;
    }
    let size = mask.size();
    let plane = |texel: [u8; 3]| {
        NormalMap::new(size, NormalFormat::default(), Codes::U8(texel.repeat(size.texels()))).expect("a map")
    };
    let (base, detail) = (plane([128, 128, 255]), plane([200, 90, 220]));
    let blend = BlendOptions { method: BlendMethod::Masked, ..Default::default() };
    let inputs = BlendInputs { base: &base, detail: &detail, mask: Some(&mask) };
    let whole = Baker::reference().blend(&inputs, &blend);
    let vectorised = Baker::cpu().blend(&inputs, &blend);
    match (whole, vectorised) {
        (Ok(whole), Ok(vectorised)) => {
            assert!(whole.codes().bytes() == vectorised.codes().bytes(), "the same bytes from every baker");
            let out = crate::path("b.png");
            let open = || {
                let mask = Some(open_heights(&path, &options)?.rows);
                Ok(BlendInputs { base: base.clone().into_rows(), detail: detail.clone().into_rows(), mask })
            };
            let create = |size| texbake::io::create_normals(&out, size, whole.format());
            Baker::cpu().blend_rows(&open, &create, &blend, &Monitor::default()).expect("it was blended whole");
            let rows = NormalMap::read(&out).expect("it was written");
            assert!(rows.codes().bytes() == whole.codes().bytes(), "rows to rows is map to map");
        }
        (Err(one), Err(other)) => assert_eq!(one.to_string(), other.to_string()),
        (one, other) => panic!("{:?} and {:?}", one.map(drop), other.map(drop)),
    }
}
