//! Strips that are unpacked row by row, beside the same samples in strips that the format's crate decodes at once.

use crate::io::hand_made_tiff::Tiff;
use crate::io::support::read_last_row;
use crate::support::Random;
use std::io::Write;
use std::path::Path;
use texbake::io::{Channel, ReadOptions, open_heights};
use texbake::{HeightMap, HeightsMut};

const WIDTH: usize = 523;
/// Two thirds of the rows, with samples of two bytes, and all of them, with one byte, are more than the MiB up to which a
/// strip is decoded at once.
const HEIGHT: usize = 2011;

/// Bits and sample format: 1 unsigned, 2 signed, 3 float.
const TYPES: [(u16, u16); 7] = [(8, 1), (8, 2), (16, 1), (16, 2), (16, 3), (32, 3), (64, 3)];

/// Stored bytes of samples, one row after the other: finite numbers of every type, with runs and jumps.
fn samples(bits: u16, kind: u16, per_texel: usize) -> Vec<u8> {
    let mut random = Random::new(bits.into());
    (0..WIDTH * HEIGHT * per_texel)
        .flat_map(|_| {
            let value = random.below(512) as f64 - 100.0;
            match (bits, kind) {
                (8, _) => vec![value as i64 as u8],
                (16, 3) => half::f16::from_f64(value / 8.0).to_le_bytes().to_vec(),
                (16, _) => ((value * 90.0) as i64 as u16).to_le_bytes().to_vec(),
                (32, _) => (value as f32 / 7.0).to_le_bytes().to_vec(),
                _ => (value / 7.0).to_le_bytes().to_vec(),
            }
        })
        .collect()
}

/// Rows as a predictor leaves them (TIFF 6.0, section 14; Adobe's Technical Note 3): 2, the differences of samples; 3,
/// of floats, the differences of bytes, which stand by their significance.
fn predicted(rows: &[u8], bytes: usize, per_texel: usize, predictor: u32) -> Vec<u8> {
    let row_bytes = WIDTH * per_texel * bytes;
    let little = |sample: &[u8]| sample.iter().rev().fold(0u64, |number, byte| number << 8 | u64::from(*byte));
    let row = |row: &[u8]| -> Vec<u8> {
        match predictor {
            2 => {
                let samples: Vec<u64> = row.chunks(bytes).map(little).collect();
                let before = |index: usize| if index < per_texel { 0 } else { samples[index - per_texel] };
                let differences = (0..samples.len()).map(|index| samples[index].wrapping_sub(before(index)));
                differences.flat_map(|difference| difference.to_le_bytes()[..bytes].to_vec()).collect()
            }
            3 => {
                let place = |place: usize| row.chunks(bytes).map(move |sample| sample[bytes - 1 - place]);
                let sorted: Vec<u8> = (0..bytes).flat_map(place).collect();
                let before = |index: usize| if index < per_texel { 0 } else { sorted[index - per_texel] };
                (0..sorted.len()).map(|index| sorted[index].wrapping_sub(before(index))).collect()
            }
            _ => row.to_vec(),
        }
    };
    rows.chunks(row_bytes).flat_map(row).collect()
}

fn packed(strip: &[u8], compression: u32) -> Vec<u8> {
    match compression {
        5 => weezl::encode::Encoder::with_tiff_size_switch(weezl::BitOrder::Msb, 8).encode(strip).unwrap(),
        8 => {
            let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
            deflate.write_all(strip).unwrap();
            deflate.finish().unwrap()
        }
        _ => strip.to_vec(),
    }
}

/// A TIFF of these samples in strips of `rows` rows.
fn tiff(
    samples: &[u8],
    (bits, kind): (u16, u16),
    per_texel: usize,
    rows: usize,
    [compression, predictor]: [u32; 2],
) -> Tiff {
    let bytes = usize::from(bits / 8);
    let strips = samples.chunks(rows * WIDTH * per_texel * bytes);
    let pack = |strip: &[u8]| packed(&predicted(strip, bytes, per_texel, predictor), compression);
    let mut tiff = Tiff::grey(WIDTH as u32, HEIGHT as u32, bits, kind, strips.map(pack).collect());
    (tiff.samples, tiff.rows_per_strip) = (per_texel as u16, rows as u32);
    tiff.photometric = if per_texel == 3 { 2 } else { 1 };
    tiff.compression = compression as u16;
    tiff.extra.push((317, 3, 1, vec![predictor as u8, 0]));
    tiff
}

fn map(path: &Path, options: &ReadOptions) -> HeightMap {
    HeightMap::read_with(path, options).unwrap().0
}

/// Fails unless the file holds `expected`, read at once and with its last row first.
fn assert_holds(path: &Path, options: &ReadOptions, expected: &HeightMap, what: &str) {
    assert!(map(path, options) == *expected, "{what}");
    let mut rows = open_heights(path, options).unwrap().rows;
    macro_rules! assert_rows {
        ($kind:ident, $heights:expr) => {{
            let mut row = vec![Default::default(); WIDTH];
            read_last_row(rows.as_mut(), HeightsMut::$kind(&mut row)).unwrap();
            assert!(row == $heights[(HEIGHT - 1) * WIDTH..], "{what}: the last row");
            rows.skip(HEIGHT / 2).unwrap();
            rows.read(HeightsMut::$kind(&mut row)).unwrap();
            assert!(row == $heights[HEIGHT / 2 * WIDTH..][..WIDTH], "{what}: a row in the middle");
        }};
    }
    match expected.heights() {
        texbake::Heights::U8(heights) => assert_rows!(U8, heights),
        texbake::Heights::U16(heights) => assert_rows!(U16, heights),
        texbake::Heights::F32(heights) => assert_rows!(F32, heights),
    }
}

