//! Differences of maps that are known: angles, codes, ranks, places.

use super::support::{dx, encoded, planted, sound, texel, xy};
use crate::support::{BIASED16, FLOAT16, FLOAT32, FORMATS, SNORM8, UNORM8};
use texbake::inspect::{Difference, heatmap};
use texbake::io::create_normals;
use texbake::stream::{Monitor, RowSink};
use texbake::{Codes, CodesRef, NormalFormat, NormalMap, Result, Size};

fn difference(a: &NormalMap, b: &NormalMap) -> Difference {
    difference_above(a, b, 0.0)
}

/// Angles above `tolerance` degrees are counted.
fn difference_above(a: &NormalMap, b: &NormalMap, tolerance: f64) -> Difference {
    Difference::between(a.clone().into_rows(), b.clone().into_rows(), tolerance, &Monitor::default()).unwrap()
}

fn flat(width: usize, height: usize, format: NormalFormat) -> NormalMap {
    encoded(width, height, format, |_, _| [0.0, 0.0, 1.0])
}

#[test]
fn a_map_does_not_differ_from_itself() {
    for format in FORMATS.into_iter().chain(FORMATS.map(xy)) {
        let map = sound(24, 17, format);
        let same = difference(&map, &map);
        assert_eq!((same.differing, same.no_angle, same.mean, same.percentile_99), (0, 0, 0.0, 0.0), "{format:?}");
        assert_eq!(same.largest.unwrap().0, 0.0, "{format:?}");
        let codes = same.codes.as_ref().unwrap();
        assert_eq!((codes.largest_of_all(), codes.mean_of_all()), (0.0, 0.0));
        assert!(!same.exceeds(0.0), "{format:?}");
    }
}

#[test]
fn an_eighth_of_a_turn_is_45_degrees() {
    for (format, codes) in [(UNORM8, [218.0, 128.0, 218.0]), (SNORM8, [0.0, 90.0, 90.0]), (FLOAT16, [0.0, -7.0, 7.0])] {
        let map = flat(3, 2, format);
        let found = difference(&map, &planted(&map, &[(texel(2, 1), codes)]));
        assert_eq!(found.largest, Some((45.0, texel(2, 1))), "{format:?}");
        assert!((found.mean - 7.5).abs() < 1e-12, "{format:?}: {}", found.mean);
    }
    let [base, tilted] = [[0.0, 0.0, 2.0], [0.0, -3.0, 3.0]].map(|v| encoded(3, 2, FLOAT32, |_, _| v));
    let found = difference(&base, &tilted);
    assert_eq!((found.largest, found.percentile_99), (Some((45.0, texel(0, 0))), 45.0));
    assert!((found.mean - 45.0).abs() < 1e-12, "{}", found.mean);
    let opposite =
        difference(&encoded(1, 1, FLOAT32, |_, _| [0.0, 0.0, 1.0]), &encoded(1, 1, FLOAT32, |_, _| [0.0, 0.0, -1.0]));
    assert_eq!(opposite.largest.unwrap().0, 180.0);
}

#[test]
fn one_code_apart_is_found_where_it_is() {
    let map = flat(100, 50, UNORM8);
    let other = planted(&map, &[(texel(70, 31), [129.0, 128.0, 255.0]), (texel(3, 40), [128.0, 125.0, 255.0])]);
    let found = difference(&map, &other);
    let codes = found.codes.as_ref().unwrap();
    assert_eq!((codes.largest.as_slice(), codes.largest_of_all()), (&[1.0, 3.0, 0.0][..], 3.0));
    assert_eq!(codes.mean, [1.0 / 5000.0, 3.0 / 5000.0, 0.0]);
    assert_eq!((found.differing, found.no_angle), (2, 0));
    // 125 is -5 of 255, 129 is 3.
    let [a, b] = [(5.0f64 / 255.0).atan().to_degrees(), (3.0f64 / 255.0).atan().to_degrees()];
    let (largest, at) = found.largest.unwrap();
    assert!((f64::from(largest) - a).abs() < 1e-6 && at == texel(3, 40), "{largest} {at}");
    assert!((found.mean - (a + b) / 5000.0).abs() < 1e-9, "{}", found.mean);
    assert_eq!(found.percentile_99, 0.0);
    assert!(found.exceeds(0.0) && found.exceeds(1.12) && !found.exceeds(1.13));
    let above = |tolerance| difference_above(&map, &other, tolerance).above_tolerance;
    assert_eq!([above(0.0), above(0.67), above(0.68), above(1.13)], [2, 2, 1, 0]);
}

