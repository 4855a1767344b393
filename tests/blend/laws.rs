//! The law that defines a blend, and what follows from it.
//!
//! The law: the blend of the normal maps of two height maps, with weights a and b, is the normal map of a h1 + b h2.
//!
//! **Codes.** A component v is read from its nearest code as u/L. Unorm: |L (v + 1)/2 - c| <= 1/2, so |u - L v| <= 1
//! with u = 2c - L, and <= 2 where the code of zero, for u = 1, is read as 0. Snorm and biased: |u - L v| <= 1/2. Call
//! the error of x or y e, and that of z f. A slope s = x/z is then read as s' = x'/z' with
//! |s' - s| = |x' z - x z'| / (z' z) = |(x' - x) z - x (z' - z)| / (z' z) <= (e + |s| f) / (z - f).
//! The blend adds a s1' + b s2' in real arithmetic, so each slope of the result is off by
//! |a| E1 + |b| E2 at most, and a normal moves no farther than its slopes (closed_forms.rs). Both results are rounded to
//! half a code (unorm: L/2 codes a unit; snorm: L), so they differ by a whole one more.
//!
//! **Floats**, u = 2^-24, with heights whose weighted sums and differences are exact. The slope of a normal map is its
//! sum times a rounded constant (2 roundings) and then x/z of the unit vector: both meet their product with the same
//! reciprocal (1 each), 4 in all. In the blend each term meets 2 products and a sum, and Z two products: 9 in all, of
//! |a s1| + |b s2|. The summed map's slope meets 2. Components of either unit vector are off by 4.5 u more
//! (float_heights.rs).

use super::assert_right;
use crate::oracle::{UnormZero, components, float_blend, renormalised};
use crate::support::{
    BIASED16, FLOAT16, FLOAT32, INTEGER_FORMATS, Image, Random, SNORM8, SNORM16, Subject, UNORM8, UNORM16,
    assert_every_blend, assert_same, blend_options, dx, every_baker, flat_map, map_f32, map_of_texels, map_u8, map_u16,
    normal_map, options, pair, random_codes, weighted, xy,
};
use texbake::{BlendMethod, BlendOptions, Encoding, HeightMap, NormalFormat, NormalMap, Rational};

const SIDE: usize = 40;
const U: f64 = 1.0 / (1 << 24) as f64;

/// Four times the weights of two maps.
const WEIGHTS: [[i32; 2]; 6] = [[4, 4], [4, -4], [-4, 8], [1, 3], [8, -2], [-4, -12]];

fn quarters([a, b]: [i32; 2]) -> BlendMethod {
    let quarter = |weight: i32| Rational::new(weight.into(), 4).expect("a ratio");
    BlendMethod::Weighted { base: quarter(a), detail: quarter(b) }
}

/// Two height maps in quarters of a unit, and their weighted sum.
struct Sum {
    quarters: [Vec<i32>; 2],
    weights: [i32; 2],
}

impl Sum {
    fn new(weights: [i32; 2]) -> Self {
        let mut random = Random::new(0x1a35);
        let quarters = [0; 2].map(|_| (0..SIDE * SIDE).map(|_| random.any_magnitude(1_000) as i32).collect());
        Self { quarters, weights }
    }

    /// The heights h1, h2 and a h1 + b h2: at most 16000 in magnitude.
    fn heights(&self) -> [Vec<i32>; 3] {
        let [h1, h2] = &self.quarters;
        let [a, b] = self.weights;
        let whole = |quarters: &[i32]| quarters.iter().map(|h| 4 * h).collect();
        [whole(h1), whole(h2), h1.iter().zip(h2).map(|(h1, h2)| a * h1 + b * h2).collect()]
    }

    /// The slopes of all texels of the three, where one height is a slope of `rise` over one texel.
    fn slopes(&self, rise: f64) -> [Vec<[f64; 2]>; 3] {
        self.heights().map(|heights| {
            let at = |x: usize, y: usize| f64::from(heights[y % SIDE * SIDE + x % SIDE]);
            let slope = |i: usize| {
                let (x, y) = (i % SIDE, i / SIDE);
                [at(x + 1, y) - at(x + SIDE - 1, y), at(x, y + 1) - at(x, y + SIDE - 1)].map(|d| d * rise / 2.0)
            };
            (0..SIDE * SIDE).map(slope).collect()
        })
    }

