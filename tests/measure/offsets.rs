//! Errors of parallax offsets on a plateau, where each method has a closed form.

use super::{assert_near, quick};
use crate::support::{map_f32, scale};
use texbake::material::{Material, ParallaxMethod};
use texbake::measure::{Errors, MeasureOptions, View, Views, parallax_methods};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, Error, Scale};

/// A plateau a quarter of the scale above the plane.
const HEIGHT: f64 = 0.25;
const SCALE: f64 = 8.0;

/// Offsets of up to 32 texels are rounded to 2^-24 of themselves, by eight operations at most.
const TOLERANCE: f64 = 8.0 * 32.0 / (1 << 24) as f64;

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

/// A plateau on a map that is not square, with another scale and other units along each axis.
#[test]
fn axes_are_not_exchanged() {
    let (texels, scales) = ([64.0, 16.0], [4.0, 2.0]);
    // 1/8 of 2 units along 64 texels, and of 1 unit along 16.
    let scale = Scale::physical(2.into(), 1.into(), "1/8".parse().unwrap());
    let options = BakeOptions { scale, ..Default::default() };
    let material = Material::bake(&Baker::cpu(), &map_f32(64, 16, |_, _| 0.75), &options).unwrap();
    let (views, monitor) = (Views::at_elevation(30.0, 500, 3), Monitor::default());
    let truth = views.truth(&material, &monitor).unwrap();
    for (method, share) in [
        // Of the scale times v_x / v_z: h - 1/2 for the truth, less what the method finds.
        (ParallaxMethod::None, HEIGHT),
        (ParallaxMethod::Welsh, 0.0),
        // v_z of it.
        (ParallaxMethod::Limited, HEIGHT / 2.0),
        // 2h - 1 as 8-bit snorm is 64 of 127.
        (ParallaxMethod::steps(3), HEIGHT - 32.0 / 127.0 / 2.0),
    ] {
        // The elevation has a sine of 1/2.
        let expected = |[along, down]: [f64; 2], units: [f64; 2]| {
            let error = |view: &View| {
                let [x, y, _] = view.eye.map(|part| 2.0 * share * f64::from(part));
                (x * along * units[0] / texels[0]).hypot(y * down * units[1] / texels[1]) as f32
            };
            Errors::of(views.pixels().iter().map(error).collect())
        };
        for units in [texels, [1.0, 1.0], [200.0, 10.0], [10.0, 200.0]] {
            let found = views.errors(&material, method, &truth, units.map(|unit| unit as f32), &monitor).unwrap();
            // Texture coordinates are rounded, whatever their units are.
            let tolerance = TOLERANCE / 32.0 * units[0].max(units[1]);
            let right = expected(scales, units);
            for (found, right) in [(found.largest, right.largest), (found.mean, right.mean)] {
                assert_near(found, right, tolerance, &format!("{method} {units:?}"));
            }
            let exchanged = expected([scales[1], scales[0]], units);
            assert!(share == 0.0 || (found.mean - exchanged.mean).abs() > 10.0 * tolerance, "{method} {units:?}");
        }
    }
}

#[test]
fn offsets_can_be_stopped() {
    let material = Material::bake(&Baker::cpu(), &map_f32(8, 8, |_, _| 0.5), &BakeOptions::default()).unwrap();
    let (views, monitor) = (Views::at_elevation(30.0, 10, 3), Monitor::default());
    let truth = views.truth(&material, &monitor).unwrap();
    monitor.cancel();
    assert!(matches!(views.truth(&material, &monitor), Err(Error::Cancelled)));
    let errors = views.errors(&material, ParallaxMethod::Welsh, &truth, [8.0; 2], &monitor);
    assert!(matches!(errors, Err(Error::Cancelled)));
}
