//! Planted texels: their number, first place, share and worst.

use super::support::{encoded, findings, planted, problems, sound, texel, xy};
use crate::support::{BIASED8, FLOAT16, FLOAT32, FORMATS, SNORM16, UNORM8, UNORM16};
use texbake::inspect::{Census, Counted, Misreading, Problem, Severity, Tally};
use texbake::stream::NormalSource;
use texbake::{Codes, CodesMut, NormalFormat, NormalMap, Size};

fn one(x: usize, y: usize) -> Tally {
    Tally { count: 1, first: Some(texel(x, y)) }
}

const NONE: Tally = Tally { count: 0, first: None };

#[test]
fn lengths_that_rounding_cannot_give_are_counted() {
    // Of 20 x 20 texels; (2 x 200 - 255, 0, 2 x 200 - 255) / 255 is 0.8042 long, 255 with 145 is 1.1504.
    let map = planted(
        &sound(20, 20, UNORM8),
        &[
            (texel(3, 4), [200.0, 128.0, 200.0]),
            (texel(19, 19), [255.0, 128.0, 200.0]),
            (texel(0, 5), [200.0, 128.0, 200.0]),
        ],
    );
    let found = findings(&map);
    assert_eq!(found.census.texels, 400);
    assert_eq!(found.census.non_unit, Tally { count: 3, first: Some(texel(3, 4)) });
    let (length, at) = found.census.worst_length.unwrap();
    assert_eq!((format!("{length:.4}").as_str(), at), ("0.8042", texel(3, 4)));
    let finding = found.of(Problem::NonUnit).unwrap();
    assert_eq!((finding.severity, finding.texels, finding.share), (Severity::Fault, Some(3), Some(3.0 / 400.0)));
    assert_eq!((finding.at, finding.worst), (Some(texel(3, 4)), Some(length)));
    assert_eq!(
        finding.what,
        "3 texels (0.75%) of a length that rounding a unit vector cannot give, first at column 3, row 4, \
         worst 0.8042 at column 3, row 4"
    );
    assert_eq!(finding.remedy, "texbake check --repair gives them their length");
    assert_eq!(problems(&map), [Problem::NonUnit]);
}

/// The longest and shortest codes that rounding a unit vector to an encoding can give, and the next ones.
#[test]
fn the_bound_is_what_rounding_explains() {
    let is_unit = |format: NormalFormat, codes: [f64; 3]| {
        let flat = encoded(1, 1, format, |_, _| [0.0, 0.0, 1.0]);
        let census = findings(&planted(&flat, &[(texel(0, 0), codes)])).census;
        census.non_unit.count + census.rounding.count == 0
    };
    // unorm 8: 255 in units of 1/255 is off by 1 in each component, root 3 in all: squares from 253.27^2 to 256.73^2;
    // (147, 147, 147): 254.61; (148, 147, 147): 255.77; (149, 149, 147): 257.
    assert!(is_unit(UNORM8, [201.0, 201.0, 201.0]));
    assert!(is_unit(UNORM8, [202.0, 201.0, 201.0]));
    assert!(!is_unit(UNORM8, [202.0, 202.0, 201.0]));
    // With y read as zero, off by 2 more: root 6, so squares from 252.55^2 to 257.45^2. (181, 0, 181): 255.97;
    // (183, 0, 181): 257.39; (183, 0, 183): 258.8; (179, 0, 179): 253.1; (179, 0, 177): 251.7.
    assert!(is_unit(UNORM8, [218.0, 128.0, 218.0]) && is_unit(UNORM8, [219.0, 128.0, 218.0]));
    assert!(!is_unit(UNORM8, [219.0, 128.0, 219.0]));
    assert!(is_unit(UNORM8, [217.0, 128.0, 217.0]) && !is_unit(UNORM8, [217.0, 128.0, 216.0]));
    // biased 8: half a code in each of three components: 127 +- 0.87. (0, 0, 126) is 1 short, (0, 4, 127) is 127.06,
    // (0, 15, 127) is 127.88.
    assert!(is_unit(BIASED8, [128.0, 128.0, 255.0]) && !is_unit(BIASED8, [128.0, 128.0, 254.0]));
    assert!(is_unit(BIASED8, [128.0, 132.0, 255.0]) && !is_unit(BIASED8, [128.0, 143.0, 255.0]));
    // snorm 16: 32767 +- 0.87.
    assert!(is_unit(SNORM16, [0.0, 0.0, 32767.0]) && !is_unit(SNORM16, [0.0, 0.0, 32766.0]));
    // Halves within 2^-10, floats within 2^-20: 1 - 2^-11 is a half, 1 - 2^-19 is none.
    let short_by = |exponent: i32| [0.0, 0.0, 1.0 - 2f64.powi(exponent)];
    assert!(is_unit(FLOAT16, short_by(-11)) && !is_unit(FLOAT16, short_by(-9)));
    assert!(is_unit(FLOAT32, short_by(-11)) && is_unit(FLOAT32, short_by(-21)) && !is_unit(FLOAT32, short_by(-19)));
}