    /// How far the components of each texel may move, if each slope of the inputs and of the sum is off by `errors` of
    /// its own normal's slopes.
    fn bounds(&self, rise: f64, errors: [&dyn Fn([f64; 2]) -> [f64; 2]; 3]) -> Vec<f64> {
        let [s1, s2, sum] = self.slopes(rise);
        let [a, b] = self.weights.map(|weight| f64::from(weight.abs()) / 4.0);
        let bound = |i: usize| {
            let [e1, e2, e3] = [errors[0](s1[i]), errors[1](s2[i]), errors[2](sum[i])];
            let moved = [0, 1].map(|axis| a * e1[axis] + b * e2[axis] + e3[axis]);
            let (moved, length) = (moved[0].hypot(moved[1]), length(sum[i]));
            // Dunkl and Williams, as in float_heights.rs.
            2.0 * moved / (length + (length - moved).max(1.0))
        };
        (0..SIDE * SIDE).map(bound).collect()
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y + 1.0).sqrt()
}

/// How far off the slopes are that a format's codes of a normal are read as.
fn reading_error(format: NormalFormat, slope: [f64; 2]) -> [f64; 2] {
    let l = f64::from(format.encoding.greatest_code(format.depth).expect("integer codes"));
    let [e, f] = if format.encoding == Encoding::Unorm { [2.0 / l, 1.0 / l] } else { [0.5 / l, 0.5 / l] };
    let z = 1.0 / length(slope);
    assert!(z > 2.0 * f, "too steep for a bound");
    slope.map(|s| (e + s.abs() * f) / (z - f))
}

/// The largest of all differences beside its bound.
fn worst(got: &Image, expected: &Image, bounds: &[f64]) -> f64 {
    let channels = got.format.channels.count();
    let share = |i: usize| (got.number(i) - expected.number(i)).abs() / bounds[i / channels];
    (0..got.bits.len()).map(share).fold(0.0, f64::max)
}

#[test]
fn codes_blend_as_their_heights_add() {
    for [base, detail, result] in [
        [UNORM8, UNORM8, UNORM8],
        [UNORM16, UNORM16, UNORM16],
        [SNORM8, dx(SNORM8), UNORM8],
        [SNORM16, BIASED16, SNORM16],
        [dx(UNORM16), SNORM16, dx(UNORM16)],
        [UNORM16, UNORM8, UNORM8],
    ] {
        for (scale, s) in [("10", 10.0), ("100", 100.0)] {
            for weights in WEIGHTS {
                let sum = Sum::new(weights);
                let maps = sum.heights().map(|h| map_u16(SIDE, SIDE, |x, y| (20_000 + h[SIDE * y + x]) as u16));
                let l = f64::from(result.encoding.greatest_code(result.depth).expect("integer codes"));
                let codes = if result.encoding == Encoding::Unorm { l / 2.0 } else { l };
                let errors = [base, detail].map(|format| move |slope| reading_error(format, slope));
                let moved = sum.bounds(s / 65_535.0, [&errors[0], &errors[1], &|_| [0.0; 2]]);
                let bounds: Vec<f64> = moved.iter().map(|moved| codes * moved + 1.0 + 1e-6).collect();
                // A bound that says something, at the gentler scale.
                let with_8_bits = base.depth.bytes() == 1 || detail.depth.bytes() == 1;
                let mean = moved.iter().sum::<f64>() / moved.len() as f64;
                assert!(s > 10.0 || mean < if with_8_bits { 0.08 } else { 3e-4 }, "a mean bound of {mean}");
                for Subject { name, baker } in every_baker() {
                    let bake = |map, format| baker.normal(map, &options(scale, format)).expect("a bake");
                    let [m1, m2] = [bake(&maps[0], base), bake(&maps[1], detail)];
                    let blended = |method| {
                        let blended = baker.blend(&pair(&m1, &m2), &blend_options(method, result));
                        Image::from(&blended.expect("a blend"))
                    };
                    let expected = Image::from(&bake(&maps[2], result));
                    let share = worst(&blended(quarters(weights)), &expected, &bounds);
                    assert!(
                        share <= 1.0,
                        "{name}, {base:?}, {detail:?}, {result:?}, {weights:?}: {share} of the bound"
                    );
                    // Adding vectors is no sum of heights.
                    if *name != "reference" {
                        continue;
                    }
                    let linear = worst(&blended(BlendMethod::Linear), &expected, &bounds);
                    assert!(with_8_bits || linear > 10.0, "{name}: linear is within {linear} of the bound");
                }
            }
        }
    }
}

