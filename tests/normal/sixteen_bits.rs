//! 16-bit heights: there are 2^34 pairs of differences, so the worst are searched for.

use crate::oracle;
use crate::support::{
    FILTERS, FLOAT16, FLOAT32, FORMATS, Random, SNORM16, UNORM8, UNORM16, assert_every_baker, convergent,
    factor_and_centre, greatest_sum, map_of_pairs, map_u16, options, rounded_by_f64,
};
use half::f16;
use std::collections::BTreeSet;
use texbake::{Convention, Depth, Filter, HeightMap, NormalFormat, NormalOptions, Rational, Scale};

/// Scales at both ends of what is allowed, and between.
const SCALES: [&str; 9] =
    ["24", "7/3", "0.35", "-1000.5", "1e6", "16777215", "16777215/16777213", "1/16777215", "1e-3"];

fn assert_right(map: &HeightMap, options: &NormalOptions) {
    assert_every_baker(map, options, &oracle::image(map, options));
}

#[test]
fn random_heights() {
    let mut random = Random::new(0x16b1_75ed);
    // Full range, which is steep everywhere, beside heights that differ by few codes.
    let map = map_u16(127, 71, |x, _| if x < 64 { random.bits() as u16 } else { 40_000 + random.below(60) as u16 });
    for format in FORMATS {
        for filter in FILTERS {
            // The oracle of floats is slow: one scale of each kind is enough for them.
            let scales = if format.depth.is_float() { &SCALES[5..8] } else { &SCALES[..] };
            for scale in scales {
                assert_right(&map, &NormalOptions { filter, ..options(scale, format) });
            }
        }
    }
}

#[test]
fn normals_that_nearly_point_up_as_floats() {
    // z is next to 1, where floats are twice as dense below as above.
    let mut random = Random::new(0x6e_471e);
    let map = map_u16(97, 41, |_, _| 30_000 + random.below(300) as u16);
    for format in [FLOAT16, FLOAT32] {
        for scale in ["24", "0.35", "-1"] {
            assert_right(&map, &options(scale, format));
        }
    }
}

#[test]
fn the_steepest_and_the_flattest_slopes() {
    // Scharr with the greatest parts: X reaches 2^24 2^21, Z 2^24 2^5 2^16; products come to 123 bits.
    let stripes = map_u16(64, 64, |x, y| match (x / 2 + y / 2) % 4 {
        0 | 1 => 65535,
        2 => 0,
        _ => (x * y) as u16,
    });
    for filter in FILTERS {
        for scale in ["16777215", "-16777215", "16777215/16777214", "1/16777215", "-1/16777213"] {
            for format in FORMATS {
                assert_right(&stripes, &NormalOptions { filter, ..options(scale, format) });
            }
        }
    }
}

/// D of DESIGN 3.1, and the factor that keeps stencil sums even where the filter can make no others.
fn divisor(filter: Filter) -> (i64, i64) {
    match filter {
        Filter::Central => (2, 1),
        Filter::Sobel => (8, 2),
        Filter::Scharr => (32, 2),
        Filter::Prewitt => (6, 2),
    }
}

/// All (a, b) with a^2 + b^2 + c^2 = d^2 such that 65535 a / d is an integer: many of its halves are codes' ties.
fn quadruples(c: i64) -> BTreeSet<[i64; 2]> {
    let mut found = BTreeSet::new();
    for d in (1..=771i64).filter(|d| 65535 % d == 0) {
        for a in 0..d {
            for b in 0..=(d * d - a * a).isqrt() {
                let square = d * d - a * a - b * b;
                let z = square.isqrt();
                if z > 0 && z * z == square && c % z == 0 && a.max(b) * (c / z) < 30_000 {
                    found.extend([[a, b], [b, a]].map(|pair| pair.map(|part| part * (c / z))));
                }
            }
        }
    }
    found
}

fn all_signs([a, b]: [i64; 2]) -> [[i64; 2]; 4] {
    [[a, b], [-a, b], [a, -b], [-a, -b]]
}

#[test]
fn pythagorean_ties() {
    for filter in FILTERS {
        let (d, even) = divisor(filter);
        for c in [2, 4, 60, 1020, 2040] {
            // p = D M: then X : Y : Z = -Gx : -Gy : q, and q = c.
            let scale = Scale::texels(Rational::new(d * 65535, even * c).expect("a ratio"));
            let pairs: Vec<_> =
                quadruples(c).into_iter().flat_map(all_signs).map(|pair| pair.map(|g| even * g)).collect();
            let map = map_of_pairs(filter, &pairs);
            for format in FORMATS {
                let options = NormalOptions { scale, filter, format, ..Default::default() };
                assert_right(&map, &options);
                let dx = NormalFormat { convention: Convention::Dx, ..format };
                assert_right(&map, &NormalOptions { format: dx, ..options });
            }
        }
    }
}