/// Whether a length counts as off by rounding, or as wrong.
fn tallies(format: NormalFormat, codes: [f64; 3]) -> [u64; 2] {
    let flat = encoded(2, 1, format, |_, _| [0.0, 0.0, 1.0]);
    let census = findings(&planted(&flat, &[(texel(1, 0), codes)])).census;
    [census.rounding.count, census.non_unit.count]
}

#[test]
fn up_to_three_steps_are_rounding_and_more_are_not() {
    // A step of unorm 8 is 2/255: 249 of 255 is three steps short, which is (0, 0, 252).
    assert_eq!(tallies(UNORM8, [128.0, 128.0, 252.0]), [1, 0]);
    assert_eq!(tallies(UNORM8, [128.0, 128.0, 251.0]), [0, 1]);
    // 127 less 3; 127.88 is 0.88 too long.
    assert_eq!(tallies(BIASED8, [128.0, 128.0, 252.0]), [1, 0]);
    assert_eq!(tallies(BIASED8, [128.0, 128.0, 251.0]), [0, 1]);
    assert_eq!(tallies(BIASED8, [128.0, 143.0, 255.0]), [1, 0]);
    assert_eq!([tallies(SNORM16, [0.0, 0.0, 32764.0]), tallies(SNORM16, [0.0, 0.0, 32763.0])], [[1, 0], [0, 1]]);
    for format in [FLOAT16, FLOAT32] {
        let short_by = |part: f64| [0.0, 0.0, 1.0 - part];
        assert_eq!(tallies(format, short_by(1.0 / 512.0)), [1, 0], "{format:?}");
        assert_eq!(tallies(format, short_by(1.0 / 256.0)), [0, 1], "{format:?}");
    }
}

/// Directions of a tilted dome, of every azimuth.
fn dome(x: usize, y: usize) -> [f64; 3] {
    let [p, q] = [(x as f64 - 31.5) / 20.0, (y as f64 - 29.5) / 20.0];
    let length = (p * p + q * q + 1.0).sqrt();
    [p / length, q / length, 1.0 / length]
}

#[test]
fn other_ways_to_round_are_a_note() {
    let truncate = |v: f64| ((v + 1.0) / 2.0 * 255.0).floor();
    let by_256 = |v: f64| ((v + 1.0) / 2.0 * 255.999).floor();
    let biased = |v: f64| (127.0 * v).round() + 128.0;
    let ways: [&dyn Fn(f64) -> f64; 3] = [&truncate, &by_256, &biased];
    for (code, name) in ways.into_iter().zip(["truncated", "times 255.999", "biased"]) {
        let codes = (0..64 * 64).flat_map(|i| dome(i % 64, i / 64).map(|v| code(v) as u8)).collect();
        let map = NormalMap::new(Size::new(64, 64).unwrap(), UNORM8, Codes::U8(codes)).unwrap();
        let found = findings(&map);
        let note = found.of(Problem::Rounding).unwrap_or_else(|| panic!("{name}: {:?}", found.list));
        assert_eq!((note.severity, found.census.non_unit), (Severity::Note, NONE), "{name}");
        assert_eq!(note.remedy.contains("--encoding biased"), name == "biased", "{name}: {note}");
        assert!((note.worst.unwrap() - 1.0).abs() > 3f64.sqrt() / 255.0, "{name}: {note}");
    }
}