#[test]
fn floats_blend_as_their_heights_add() {
    for (scale, s) in [("1", 1.0), ("7/3", 7.0 / 3.0), ("40", 40.0)] {
        for weights in WEIGHTS {
            let sum = Sum::new(weights);
            // Heights and weighted sums are multiples of 2^-11 below 8: exact.
            let maps = sum.heights().map(|h| map_f32(SIDE, SIDE, |x, y| h[SIDE * y + x] as f32 * 2f32.powi(-11)));
            let of_inputs = |slope: [f64; 2]| slope.map(|s| 9.01 * U * s.abs());
            let of_sum = |slope: [f64; 2]| slope.map(|s| 2.01 * U * s.abs());
            let bounds = sum.bounds(s * 2f64.powi(-11), [&of_inputs, &of_inputs, &of_sum]);
            let bounds: Vec<f64> = bounds.iter().map(|bound| bound + 9.01 * U).collect();
            for Subject { name, baker } in every_baker() {
                let maps = maps.each_ref().map(|map| baker.normal(map, &options(scale, FLOAT32)).expect("a bake"));
                let blended = baker.blend(&pair(&maps[0], &maps[1]), &blend_options(quarters(weights), FLOAT32));
                let (blended, expected) = (Image::from(&blended.expect("a blend")), Image::from(&maps[2]));
                let share = worst(&blended, &expected, &bounds);
                assert!(share <= 1.0, "{name}, scale {scale}, {weights:?}: {share} of the bound");
                // The bound can fail: a share of 2^-17 of the steepest slope.
                let turned = weighted("1.00001", "1");
                let turned = float_blend(&pair(&maps[0], &maps[1]), &blend_options(turned, FLOAT32));
                assert!(weights != [4, 4] || worst(&turned, &expected, &bounds) > 1.0, "{name}, scale {scale}");
            }
        }
    }
}

/// Methods that take a flat detail map for nothing.
fn methods_that_keep_the_base() -> [BlendMethod; 5] {
    [BlendMethod::add(), weighted("1", "-5/3"), BlendMethod::Udn, BlendMethod::Whiteout, BlendMethod::Rnm]
}

#[test]
fn a_flat_map_changes_nothing() {
    let mut random = Random::new(0xf1a7);
    let flats = [UNORM8, dx(xy(SNORM16))].map(|format| flat_map(43, 19, format));
    for (i, format) in INTEGER_FORMATS.into_iter().enumerate() {
        let result = [UNORM8, SNORM16, UNORM16][i % 3];
        for (j, format) in [format, xy(format), dx(format)].into_iter().enumerate() {
            let map = random_codes(&mut random, 43, 19, format);
            let (flat, expected) = (&flats[(i + j) % 2], renormalised(&map, result));
            for inputs in [pair(&map, flat), pair(flat, &map)] {
                assert_every_blend(&inputs, &blend_options(BlendMethod::add(), result), &expected);
            }
        }
    }
    for format in [UNORM8, UNORM16, SNORM16] {
        let (map, flat) = (random_codes(&mut random, 43, 19, format), flat_map(43, 19, format));
        let expected = renormalised(&map, UNORM8);
        for method in methods_that_keep_the_base() {
            assert_every_blend(&pair(&map, &flat), &blend_options(method, UNORM8), &expected);
        }
        assert_every_blend(&pair(&flat, &map), &blend_options(BlendMethod::Rnm, UNORM8), &expected);
    }
}

/// Unit normals are rounded by less than a code, and so are their lengths: |u - L v| is at most 1 of 2 (unorm) or 1/2 of
/// 1 (snorm) in each component, sqrt 3 times that in length, and the code of zero's 2 are far from the length.
#[test]
fn a_baked_map_and_a_flat_one_differ_by_one_code_at_most() {
    let mut random = Random::new(0xba4e);
    let heights = map_u16(64, 64, |x, _| if x < 32 { random.bits() as u16 } else { random.below(3_000) as u16 });
    for Subject { name, baker } in every_baker() {
        for format in INTEGER_FORMATS {
            let map = baker.normal(&heights, &options("8", format)).expect("a bake");
            let options = blend_options(BlendMethod::add(), format);
            let blended = Image::from(&baker.blend(&pair(&map, &flat_map(64, 64, format)), &options).expect("a blend"));
            let own = Image::from(&map);
            let most = (0..own.bits.len()).map(|i| (blended.number(i) - own.number(i)).abs()).fold(0.0, f64::max);
            assert!(most <= 1.0, "{name}, {format:?}: {most} codes");
            let flat_texels = own.bits.iter().zip(&blended.bits).filter(|(own, blended)| own == blended).count();
            assert!(flat_texels > own.bits.len() / 2, "{name}, {format:?}: only {flat_texels} are the same");
        }
    }
}

