//! Repaired maps hold unit normals, rounded correctly, and pass the check.

use super::support::{findings, planted, sound, texel, xy};
use crate::support::{FLOAT16, FLOAT32, FORMATS, Image, UNORM8, UNORM16, every_baker};
use std::path::Path;
use texbake::inspect::{Problem, Repaired, repair};
use texbake::io::{NormalReadOptions, create_normals, open_normals};
use texbake::stream::Monitor;
use texbake::{Baker, Channels, Codes, CodesRef, Convention, Encoding, NormalFormat, NormalMap, Result, Size};

/// Repairs into a file, and reads it.
fn repaired(baker: &Baker, map: &NormalMap, format: NormalFormat) -> (NormalMap, Repaired) {
    let folder = tempfile::tempdir().unwrap();
    let name = match format {
        _ if format.depth == FLOAT16.depth => "n.exr",
        _ if matches!(format.encoding, Encoding::Snorm | Encoding::Float) => "n.tif",
        _ => "n.png",
    };
    let path = folder.path().join(name);
    let mended = mend(baker, map, &path, format).unwrap();
    let read = NormalReadOptions {
        encoding: Some(format.encoding),
        channels: Some(format.channels),
        convention: format.convention,
        ..Default::default()
    };
    let mut rows = open_normals(&path, &read).unwrap().rows;
    (texbake::stream::read_normals(rows.as_mut()).unwrap(), mended)
}

fn mend(baker: &Baker, map: &NormalMap, path: &Path, format: NormalFormat) -> Result<Repaired> {
    let open = || Ok(map.clone().into_rows());
    repair(baker, &open, &|size| create_normals(path, size, format), format, &Monitor::default())
}

/// Whether `code` is floor(L (v + 1) / 2 + 1/2) for v = a / sqrt(s): L a lies between (2 code - 1 - L) sqrt(s) and the
/// same for the next code. Compared by squares with their signs.
fn is_nearest_unorm(code: i128, a: i128, s: i128, greatest: i128) -> bool {
    let signed_square = |n: i128| n.signum() * n * n;
    let least = 2 * code - 1 - greatest;
    let value = signed_square(greatest * a);
    signed_square(least) * s <= value && value < signed_square(least + 2) * s
}

#[test]
fn every_normal_gets_the_nearest_codes_of_its_direction() {
    // Every x and z of 8 bits that is not below zero, with y from elsewhere: no length is right.
    let codes: Vec<u8> =
        (0..256 * 127).flat_map(|i| [i % 256, (i * 37 + i / 256) % 256, 129 + i / 256]).map(|c| c as u8).collect();
    let map = NormalMap::new(Size::new(256, 127).unwrap(), UNORM8, Codes::U8(codes.clone())).unwrap();
    let component = |code: u8| if code == 128 { 0 } else { 2 * i128::from(code) - 255 };
    for subject in every_baker() {
        let (mended, _) = repaired(&subject.baker, &map, UNORM8);
        let CodesRef::U8(mended) = mended.codes() else { panic!("8 bits") };
        for (texel, (from, to)) in codes.chunks_exact(3).zip(mended.chunks_exact(3)).enumerate() {
            let normal = [component(from[0]), component(from[1]), component(from[2])];
            let square = normal.iter().map(|part| part * part).sum();
            for (part, code) in normal.iter().zip(to) {
                assert!(
                    is_nearest_unorm((*code).into(), *part, square, 255),
                    "{}, texel {texel}: {from:?}, {to:?}",
                    subject.name
                );
            }
        }
    }
}

