//! Errors of normal and parallax maps.

use super::{assert_near, clamped, quick};
use crate::support::{FORMATS, Random, map_u8, map_u16, options, xy};
use texbake::material::Texture;
use texbake::measure::{Errors, MeasureOptions, TrueNormals};
use texbake::{
    BakeOptions, Baker, Codes, CodesRef, Convention, Depth, Edges, Encoding, NormalFormat, NormalMap, ParallaxFormat,
    ParallaxMap,
};

/// Rounding of f32 while a code is decoded: three operations on numbers up to 2.
const DECODING: f64 = 3.0 / (1 << 24) as f64;

#[test]
fn a_flat_map_has_the_error_of_unorm_codes_alone() {
    let figures = quick(&map_u8(16, 16, |_, _| 77), None, &MeasureOptions::default());
    assert_eq!(figures.normal_maps.len(), 32);
    for figure in &figures.normal_maps {
        let greatest = if figure.stored.bits == "8" { 255.0 } else { 65_535.0 };
        // No code is zero: x and y read as 1 / greatest. z is 1, or rebuilt from x and y.
        let lean = 2f64.sqrt() / greatest;
        let expected = match (figure.stored.encoding.as_str(), figure.channels.as_str()) {
            ("unorm", "xyz") => lean.atan().to_degrees(),
            ("unorm", _) => lean.asin().to_degrees(),
            _ => 0.0,
        };
        let errors = figure.error_degrees;
        for (error, name) in [(errors.largest, "largest"), (errors.percentile_99, "99th"), (errors.mean, "mean")] {
            // The decoded components, and the answer as an f32, are off by that much.
            let tolerance = if expected == 0.0 { 0.0 } else { 2.0 * DECODING.to_degrees() };
            assert_near(error, expected, tolerance, &format!("{} {name}", figure.name()));
        }
    }
    let unorm = figures.normal_maps.iter().find(|figure| figure.name() == "exact, unorm 8 xyz").unwrap();
    assert_near(unorm.error_degrees.largest, 0.3178, 5e-5, "the known angle of (1/255, 1/255, 1)");
    // 2h - 1 of 77 / 255.
    let value: f64 = 2.0 * 77.0 / 255.0 - 1.0;
    let snorm = figures.parallax_maps.iter().find(|figure| figure.stored.name() == "exact, snorm 8").unwrap();
    assert_near(snorm.error.largest, (value - (127.0 * value).round() / 127.0).abs(), DECODING, "snorm 8");
}

#[test]
fn a_ramp_has_the_normal_of_its_slope() {
    // 3 codes of 255 for each texel, 85 texels high: a slope of 1.
    let ramp = map_u8(32, 4, |x, _| 3 * x as u8);
    let options = clamped("85").bake;
    let truth = TrueNormals::new(&ramp, &options).unwrap();
    assert_near(truth.slope(7, 2)[0], 1.0, 1e-15, "the slope");
    let half = 0.5f64.sqrt();
    for (found, expected) in truth.at(7, 2).into_iter().zip([-half, 0.0, half]) {
        assert_near(found, expected, 1e-15, "45 degrees");
    }
    // n_z (2h - 1) at h = 21 / 255.
    assert_near(truth.parallax_at(7, 2), half * (42.0 / 255.0 - 1.0), 1e-15, "parallax");
    // At a border that clamps only half of the difference is left.
    assert_near(truth.slope(0, 0)[0], 0.5, 1e-15, "the border");
}

#[test]
fn errors_of_integer_codes_are_within_half_a_code_and_not_far_below() {
    let mut random = Random::new(5);
    let heights = map_u16(64, 64, |_, _| random.below(65_536) as u16);
    let bake = options("3", FORMATS[0]);
    let truth = TrueNormals::new(&heights, &bake.into()).unwrap();
    for format in FORMATS {
        let map = Baker::cpu().normal(&heights, &texbake::NormalOptions { format, ..bake }).unwrap();
        let largest = truth.errors(&Texture::of_normals(&map, Edges::default())).largest;
        let half_a_code = match (format.encoding, format.depth) {
            (Encoding::Unorm, Depth::Bits8) => 1.0 / 255.0,
            (Encoding::Unorm, _) => 1.0 / 65_535.0,
            (_, Depth::Bits8) => 0.5 / 127.0,
            (_, Depth::Bits16) => 0.5 / 32_767.0,
            // Half a unit in the last place of 1: 11 and 24 bits.
            (_, Depth::Float16) => 2f64.powi(-12),
            // And some roundings of the normalisation.
            (_, Depth::Float32) => 8.0 * 2f64.powi(-25),
        };
        // Each component is off by half a code at most, so the vector by sqrt(3) of them.
        let bound = (3f64.sqrt() * (half_a_code + DECODING)).asin().to_degrees();
        assert!(largest <= bound, "{} {}: {largest} is above {bound}", format.encoding, format.depth);
        assert!(largest >= bound / 20.0, "{} {}: {largest} is too good", format.encoding, format.depth);
    }
}

