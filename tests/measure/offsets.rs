//! Errors of parallax offsets on a plateau, where each method has a closed form.

use super::{assert_near, quick};
use crate::support::{map_f32, scale};
use texbake::BakeOptions;
use texbake::measure::{MeasureOptions, parallax_methods};

/// A plateau a quarter of the scale above the plane.
const HEIGHT: f64 = 0.25;
const SCALE: f64 = 8.0;

/// Relief intersection ends 2^-17 of a step, of which there are 16 or more along 14 texels, from the plateau; uv of 32
/// texels is rounded to 2^-24, a few times.
const TOLERANCE: f64 = 14.0 / 16.0 / (1 << 17) as f64 + 8.0 * 32.0 / (1 << 24) as f64;

#[test]
fn a_plateau_has_the_error_of_each_formula() {
    let bake = BakeOptions { scale: scale("8"), ..Default::default() };
    let options = MeasureOptions { bake, elevation: 30.0, ..Default::default() };
    let figures = quick(&map_f32(32, 32, |_, _| 0.75), None, &options);
    assert_eq!(figures.offsets.len(), 3 * parallax_methods().len());
    for figure in &figures.offsets {
        let (sin, cos) = figure.elevation_degrees.to_radians().sin_cos();
        let cot = cos / sin;
        let truth = HEIGHT * SCALE * cot;
        // 2h - 1 = 1/2 as 8-bit snorm: 64 of 127.
        let stepped = SCALE / 2.0 * (64.0 / 127.0) * cos;
        let found = match figure.method.as_str() {
            "none" => 0.0,
            "welsh" => truth,
            "limited" => HEIGHT * SCALE * cos,
            "plane, limit 1" => HEIGHT * SCALE * cot.min(1.0),
            "plane, limit 3" => HEIGHT * SCALE * cot.min(3.0),
            steps if steps.starts_with("steps ") => stepped,
            relief => {
                // The plateau lies on a step of all of them: they stop half of the last bisection above it or below.
                let steps: f64 = relief.strip_prefix("relief ").unwrap().strip_suffix("+5").unwrap().parse().unwrap();
                let bound = SCALE * cot / steps / 64.0 + TOLERANCE;
                assert!(figure.error_texels.largest <= bound, "{figure:?}");
                continue;
            }
        };
        let (largest, mean) = (figure.error_texels.largest, figure.error_texels.mean);
        // A flat unorm texel reads as (1/255, 1/255, 1): n . v is off by up to sqrt(2)/255 v_xy, and the offset by that
        // over v_z; 5 % are for the square of it.
        let leaning = 1.05 * HEIGHT * SCALE * cot * cot * 2f64.sqrt() / 255.0;
        let tolerance = if figure.method.starts_with("plane") { TOLERANCE + leaning } else { TOLERANCE };
        assert_near(largest, (truth - found).abs(), tolerance, &format!("{figure:?}"));
        assert_near(mean, (truth - found).abs(), tolerance, &format!("{figure:?}"));
    }
}

#[test]
fn more_steps_down_the_relief_are_never_worse_by_much() {
    let wave = |t: usize| (std::f32::consts::TAU * t as f32 / 32.0).sin();
    let heights = map_f32(32, 32, |x, y| 0.5 + 0.25 * (wave(x) + wave(y)));
    let bake = BakeOptions { scale: scale("4"), ..Default::default() };
    let figures = quick(&heights, None, &MeasureOptions { bake, elevation: 45.0, ..Default::default() });
    let seen = figures.offsets.iter().filter(|figure| figure.elevation_degrees == 45.0);
    let mean = |name: &str| seen.clone().find(|figure| figure.method == name).unwrap().error_texels.mean;
    // Each doubling of the steps halves the cell that is bisected five times.
    for [coarse, fine] in
        [["relief 8+5", "relief 16+5"], ["relief 16+5", "relief 32+5"], ["relief 32+5", "relief 64+5"]]
    {
        assert!(mean(fine) < 0.6 * mean(coarse), "{coarse} and {fine}");
    }
    assert!(mean("welsh") < mean("none") && mean("relief 64+5") < mean("welsh"));
}