#[test]
fn a_flat_map_only_renormalises_floats() {
    let mut random = Random::new(0xf1);
    let heights = map_u16(64, 64, |_, _| random.bits() as u16);
    for Subject { name, baker } in every_baker() {
        let map = baker.normal(&heights, &options("3", FLOAT32)).expect("a bake");
        let own = Image::from(&map);
        // (x, y, z) over its length in the documented order, as f32 gives it.
        let unit = |texel: &[u32]| {
            let [x, y, z] = [0, 1, 2].map(|i| f32::from_bits(texel[i]));
            let inverse = 1.0 / ((x * x + y * y) + z * z).sqrt();
            [x, y, z].map(|part| (part * inverse).to_bits())
        };
        let bits: Vec<u32> = own.bits.chunks(3).flat_map(unit).collect();
        let expected = Image { bits, ..own.clone() };
        for flat in [flat_map(64, 64, FLOAT32), flat_map(64, 64, FLOAT16), flat_map(64, 64, UNORM8)] {
            for method in [BlendMethod::add(), weighted("1", "7")] {
                let blended = Image::from(&baker.blend(&pair(&map, &flat), &blend_options(method, FLOAT32)).unwrap());
                assert_same(format_args!("{name}, {:?}", flat.format()), &blended, &expected);
            }
        }
        let most = (0..own.bits.len()).map(|i| (own.number(i) - expected.number(i)).abs()).fold(0.0, f64::max);
        // A component of unit length is off by 4.5 u, and so is its next one.
        assert!(most <= 9.0 * U, "{name}: {most:e}");
    }
}

#[test]
fn symmetric_methods_commute() {
    let mut random = Random::new(0xc0);
    let methods = [
        [BlendMethod::add(); 2],
        [weighted("3", "-2/7"), weighted("-2/7", "3")],
        [weighted("0.9", "0.1"), weighted("0.1", "0.9")],
        [BlendMethod::Linear; 2],
        [BlendMethod::Whiteout; 2],
    ];
    for formats in [[UNORM8, UNORM8], [dx(SNORM16), UNORM8]] {
        let [m1, m2] = formats.map(|format| random_codes(&mut random, 41, 23, format));
        for Subject { name, baker } in every_baker() {
            for [method, swapped] in methods {
                let first = baker.blend(&pair(&m1, &m2), &blend_options(method, UNORM16)).expect("a blend");
                let second = baker.blend(&pair(&m2, &m1), &blend_options(swapped, UNORM16)).expect("a blend");
                let what = format!("{name}, {formats:?}, {method:?}");
                assert_same(what, &Image::from(&first), &Image::from(&second));
            }
        }
    }
}

/// Slopes 1 and 0 along x: what the second map is matters.
#[test]
fn the_other_methods_do_not_commute() {
    let steep = normal_map(1, 1, SNORM8, &[90, 0, 90]);
    let leaning = normal_map(1, 1, SNORM8, &[(-50i32 as u32) & 0xff, 0, 117]);
    for Subject { name, baker } in every_baker() {
        for (method, expected) in [
            // (40, 0, 90) and (40, 0, 117), times 127 over their lengths 98.49 and 123.65.
            (BlendMethod::Udn, [[52.0, 0.0, 116.0], [41.0, 0.0, 120.0]]),
            // Over 127^2 = 16129: (90 127 - 50 37, 0, 90 127 + 117 37) = (9580, 0, 15759) and
            // (-50 127 + 90 77, 0, 117 127 + 90 10) = (580, 0, 15759).
            (BlendMethod::Overlay, [[66.0, 0.0, 109.0], [5.0, 0.0, 127.0]]),
        ] {
            let blend = |base, detail| {
                let blended = baker.blend(&pair(base, detail), &blend_options(method, SNORM8)).expect("a blend");
                Image::from(&blended).texel(0, 0)
            };
            assert_eq!([blend(&steep, &leaning), blend(&leaning, &steep)], expected, "{name}, {method:?}");
        }
        // Rotations about one axis commute: two axes are needed.
        let up = normal_map(1, 1, SNORM8, &[0, 90, 90]);
        let rnm = |base, detail| {
            let blended = baker.blend(&pair(base, detail), &blend_options(BlendMethod::Rnm, SNORM8)).expect("a blend");
            Image::from(&blended).texel(0, 0)
        };
        // (1, 0, 1)/sqrt(2) turns (0, 1, 1)/sqrt(2) to (1/2, sqrt(1/2), 1/2), here with vectors of length 90 sqrt(2).
        assert_eq!(rnm(&steep, &up), [64.0, 90.0, 64.0], "{name}");
        assert_eq!(rnm(&up, &steep), [90.0, 64.0, 64.0], "{name}");
    }
}