#[test]
fn a_rebuilt_z_costs_accuracy_where_bumps_are_steep() {
    let mut random = Random::new(6);
    let heights = map_u16(64, 64, |_, _| random.below(65_536) as u16);
    let truth = TrueNormals::new(&heights, &options("50", FORMATS[0]).into()).unwrap();
    let largest = |format: NormalFormat| {
        let map = Baker::cpu().normal(&heights, &options("50", format)).unwrap();
        truth.errors(&Texture::of_normals(&map, Edges::default())).largest
    };
    // Near z = 0 an error e of x and y becomes one of up to sqrt(2 e) of z.
    assert!(largest(xy(FORMATS[0])) > 2.0 * largest(FORMATS[0]));
}

#[test]
fn green_the_wrong_way_round_shows() {
    let heights = map_u8(16, 16, |x, y| (11 * x + 7 * y * y) as u8);
    let bake = options("5", FORMATS[0]);
    let truth = TrueNormals::new(&heights, &BakeOptions::from(bake)).unwrap();
    let down = NormalFormat { convention: Convention::Dx, ..FORMATS[0] };
    let map = Baker::cpu().normal(&heights, &texbake::NormalOptions { format: down, ..bake }).unwrap();
    assert!(truth.errors(&Texture::of_normals(&map, Edges::default())).largest < 0.5);
    let CodesRef::U8(codes) = map.codes() else { unreachable!() };
    let misread = NormalMap::new(map.size(), FORMATS[0], Codes::U8(codes.to_vec())).unwrap();
    assert!(truth.errors(&Texture::of_normals(&misread, Edges::default())).mean > 10.0);
}

/// What a device leaves that writes nothing, or no numbers, is as wrong as can be.
#[test]
fn texels_without_a_direction_are_wrong() {
    let heights = map_u8(16, 8, |_, _| 77);
    let truth = TrueNormals::new(&heights, &MeasureOptions::default().bake).unwrap();
    let format = |encoding, depth| NormalFormat { encoding, depth, ..FORMATS[0] };
    let none = Errors { largest: 180.0, percentile_99: 180.0, mean: 180.0 };
    for (format, codes) in [
        (format(Encoding::Snorm, Depth::Bits8), Codes::U8(vec![0; 3 * 16 * 8])),
        (format(Encoding::Biased, Depth::Bits8), Codes::U8(vec![128; 3 * 16 * 8])),
        (format(Encoding::Float, Depth::Float32), Codes::F32(vec![0.0; 3 * 16 * 8])),
        (format(Encoding::Float, Depth::Float32), Codes::F32(vec![f32::NAN; 3 * 16 * 8])),
        (format(Encoding::Float, Depth::Float32), Codes::F32(vec![f32::INFINITY; 3 * 16 * 8])),
    ] {
        let map = NormalMap::new(heights.size(), format, codes).unwrap();
        assert_eq!(truth.errors(&Texture::of_normals(&map, Edges::default())), none, "{format:?}");
    }
    // A single one of 128 shows.
    let mut codes = [0.0, 0.0, 1.0].repeat(16 * 8);
    codes[3 * 77 + 2] = f32::NAN;
    let map = NormalMap::new(heights.size(), format(Encoding::Float, Depth::Float32), Codes::F32(codes)).unwrap();
    assert_eq!(truth.errors(&Texture::of_normals(&map, Edges::default())).largest, 180.0);

    let format = ParallaxFormat { encoding: Encoding::Float, depth: Depth::Float32 };
    let mut codes = vec![2.0 * 77.0 / 255.0 - 1.0; 16 * 8];
    codes[77] = f32::NAN;
    let map = ParallaxMap::new(heights.size(), format, Codes::F32(codes)).unwrap();
    assert_eq!(truth.parallax_errors(&Texture::of_parallax(&map, Edges::default())).largest, f64::INFINITY);
}