#[test]
fn planted_faults_are_gone_and_all_lengths_are_1() {
    for format in FORMATS {
        let [zero, one]: [f64; 2] = match (format.encoding, format.depth == UNORM8.depth) {
            (Encoding::Unorm | Encoding::Biased, true) => [128.0, 255.0],
            (Encoding::Unorm | Encoding::Biased, false) => [32_768.0, 65_535.0],
            (Encoding::Snorm, true) => [0.0, 127.0],
            (Encoding::Snorm, false) => [0.0, 32_767.0],
            (Encoding::Float, _) => [0.0, 1.0],
        };
        let half = zero + (one - zero) / 2.0;
        let half = if format.depth.is_float() { half } else { half.floor() };
        let [below, nan] = match format.encoding {
            Encoding::Float => [-0.5, f64::NAN],
            // Snorm wraps around to -2.
            Encoding::Snorm if format.depth == UNORM8.depth => [254.0, half],
            Encoding::Snorm => [65_534.0, half],
            _ => [zero / 2.0, half],
        };
        let map = planted(
            &sound(32, 32, format),
            &[
                (texel(1, 1), [zero, zero, zero]),
                (texel(2, 3), [half, zero, half]),
                (texel(5, 9), [half, zero, below]),
                (texel(7, 7), [nan, zero, one]),
                (texel(8, 7), [zero, half, one]),
            ],
        );
        assert!(findings(&map).has_faults(), "{format:?}");
        let (mended, how) = repaired(&Baker::cpu(), &map, format);
        assert_eq!((how.flattened, how.zero_vectors), (u64::from(format.depth.is_float()), 1), "{format:?}");
        assert!(!findings(&mended).has_faults(), "{format:?}: {:?}", findings(&mended).list);
        // From the codes alone: a code is off by half a step, where none is for zero by a whole one.
        let image = Image::from(&mended);
        for y in 0..32 {
            for x in 0..32 {
                let length = length_of(&image.texel(x, y), format);
                let bound = match (format.encoding, format.depth == UNORM8.depth) {
                    (Encoding::Float, _) if format.depth == FLOAT16.depth => 0.001,
                    (Encoding::Float, _) => 1e-6,
                    (Encoding::Unorm, true) => 3.0 / 255.0,
                    (Encoding::Unorm, false) => 3.0 / 65_535.0,
                    (_, true) => 0.87 / 127.0,
                    (_, false) => 0.87 / 32_767.0,
                };
                assert!((length - 1.0).abs() <= bound, "{format:?}, {x}, {y}: {length}");
            }
        }
        let flat =
            if format.depth.is_float() || format.encoding == Encoding::Snorm { [0.0, 0.0] } else { [zero, zero] };
        assert_eq!(image.texel(1, 1), [flat[0], flat[1], one], "{format:?}");
        if format.depth.is_float() {
            assert_eq!(image.texel(7, 7), [0.0, 0.0, 1.0], "{format:?}");
        }
    }
}

/// The length of a texel of codes as numbers.
fn length_of(texel: &[f64], format: NormalFormat) -> f64 {
    let eight = format.depth == UNORM8.depth;
    let square = |code: &f64| {
        let v = match (format.encoding, eight) {
            (Encoding::Unorm, true) if *code == 128.0 => 0.0,
            (Encoding::Unorm, false) if *code == 32_768.0 => 0.0,
            (Encoding::Unorm, true) => code / 127.5 - 1.0,
            (Encoding::Unorm, false) => code / 32_767.5 - 1.0,
            (Encoding::Biased, true) => (code - 128.0) / 127.0,
            (Encoding::Biased, false) => (code - 32_768.0) / 32_767.0,
            (Encoding::Snorm, true) => code / 127.0,
            (Encoding::Snorm, false) => code / 32_767.0,
            (Encoding::Float, _) => *code,
        };
        v * v
    };
    texel.iter().map(square).sum::<f64>().sqrt()
}

#[test]
fn a_sound_map_of_codes_keeps_its_directions() {
    // A code from the map of a map of codes is off by one at most, where rounding twice shows.
    for format in [UNORM8, UNORM16, xy(UNORM8)] {
        let map = sound(32, 32, format);
        let (again, _) = repaired(&Baker::cpu(), &map, format);
        let pairs = Image::from(&map).bits.into_iter().zip(Image::from(&again).bits);
        assert!(pairs.into_iter().all(|(a, b)| a.abs_diff(b) <= 1), "{format:?}");
    }
}

#[test]
fn green_turns_around_and_formats_change_where_that_is_asked_for() {
    let map = sound(48, 48, UNORM8);
    let dx = NormalFormat { convention: Convention::Dx, ..UNORM8 };
    let (turned, _) = repaired(&Baker::cpu(), &map, dx);
    assert_eq!(findings(&turned).green.likely(), Some(Convention::Dx));
    assert_eq!(findings(&turned).of(Problem::Green), None);
    let (float, _) = repaired(&Baker::cpu(), &map, FLOAT32);
    let (a, b) = (Image::from(&map).texel(5, 6), Image::from(&float).texel(5, 6));
    let length = a.iter().map(|c| (c / 127.5 - 1.0).powi(2)).sum::<f64>().sqrt();
    for (code, component) in a.iter().zip(b) {
        // Codes of 128 read as 0, not 1/255.
        assert!(((code / 127.5 - 1.0) / length - component).abs() < 0.005);
    }
}

#[test]
fn two_channels_stay_two() {
    let map = planted(&sound(16, 16, xy(FLOAT32)), &[(texel(4, 4), [0.8, 0.7]), (texel(3, 3), [f64::NAN, 0.0])]);
    let (mended, how) = repaired(&Baker::cpu(), &map, xy(FLOAT32));
    assert_eq!((how.flattened, mended.format().channels), (1, Channels::Xy));
    let image = Image::from(&mended);
    let [x, y] = image.texel(4, 4)[..] else { panic!("two channels") };
    assert!((x.hypot(y) - 1.0).abs() < 1e-6 && (y / x - 7.0 / 8.0).abs() < 1e-6, "{x} {y}");
    assert_eq!(image.texel(3, 3), [0.0, 0.0]);
}