#[test]
fn a_length_next_to_1_is_told_by_what_it_is_off() {
    let flat = encoded(1, 1, FLOAT32, |_, _| [0.0, 0.0, 1.0]);
    // 1 - 3 2^-20 is 2.86 millionths short.
    let map = planted(&flat, &[(texel(0, 0), [0.0, 0.0, 1.0 - 3.0 / 1_048_576.0])]);
    let found = findings(&map);
    assert_eq!(
        found.of(Problem::Rounding).unwrap().what,
        "1 texel (100%) of a length slightly off, as of codes that were rounded otherwise than to the nearest, first \
         at column 0, row 0, worst 1 - 2.86e-6 at column 0, row 0"
    );
    assert!(!found.has_faults());
}

#[test]
fn a_third_channel_that_is_no_z_is_found() {
    let misreading = |map: &NormalMap| findings(map).census.misreading();
    for format in FORMATS {
        let map = |blue: f64| {
            let map = sound(24, 24, format);
            let image = crate::support::Image::from(&map);
            let texels: Vec<_> = (0..24 * 24)
                .map(|i| {
                    let of = image.texel(i % 24, i / 24);
                    (texel(i % 24, i / 24), [of[0], of[1], blue])
                })
                .collect();
            planted(&map, &texels)
        };
        let one = match (format.encoding, format.depth == UNORM8.depth) {
            (texbake::Encoding::Float, _) => 1.0,
            (texbake::Encoding::Snorm, true) => 127.0,
            (texbake::Encoding::Snorm, false) => 32_767.0,
            (_, true) => 255.0,
            (_, false) => 65_535.0,
        };
        assert_eq!(misreading(&sound(24, 24, format)), None, "{format:?}");
        for blue in [0.0, one] {
            assert_eq!(misreading(&map(blue)), Some(Misreading::TwoChannels), "{format:?}, {blue}");
            let finding = findings(&map(blue)).of(Problem::Misread).cloned().unwrap();
            assert_eq!((finding.severity, finding.remedy.as_str()), (Severity::Fault, "read it with --channels xy"));
        }
        // Nothing is said of what has two channels, nor of one length everywhere.
        assert_eq!(misreading(&sound(24, 24, xy(format))), None, "{format:?}");
        let cone = |x: usize, y: usize| if (x + y).is_multiple_of(2) { [0.6, 0.0, 0.8] } else { [0.0, -0.6, 0.8] };
        assert_eq!(misreading(&encoded(8, 8, format, cone)), None, "{format:?}");
    }
    // As steep as the encoding can tell, everywhere.
    assert_eq!(misreading(&encoded(8, 8, UNORM8, |x, _| [if x % 2 == 0 { 1.0 } else { -1.0 }, 0.0, 0.0])), None);
    let flat = encoded(8, 8, FLOAT32, |_, _| [0.0; 3]);
    assert_eq!(misreading(&flat), Some(Misreading::TwoChannels));
}

#[test]
fn floats_from_0_to_1_are_found() {
    for format in [FLOAT16, FLOAT32] {
        let stored = encoded(64, 64, format, |x, y| dome(x, y).map(|v| (v + 1.0) / 2.0));
        let found = findings(&stored);
        assert_eq!(found.census.misreading(), Some(Misreading::UnormFloats), "{format:?}");
        let finding = found.of(Problem::Misread).unwrap();
        assert_eq!(
            finding.to_string(),
            "misread: all values lie between 0 and 1, as if stored as unorm; read it with --encoding unorm"
        );
        // One value beyond; flat; slopes along +x and +y alone.
        let beyond = planted(&stored, &[(texel(3, 3), [0.5, 0.5, 1.5])]);
        let flat = encoded(8, 8, format, |_, _| [0.0, 0.0, 1.0]);
        let corner = encoded(64, 64, format, |x, y| dome(x, y).map(f64::abs));
        for map in [beyond, flat, corner] {
            assert_eq!(findings(&map).census.misreading(), None, "{format:?}");
        }
    }
}

