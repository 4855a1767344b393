//! Errors of blends: against closed forms with one map flat, and against nothing but rounding where none is made.

use super::{assert_near, clamped, quick};
use crate::support::{map_u8, map_u16};
use texbake::HeightMap;
use texbake::measure::{Figures, MeasureOptions};

/// What verify lets a blend of floats be off, in degrees.
const FLOATS: f64 = 1.3e-4;

fn largest(figures: &Figures, method: &str, bits: &str) -> f64 {
    let found = figures.blends.iter().filter(|figure| figure.method == method && figure.bits == bits);
    let [figure] = found.collect::<Vec<_>>()[..] else { panic!("not one {method} in {bits} bits") };
    figure.error_degrees.largest
}

#[test]
fn a_slope_over_a_flat_map_has_the_error_of_each_formula() {
    // 2 codes of 255 for each texel, 255 texels high: a slope of 2.
    let (flat, ramp) = (map_u8(64, 8, |_, _| 9), map_u8(64, 8, |x, _| 2 * x as u8));
    let figures = quick(&flat, Some(&ramp), &clamped("255"));
    let lean = 2f64.atan();
    for (method, expected) in [
        ("add", 0.0),
        ("weighted", 0.0),
        // (0, 0, 1) + n leans half as much.
        ("linear", lean / 2.0),
        // (x, y, 1) for (x, y, z).
        ("udn", lean - lean.sin().atan()),
        ("overlay", lean - lean.sin().atan()),
        ("whiteout", 0.0),
        ("rnm", 0.0),
    ] {
        assert_near(largest(&figures, method, "32f"), expected.to_degrees(), FLOATS, method);
    }
}

/// Hills that lean up to 45 degrees.
fn hills() -> HeightMap {
    let wave = |t: usize| (std::f64::consts::TAU * t as f64 / 32.0).sin();
    map_u16(32, 32, |x, y| (32_767.5 + 16_000.0 * (wave(x) + wave(2 * y))) as u16)
}

#[test]
fn slopes_that_are_added_have_no_error_but_rounding() {
    let bake = texbake::BakeOptions { scale: crate::support::scale("9"), ..Default::default() };
    let options = MeasureOptions { bake, ..Default::default() };
    let figures = quick(&hills(), None, &options);
    for method in ["add", "weighted"] {
        assert!(largest(&figures, method, "32f") < FLOATS, "{method}");
        let of_codes = largest(&figures, method, "8");
        assert!((0.1..5.0).contains(&of_codes), "{method}: {of_codes}");
    }
    for method in ["linear", "udn", "overlay", "whiteout", "rnm"] {
        assert!(largest(&figures, method, "32f") > 1.0, "{method} is no sum of slopes");
    }
}

#[test]
fn a_smaller_detail_is_repeated() {
    let cell = map_u8(8, 8, |x, y| (x * y * 5) as u8);
    let repeated = map_u8(32, 32, |x, y| (x % 8 * (y % 8) * 5) as u8);
    let [of_cell, of_repeated] =
        [&cell, &repeated].map(|detail| quick(&hills(), Some(detail), &MeasureOptions::default()));
    let errors = |figures: &Figures| figures.blends.iter().map(|figure| figure.error_degrees).collect::<Vec<_>>();
    assert_eq!(errors(&of_cell), errors(&of_repeated));
}