#[test]
fn codes_of_signed_maps_are_signed_and_those_of_floats_are_components() {
    let [a, b] =
        [[255.0, 0.0, 127.0], [1.0, 0.0, 127.0]].map(|codes| planted(&flat(1, 1, SNORM8), &[(texel(0, 0), codes)]));
    assert_eq!(difference(&a, &b).codes.unwrap().largest, [2.0, 0.0, 0.0]);
    let [a, b] =
        [[0.25, 0.0, 1.0], [-0.5, 0.0, 1.0]].map(|codes| planted(&flat(1, 1, FLOAT16), &[(texel(0, 0), codes)]));
    assert_eq!(difference(&a, &b).codes.unwrap().largest, [0.75, 0.0, 0.0]);
    // -128 and -127 are both -1: other codes, the same direction.
    let [a, b] =
        [[128.0, 0.0, 0.0], [129.0, 0.0, 0.0]].map(|codes| planted(&flat(1, 1, SNORM8), &[(texel(0, 0), codes)]));
    let found = difference(&a, &b);
    assert_eq!((found.differing, found.largest.unwrap().0), (1, 0.0));
    assert!(found.exceeds(0.0) && !found.exceeds(1e-9));
}

#[test]
fn the_percentile_has_the_exact_rank() {
    // 200 angles of 1/8, 2/8, ... degrees in a shuffled order: the 198th is 24.75, which has few enough bits to stay.
    let tilt = |step: usize| {
        let angle = (step as f64 / 8.0).to_radians();
        [angle.sin(), 0.0, angle.cos()]
    };
    let map = encoded(20, 10, FLOAT32, |x, y| tilt((x + 20 * y) * 77 % 200 + 1));
    let found = difference(&flat(20, 10, FLOAT32), &map);
    let cut = |degrees: f64| {
        f64::from(found.percentile_99) <= degrees + 1e-5
            && f64::from(found.percentile_99) >= degrees * (1.0 - 1.0 / 4096.0) - 1e-5
    };
    assert!(cut(24.75), "{}", found.percentile_99);
    assert!((found.mean - 201.0 / 16.0).abs() < 1e-6, "{}", found.mean);
    let (largest, at) = found.largest.unwrap();
    // 77 i is 199 modulo 200 for i = 187.
    assert!((f64::from(largest) - 25.0).abs() < 1e-5 && at == texel(7, 9), "{largest} {at}");
}

#[test]
fn maps_of_any_two_formats_are_compared_by_angle() {
    let formats: Vec<_> = FORMATS.into_iter().chain(FORMATS.map(xy)).chain(FORMATS.map(dx)).collect();
    let exact = sound(24, 20, FLOAT32);
    for format in formats {
        let found = difference(&exact, &sound(24, 20, format));
        assert_eq!(found.codes.is_some(), format == FLOAT32, "{format:?}");
        assert_eq!(found.formats, [FLOAT32, format]);
        // Half a code in each component; of two channels z loses more where it is small, and these slopes are below 2.5.
        let half_code = match format.depth {
            texbake::Depth::Bits8 => 1.0 / 127.0,
            texbake::Depth::Float32 => 1e-6,
            _ => 1.0 / 1000.0,
        };
        let bound = (half_code * 4.0f64).to_degrees();
        let largest = f64::from(found.largest.unwrap().0);
        assert!(largest <= bound, "{format:?}: {largest} above {bound}");
        assert_eq!(found.differing == 0, largest == 0.0, "{format:?}");
    }
    // Read the wrong way round, they differ.
    let CodesRef::F32(codes) = exact.codes() else { panic!("floats") };
    let turned = NormalMap::new(exact.size(), dx(FLOAT32), Codes::F32(codes.to_vec())).unwrap();
    assert!(difference(&exact, &turned).exceeds(20.0));
}