#[test]
fn z_at_and_below_zero_and_zero_vectors_are_told_apart() {
    for (format, zero, below) in [(UNORM8, 128.0, 127.0), (UNORM16, 32_768.0, 30_000.0), (BIASED8, 128.0, 127.0)] {
        let greatest = if format.depth == UNORM16.depth { 65_535.0 } else { 255.0 };
        let map = planted(
            &sound(16, 16, format),
            &[
                (texel(1, 2), [greatest, zero, zero]),
                (texel(7, 15), [greatest, zero, below]),
                (texel(8, 8), [zero, zero, zero]),
            ],
        );
        let census = findings(&map).census;
        assert_eq!(census.at_zero, one(1, 2), "{format:?}");
        assert_eq!(census.below_zero, one(7, 15), "{format:?}");
        assert_eq!(census.zero_vectors, one(8, 8), "{format:?}");
        assert_eq!((census.raised(), census.no_direction), (3, NONE), "{format:?}");
    }
    let steep = planted(&sound(16, 16, UNORM8), &[(texel(1, 2), [255.0, 128.0, 128.0])]);
    let note = findings(&steep);
    assert_eq!(
        (note.has_faults(), note.list[0].severity, note.list[0].problem),
        (false, Severity::Note, Problem::AtZero)
    );
}

#[test]
fn floats_without_direction_are_counted_and_nothing_else_is_said_of_them() {
    for format in [FLOAT16, FLOAT32] {
        let map = planted(
            &sound(16, 16, format),
            &[
                (texel(5, 9), [f64::NAN, 0.0, 1.0]),
                (texel(2, 9), [0.0, f64::INFINITY, 1.0]),
                (texel(0, 10), [0.0, 0.0, f64::NEG_INFINITY]),
            ],
        );
        let found = findings(&map);
        assert_eq!(found.census.no_direction, Tally { count: 3, first: Some(texel(2, 9)) }, "{format:?}");
        assert_eq!([found.census.non_unit, found.census.below_zero, found.census.zero_vectors], [NONE; 3]);
        assert_eq!(found.of(Problem::NoDirection).unwrap().share, Some(3.0 / 256.0));
    }
    let large =
        planted(&sound(16, 16, FLOAT32), &[(texel(0, 0), [65_537.0, 0.0, 1.0]), (texel(1, 0), [65_536.0, 0.0, 1.0])]);
    let census = findings(&large).census;
    assert_eq!((census.no_direction, census.non_unit), (one(0, 0), one(1, 0)));
}

#[test]
fn two_channels_may_not_be_longer_than_1() {
    for format in FORMATS.map(xy) {
        assert_eq!(problems(&sound(16, 16, format)), [], "{format:?}");
    }
    // (145, 245) / 255 is 1.1164 long; (0, 0) is flat.
    let map = planted(&sound(16, 16, xy(UNORM8)), &[(texel(4, 4), [200.0, 250.0]), (texel(5, 5), [128.0, 128.0])]);
    let census = findings(&map).census;
    assert_eq!((census.non_unit, census.zero_vectors), (one(4, 4), NONE));
    assert_eq!(format!("{:.4}", census.worst_length.unwrap().0), "1.1164");
    let float = planted(&sound(16, 16, xy(FLOAT32)), &[(texel(4, 4), [0.8, 0.7]), (texel(3, 3), [f64::NAN, 0.0])]);
    let census = findings(&float).census;
    assert_eq!((census.non_unit, census.no_direction), (one(4, 4), one(3, 3)));
}

#[test]
fn a_map_is_counted_while_something_else_reads_it() {
    let map = planted(&sound(16, 20, UNORM8), &[(texel(3, 17), [128.0, 128.0, 100.0])]);
    let (mut counted, census) = Counted::new(map.clone().into_rows());
    assert_eq!((counted.size(), counted.format()), (map.size(), map.format()));
    let mut rows = vec![77u8; 16 * 20 * 3];
    // 7, 7 and 6 rows.
    for band in rows.chunks_mut(16 * 3 * 7) {
        counted.read(CodesMut::U8(band)).unwrap();
    }
    assert_eq!(texbake::CodesRef::U8(&rows), map.codes());
    let census = census.lock().unwrap().clone();
    assert_eq!((census.texels, census.below_zero), (320, one(3, 17)));
    assert_eq!(census, Census::of(map.into_rows()).unwrap());
}

#[test]
fn high_maps_are_counted_over_many_bands() {
    // 3 MiB are three bands of rows.
    let codes: Vec<u8> = [128, 128, 255].repeat(1 << 20);
    let map = NormalMap::new(Size::new(16, 1 << 16).unwrap(), UNORM8, Codes::U8(codes)).unwrap();
    let map = planted(&map, &[(texel(7, 65_535), [128.0, 128.0, 0.0])]);
    let census = Census::of(map.into_rows()).unwrap();
    assert_eq!((census.texels, census.below_zero), (1 << 20, one(7, 65_535)));
}