#[test]
fn every_type_compression_and_predictor() {
    let folder = tempfile::tempdir().unwrap();
    let (small, large) = (folder.path().join("small.tif"), folder.path().join("large.tif"));
    let options = ReadOptions::default();
    for (bits, kind) in TYPES {
        let samples = samples(bits, kind, 1);
        let plain = tiff(&samples, (bits, kind), 1, 16, [1, 1]);
        std::fs::write(&small, plain.bytes()).unwrap();
        let expected = map(&small, &options);
        for compression in [1, 5, 8] {
            // The floating-point predictor is for floats.
            for predictor in 1..=if kind == 3 { 3 } else { 2 } {
                for rows in [HEIGHT, HEIGHT * 2 / 3] {
                    let what = format!(
                        "{bits} bits, format {kind}, compression {compression}, predictor {predictor}, strips of {rows}"
                    );
                    let file = tiff(&samples, (bits, kind), 1, rows, [compression, predictor]);
                    std::fs::write(&large, file.bytes()).unwrap();
                    assert_holds(&large, &options, &expected, &what);
                }
            }
        }
    }
}

#[test]
fn colours_side_by_side_and_in_planes() {
    let folder = tempfile::tempdir().unwrap();
    let (small, large) = (folder.path().join("small.tif"), folder.path().join("large.tif"));
    let samples = samples(16, 1, 3);
    std::fs::write(&small, tiff(&samples, (16, 1), 3, 8, [1, 1]).bytes()).unwrap();
    for channel in [Channel::R, Channel::G, Channel::B] {
        let options = ReadOptions { channel: Some(channel), ..Default::default() };
        let expected = map(&small, &options);
        for packing in [[1, 1], [8, 2], [5, 2]] {
            std::fs::write(&large, tiff(&samples, (16, 1), 3, HEIGHT, packing).bytes()).unwrap();
            assert_holds(&large, &options, &expected, "side by side");

            let plane = |place: usize| -> Vec<u8> {
                samples.chunks(6).flat_map(|texel| texel[2 * place..][..2].to_vec()).collect()
            };
            let planes = [0, 1, 2].map(|place| tiff(&plane(place), (16, 1), 1, HEIGHT, packing));
            let chunks = planes.iter().flat_map(|plane| plane.chunks.clone()).collect();
            let planar = Tiff { samples: 3, photometric: 2, planar: true, chunks, ..planes[0].clone() };
            std::fs::write(&large, planar.bytes()).unwrap();
            assert_holds(&large, &options, &expected, "in planes");
        }
    }
}

/// What is skipped piece by piece is unpacked piece by piece, not when the row behind it is read.
#[test]
fn to_skip_is_to_unpack() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.tif");
    let samples = samples(16, 1, 1);
    for compression in [5, 8] {
        let mut file = tiff(&samples, (16, 1), 1, HEIGHT, [compression, 1]);
        let length = file.chunks[0].len();
        file.chunks[0].truncate(length / 2);
        std::fs::write(&path, file.bytes()).unwrap();
        let mut rows = open_heights(&path, &ReadOptions::default()).unwrap().rows;
        rows.skip(HEIGHT / 4).and_then(|()| rows.skip(HEIGHT / 8)).unwrap();
        let error = rows.skip(HEIGHT / 2).unwrap_err().to_string();
        assert!(error.contains("cut.tif: the file ends before its last row"), "{compression}: {error}");
    }
}

/// As long together as they should be, and one too short: its last rows are not those that stand behind it.
#[test]
fn a_strip_that_another_one_makes_up_for_is_too_short() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.tif");
    let samples = samples(16, 1, 1);
    for moved in [1, 2 * WIDTH] {
        let mut file = tiff(&samples, (16, 1), 1, HEIGHT * 2 / 3, [1, 1]);
        let length = file.chunks[0].len();
        let end = file.chunks[0].split_off(length - moved);
        file.chunks[1].splice(0..0, end);
        std::fs::write(&path, file.bytes()).unwrap();
        let error = HeightMap::read(&path).map(drop).unwrap_err().to_string();
        assert!(error.contains("cut.tif: the file ends before its last row"), "{moved}: {error}");
    }
}

#[test]
fn what_is_cut_off_is_missed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.tif");
    let samples = samples(16, 1, 1);
    for compression in [1, 5, 8] {
        let mut file = tiff(&samples, (16, 1), 1, HEIGHT, [compression, 1]);
        let length = file.chunks[0].len();
        file.chunks[0].truncate(length - length / 8);
        std::fs::write(&path, file.bytes()).unwrap();
        let error = HeightMap::read(&path).map(drop).unwrap_err().to_string();
        assert!(error.contains("cut.tif: the file ends before its last row"), "{compression}: {error}");
    }
}