#[test]
fn a_transition_ends_in_each_map() {
    let mut random = Random::new(0xe4d5);
    let transition = |t: i32| BlendMethod::transition(t.into()).expect("between 0 and 1");
    for formats in [[UNORM8, SNORM16], [xy(UNORM16), dx(UNORM8)], [dx(SNORM8), xy(BIASED16)]] {
        let [m1, m2] = formats.map(|format| random_codes(&mut random, 41, 23, format));
        for format in [SNORM16, FLOAT32] {
            for (t, weights, map) in [(0, weighted("1", "0"), &m1), (1, weighted("0", "1"), &m2)] {
                let expected = renormalised(map, format);
                assert_every_blend(&pair(&m1, &m2), &blend_options(transition(t), format), &expected);
                assert_every_blend(&pair(&m1, &m2), &blend_options(weights, format), &expected);
            }
        }
    }
    let refused = [("-1/7", "transition is -1/7"), ("1.01", "transition is 1.01")];
    for (t, start) in refused {
        let error = BlendMethod::transition(crate::support::number(t)).expect_err("out of range").to_string();
        assert_eq!(error, format!("{start}: it must be between 0 and 1"));
    }
}

/// A map repeated by hand.
fn repeated(map: &NormalMap, width: usize, height: usize) -> NormalMap {
    let image = Image::from(map);
    let channels = map.format().channels.count();
    let at = |x: usize, y: usize| {
        let first = (y % image.size.height() * image.size.width() + x % image.size.width()) * channels;
        [0, 1, 2].map(|channel| if channel < channels { image.bits[first + channel] } else { 0 })
    };
    map_of_texels(width, height, map.format(), at)
}

#[test]
fn a_tiled_map_is_the_map_repeated() {
    let mut random = Random::new(0x711e);
    let base = random_codes(&mut random, 53, 37, UNORM8);
    for format in [UNORM8, xy(SNORM16)] {
        // Whole tiles, parts of tiles, one row, one column, one texel, and larger than the base.
        for (width, height) in [(53, 37), (7, 5), (53, 1), (1, 37), (1, 1), (60, 11), (19, 50), (64, 64)] {
            let tile = random_codes(&mut random, width, height, format);
            let by_hand = repeated(&tile, 53, 37);
            for Subject { name, baker } in every_baker() {
                let tiled = BlendOptions { tile: true, ..blend_options(BlendMethod::add(), UNORM16) };
                let got = Image::from(&baker.blend(&pair(&base, &tile), &tiled).expect("a blend"));
                let untiled = blend_options(BlendMethod::add(), UNORM16);
                let expected = Image::from(&baker.blend(&pair(&base, &by_hand), &untiled).expect("a blend"));
                assert_same(format_args!("{name}, {width} x {height}"), &got, &expected);
            }
            assert_right(&pair(&base, &by_hand), BlendMethod::add(), UNORM8);
        }
    }
    // The oracle's own repetition, and a mask over a tiled map.
    let tile = random_codes(&mut random, 6, 4, SNORM8);
    let mask = map_u8(53, 37, |x, y| (5 * x + 3 * y) as u8);
    let inputs = texbake::BlendInputs { mask: Some(&mask), ..pair(&base, &tile) };
    let options = BlendOptions { tile: true, ..blend_options(BlendMethod::Masked, UNORM8) };
    assert_every_blend(&inputs, &options, &crate::oracle::blend(&inputs, &options, UnormZero::Zero).image);
}

/// The component that unorm reads as zero is the only one that is not 2c - L.
#[test]
fn two_slopes_along_one_axis_stay_along_it() {
    let ramp = |step: usize| map_u16(16, 16, move |x, _| (step * x) as u16);
    let maps: [HeightMap; 2] = [ramp(1_000), ramp(2_000)];
    for Subject { name, baker } in every_baker() {
        let [m1, m2] = maps.each_ref().map(|map| baker.normal(map, &options("30", UNORM8)).expect("a bake"));
        let blended = baker.blend(&pair(&m1, &m2), &blend_options(BlendMethod::add(), UNORM8)).expect("a blend");
        let (y, l) = components(&blended, UnormZero::Zero);
        assert!(y.chunks(3).all(|texel| texel[1] == 0) && l == 255, "{name}");
    }
}