#[test]
fn two_quadruples_that_are_known() {
    // (2, 1, 2) / 3: 127.5 (v + 1) = 212.5, 170, 212.5; (3, 0, 4) / 5: 204, 127.5, 229.5.
    for (pair, c, expected) in [([-2, 1], 2, [213.0, 170.0, 213.0]), ([-3, 0], 4, [204.0, 128.0, 230.0])] {
        let map = map_of_pairs(Filter::Central, &[pair]);
        let options = NormalOptions {
            scale: Scale::texels(Rational::new(131_070, c).expect("a ratio")),
            format: UNORM8,
            ..Default::default()
        };
        assert_right(&map, &options);
        assert_eq!(oracle::image(&map, &options).texel(1, 1), expected, "{pair:?}");
    }
}

/// Where the middle between two codes is nearly met.
struct Near {
    pair: [i64; 2],
    /// Distance from the middle, in codes.
    distance: f64,
}

/// The slope that makes a component `v` where the other slope is `other`, and how fast the component changes with it.
fn slope_for(component: usize, v: f64, other: f64) -> Option<(f64, f64)> {
    let rest = 1.0 + other * other;
    let (slope_squared, is_z) = match component {
        2 => (1.0 / (v * v) - rest, true),
        _ => (v * v * rest / (1.0 - v * v), false),
    };
    let slope = Some(slope_squared.sqrt()).filter(|slope| *slope > 0.0)?;
    Some((slope, if is_z { slope } else { rest } / (rest + slope_squared).powf(1.5)))
}

/// Pairs of sums whose x, y or z lies nearest to the middle between two codes.
///
/// v = t / m is such a middle; the sum that would meet it is solved for, and the integers beside it are kept if they
/// come near. `rise` is the slope of a sum of one.
fn near_boundaries(random: &mut Random, rise: f64, format: NormalFormat, greatest_sum: i64, step: i64) -> Vec<Near> {
    const TRIES: usize = 200_000;
    const KEPT: usize = 700;
    let m = match format.encoding.greatest_code(format.depth).expect("integer codes") {
        l if format == UNORM8 || format == UNORM16 => i64::from(l),
        l => 2 * i64::from(l),
    };
    let mut kept = Vec::new();
    for component in 0..3 {
        let mut near = Vec::new();
        for _ in 0..TRIES {
            let t = 1 + random.below(m as u64 - 1) as i64;
            // Middles are every second t: 2k - 1 - L for unorm with odd L, 2k - 1 for snorm.
            let t = if m % 2 == 1 { t & !1 } else { t | 1 };
            let v = t as f64 / m as f64;
            let other = random.any_magnitude(greatest_sum / step) * step;
            let other_slope = other as f64 * rise;
            let Some((slope, change)) = slope_for(component, v, other_slope) else { continue };
            let wanted = slope / rise;
            let sum = (wanted / step as f64).round() * step as f64;
            if sum > greatest_sum as f64 {
                continue;
            }
            let distance = (sum - wanted).abs() * rise * change * m as f64 / 2.0;
            let sum = if random.bits() & 1 == 0 { sum as i64 } else { -(sum as i64) };
            let pair = if component == 1 { [other, sum] } else { [sum, other] };
            near.push(Near { pair, distance });
        }
        near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        kept.extend(near.into_iter().take(KEPT));
    }
    kept
}

#[test]
fn pairs_nearest_to_a_boundary() {
    let mut random = Random::new(0xb0da);
    let integer_formats = FORMATS.iter().filter(|format| !format.depth.is_float());
    for &format in integer_formats {
        for (filter, scale) in [
            (Filter::Central, "24"),
            (Filter::Central, "7/3"),
            (Filter::Central, "16777215/16777213"),
            (Filter::Central, "1000"),
            (Filter::Sobel, "24"),
            (Filter::Scharr, "16777215/16777213"),
            (Filter::Scharr, "100"),
            (Filter::Prewitt, "0.35"),
        ] {
            let (d, step) = divisor(filter);
            let options = NormalOptions { filter, ..options(scale, format) };
            let Scale::Texels(s) = options.scale else { unreachable!("the scale is in texels") };
            let rise = s.numerator() as f64 / (s.denominator() as f64 * d as f64 * 65535.0);
            let near = near_boundaries(&mut random, rise, format, greatest_sum(filter), step);
            let nearest = near.iter().map(|near| near.distance).fold(f64::INFINITY, f64::min);
            assert!(near.len() > 1000 && nearest < 1e-5, "{}: nearest {nearest:e} codes", near.len());
            let pairs: Vec<_> = near.iter().map(|near| near.pair).collect();
            assert_right(&map_of_pairs(filter, &pairs), &options);
        }
    }
}

/// A component in the middle between two codes or floats.
fn middle(random: &mut Random, format: NormalFormat) -> f64 {
    let between = |a: f64, b: f64| (a + b) / 2.0;
    match format.depth {
        Depth::Float16 => {
            // From 2^-6 to 1.
            let bits = (0x3c00 - random.below(6 << 10) - 1) as u16;
            between(f16::from_bits(bits).to_f64(), f16::from_bits(bits + 1).to_f64())
        }
        Depth::Float32 => {
            let bits = (0x3f80_0000 - random.below(6 << 23) - 1) as u32;
            between(f32::from_bits(bits).into(), f32::from_bits(bits + 1).into())
        }
        Depth::Bits8 | Depth::Bits16 => {
            let (factor, centre) = factor_and_centre(format);
            (random.below(factor as u64) as f64 + 0.5 + centre.fract()) / factor
        }
    }
}