#[test]
fn what_has_no_direction_has_no_angle_and_differs() {
    let map = flat(10, 10, FLOAT32);
    let broken = planted(
        &map,
        &[
            (texel(4, 5), [f64::NAN, 0.0, 1.0]),
            (texel(4, 6), [0.0, 0.0, 0.0]),
            (texel(5, 5), [0.0, f64::INFINITY, 0.0]),
        ],
    );
    let found = difference(&map, &broken);
    assert_eq!((found.no_angle, found.differing, found.largest), (3, 3, Some((0.0, texel(0, 0)))));
    assert_eq!(found.above_tolerance, 0);
    assert!(found.exceeds(180.0));
    // NaN is equal to nothing; the others are to themselves.
    let same = difference(&broken, &broken);
    assert_eq!((same.no_angle, same.differing), (1, 1));
    let zero = planted(&flat(4, 4, BIASED16), &[(texel(0, 0), [32_768.0, 32_768.0, 32_768.0])]);
    assert!(!difference(&zero, &zero).exceeds(0.0));
    let nothing = encoded(2, 2, FLOAT32, |_, _| [f64::NAN; 3]);
    let found = difference(&nothing, &nothing);
    assert_eq!((found.largest, found.mean, found.percentile_99, found.no_angle), (None, 0.0, 0.0, 4));
}

#[test]
fn sizes_must_be_equal() {
    let [a, b] = [flat(4, 5, UNORM8), flat(5, 4, UNORM8)].map(NormalMap::into_rows);
    let error = Difference::between(a, b, 0.0, &Monitor::default()).unwrap_err();
    assert_eq!(error.to_string(), "size of the second map is 5 x 4: it must be 4 x 5, as the first map's");
}

#[test]
fn a_heatmap_is_black_where_nothing_differs_and_white_at_the_greatest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("heat.png");
    let tilt = |degrees: f64| [degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()];
    let angles = [0.0, 10.0, 20.0, 40.0];
    let map = encoded(5, 2, FLOAT32, |x, y| if x == 4 { [f64::NAN; 3] } else { tilt(angles[x] * (1 - y) as f64) });
    let picture = create_normals(&path, Size::new(5, 2).unwrap(), NormalFormat::default()).unwrap();
    let pair = || [flat(5, 2, FLOAT32), map.clone()].map(NormalMap::into_rows);
    heatmap(pair(), 20.0, picture, &Monitor::default()).unwrap();
    let picture = NormalMap::read(&path).unwrap();
    let CodesRef::U8(pixels) = picture.codes() else { panic!("8 bits") };
    // Half-way, l = 128/255: 255 (l + l (1 - l)/2 (a cos t + b sin t)) with t = 2 pi (1/6 - 3/2 l) is this.
    let row = [[0, 0, 0], [161, 121, 74], [255, 255, 255], [255, 255, 255], [255, 0, 255]];
    for (x, colour) in row.iter().enumerate() {
        let pixel = &pixels[3 * x..][..3];
        assert!(pixel.iter().zip(colour).all(|(a, b)| a.abs_diff(*b) <= 3), "column {x}: {pixel:?}");
    }
    assert_eq!(pixels[15..], [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 255]);
    for greatest in [0.0, -1.0, f64::NAN] {
        let error = heatmap(pair(), greatest, Box::new(Nowhere), &Monitor::default()).unwrap_err();
        assert!(error.to_string().starts_with("heatmap-max is "), "{error}");
    }
}

/// Takes no row.
struct Nowhere;

impl RowSink for Nowhere {
    fn held_bytes(&self, _: usize) -> u64 {
        0
    }

    fn write(&mut self, _: usize, _: CodesRef<'_>) -> Result<()> {
        panic!("nothing was to be painted")
    }

    fn finish(self: Box<Self>) -> Result<()> {
        panic!("nothing was to be painted")
    }
}

#[test]
fn a_cancelled_monitor_ends_every_pass() {
    let map = flat(16, 16, UNORM8);
    let monitor = Monitor::default();
    monitor.cancel();
    let pair = || [map.clone(), map.clone()].map(NormalMap::into_rows);
    let [a, b] = pair();
    assert!(matches!(Difference::between(a, b, 0.0, &monitor), Err(texbake::Error::Cancelled)));
    assert!(matches!(heatmap(pair(), 1.0, Box::new(Nowhere), &monitor), Err(texbake::Error::Cancelled)));
    let options = texbake::inspect::CheckOptions::default();
    let checked = texbake::inspect::check(map.clone().into_rows(), &options, &monitor);
    assert!(matches!(checked, Err(texbake::Error::Cancelled)));
}