/// The scale s that makes x (or z) of the normal of a pair of slopes over s the given component; NaN if none does.
fn scale_for(v: f64, [a, b]: [f64; 2], is_z: bool) -> f64 {
    let square = a * a + b * b;
    let scale_squared = if is_z { (1.0 / (v * v) - 1.0) / square } else { v * v / (a * a - v * v * square) };
    scale_squared.sqrt()
}

/// A pair of sums and a scale p/q in lowest terms that all but meet the middle between two codes.
fn pair_and_scale(random: &mut Random, format: NormalFormat, filter: Filter) -> ([i64; 2], (i64, i64)) {
    const TRIES: usize = 30;
    let (d, step) = divisor(filter);
    let tries = (0..TRIES).filter_map(|_| {
        let pair = [0; 2].map(|_| random.any_magnitude(greatest_sum(filter) / step) * step);
        let slopes = pair.map(|sum| sum as f64 / (d as f64 * 65535.0));
        let scale = scale_for(middle(random, format), slopes, random.below(2) == 0);
        let (p, q) = convergent(Some(scale).filter(|scale| (1e-3..1e6).contains(scale))?, (1 << 24) - 1);
        let distance = (p as f64 / q as f64 / scale - 1.0).abs();
        Some((distance, pair, (p, q)))
    });
    let (_, pair, scale) = tries.min_by(|a, b| a.0.total_cmp(&b.0)).expect("some scale is in range");
    (pair, scale)
}

/// A scale of two parts of 24 bits comes within 2^-47 of any number, and the best of some within the error of f64.
#[test]
fn scales_nearest_to_a_boundary() {
    let mut random = Random::new(0x5ca1e);
    for format in [UNORM16, SNORM16, FLOAT16, FLOAT32] {
        let mut misrounded_by_f64 = 0;
        for filter in FILTERS {
            let (d, _) = divisor(filter);
            for _ in 0..40 {
                let (pair, (p, q)) = pair_and_scale(&mut random, format, filter);
                for (p, pair) in [(p, pair), (-p, [-pair[0], pair[1]])] {
                    let scale = Scale::texels(Rational::new(p, q).expect("a ratio"));
                    let options = NormalOptions { scale, filter, format, ..Default::default() };
                    let map = map_of_pairs(filter, &[pair]);
                    let exact = oracle::image(&map, &options);
                    assert_every_baker(&map, &options, &exact);
                    let [dx, dy] = pair.map(|sum| p as f64 * sum as f64 / (q as f64 * d as f64 * 65535.0));
                    let inverse = 1.0 / (dx * dx + dy * dy + 1.0).sqrt();
                    let naive = [-dx, dy, 1.0].map(|part| rounded_by_f64(part * inverse, format));
                    misrounded_by_f64 += usize::from(naive[..] != exact.texel(1, 1)[..]);
                }
            }
        }
        println!("{misrounded_by_f64} of 320 normals are misrounded by f64, {format:?}");
        assert!(misrounded_by_f64 > 0, "f64 gets all of these right: no scale is near enough");
    }
}

/// That these cases can tell right from nearly right: rounding in floats fails on them.
#[test]
fn rounding_in_floats_fails_on_the_ties() {
    let pairs: Vec<_> = quadruples(1020).into_iter().flat_map(all_signs).collect();
    let map = map_of_pairs(Filter::Central, &pairs);
    let scale = Scale::texels(Rational::new(131_070, 1020).expect("a ratio"));
    for (format, greatest) in [(UNORM8, 255.0), (UNORM16, 65535.0)] {
        let options = NormalOptions { scale, format, ..Default::default() };
        let exact = oracle::image(&map, &options);
        let sums = oracle::slope_sums(&map, options.filter, options.edges);
        let naive = |v: f64| (greatest * (0.5 * v + 0.5) + 0.5).floor();
        let wrong = sums.iter().enumerate().filter(|&(texel, &[gx, gy])| {
            let [dx, dy] = [gx, gy].map(|g| g as f64 / 1020.0);
            let inverse = 1.0 / (dx * dx + dy * dy + 1.0).sqrt();
            [-dx, dy, 1.0]
                .iter()
                .enumerate()
                .any(|(channel, part)| naive(part * inverse) != exact.number(3 * texel + channel))
        });
        assert!(wrong.count() > 0, "{format:?}");
    }
}

#[test]
fn float_outputs_are_the_nearest_floats() {
    let mut random = Random::new(0xf10a7);
    let map = map_u16(101, 61, |x, y| match (x / 10 + y / 10) % 3 {
        0 => random.bits() as u16,
        1 => 30_000 + random.below(5) as u16,
        _ => random.any_magnitude(32_767).unsigned_abs() as u16,
    });
    for format in [FLOAT16, FLOAT32] {
        for scale in SCALES {
            assert_right(&map, &options(scale, format));
        }
    }
}
