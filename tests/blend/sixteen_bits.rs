//! 16-bit maps: random, ties from Pythagorean quadruples, and values so near to a code's boundary that f64 misrounds.

use super::{assert_right, every_method};
use crate::oracle::{UnormZero, blend};
use crate::support::{
    BIASED16, FLOAT16, FLOAT32, FORMATS, Image, Random, SNORM8, SNORM16, Subject, UNORM8, UNORM16, assert_every_blend,
    blend_options, convergent, dx, every_baker, factor_and_centre, landmarks, map_of_texels, normal_map, pair,
    random_codes, rounded_by_f64, weighted, xy,
};
use half::f16;
use std::collections::BTreeSet;
use texbake::{BlendMethod, Depth, Encoding, NormalFormat, NormalMap, Rational};

const FORMATS16: [NormalFormat; 3] = [UNORM16, SNORM16, BIASED16];

#[test]
fn random_maps_by_every_method() {
    let mut random = Random::new(0x16);
    for (i, method) in every_method().into_iter().enumerate() {
        for (j, first) in FORMATS16.into_iter().enumerate() {
            let second = FORMATS16[(i + j) % 3];
            let formats = if i % 2 == 0 { [first, dx(second)] } else { [xy(first), second] };
            let [base, detail] = formats.map(|format| random_codes(&mut random, 83, 53, format));
            // The oracle of floats is slow.
            for format in [UNORM16, [SNORM16, BIASED16][j % 2]] {
                assert_right(&pair(&base, &detail), method, format);
            }
            let [base, detail] = formats.map(|format| random_codes(&mut random, 31, 17, format));
            assert_right(&pair(&base, &detail), method, [FLOAT32, FLOAT16][i % 2]);
        }
    }
}

/// The greatest products: components of 65535, weights of 65535.
#[test]
fn the_steepest_slopes_and_the_greatest_weights() {
    let extremes = |format: NormalFormat, turn: usize| {
        let [least, zero, greatest] = landmarks(format);
        let codes = [least, zero, greatest, greatest - 1, least + 1, zero + 1, zero.wrapping_sub(1) & 0xffff];
        map_of_texels(49, 49, format, |x, y| {
            let at = if turn == 0 { [x % 7, x / 7, (x + y) % 7] } else { [y % 7, y / 7, (x + 3 * y) % 7] };
            at.map(|i| codes[i])
        })
    };
    for first in FORMATS16 {
        for second in [UNORM16, SNORM16] {
            let [base, detail] = [extremes(first, 0), extremes(second, 1)];
            for (a, b) in [("65535", "65535"), ("-65535", "65534"), ("1/65535", "-65534/65535"), ("1", "1/65535")] {
                for format in [UNORM16, SNORM16, FLOAT32] {
                    assert_right(&pair(&base, &detail), weighted(a, b), format);
                }
            }
            for method in [BlendMethod::Linear, BlendMethod::Overlay, BlendMethod::Whiteout, BlendMethod::Rnm] {
                assert_right(&pair(&base, &detail), method, UNORM16);
            }
        }
    }
}

/// All (a, b, c), c > 0, with a^2 + b^2 + c^2 = d^2 such that 65535 a / d is an integer: half of these are codes' ties.
fn quadruples() -> BTreeSet<[i64; 3]> {
    let mut found = BTreeSet::new();
    for d in (1..=257i64).filter(|d| 65_535 % d == 0) {
        for a in 0..d {
            for b in 0..=(d * d - a * a).isqrt() {
                let square = d * d - a * a - b * b;
                let c = square.isqrt();
                if c > 0 && c * c == square {
                    found.extend([[a, b, c], [-a, b, c], [a, -b, c], [b, -a, c]]);
                }
            }
        }
    }
    found
}

/// Two maps whose slopes with the weights 3/2 and -2 add up to a quadruple's.
///
/// Over a common z = 2 k c the components need 3/2 x1 - 2 x2 = 2 k a: x1 = 4 m and x2 = 3 m - k a for any m.
fn maps_of_quadruples(random: &mut Random, format: NormalFormat, quadruples: &[[i64; 3]]) -> [NormalMap; 2] {
    let texels: Vec<[[i64; 3]; 2]> = quadruples
        .iter()
        .map(|&[a, b, c]| {
            let k = 1 + random.below(30) as i64;
            let [m, n] = [0; 2].map(|_| random.any_magnitude(2_000));
            [[4 * m, 4 * n, 2 * k * c], [3 * m - k * a, 3 * n - k * b, 2 * k * c]]
        })
        .collect();
    let [_, zero, _] = landmarks(format);
    [0, 1].map(|map| {
        let code = |component: i64| (zero as i64 + component) as u32 & 0xffff;
        let bits: Vec<u32> = texels.iter().flat_map(|texel| texel[map].map(code)).collect();
        normal_map(quadruples.len(), 1, format, &bits)
    })
}

#[test]
fn pythagorean_ties() {
    let mut random = Random::new(0x717e);
    let quadruples: Vec<_> = quadruples().into_iter().collect();
    assert!(quadruples.contains(&[2, 1, 2]) && quadruples.contains(&[3, 0, 4]) && quadruples.len() > 1000);
    for inputs in [SNORM16, BIASED16] {
        let [base, detail] = maps_of_quadruples(&mut random, inputs, &quadruples);
        for format in FORMATS {
            let options = blend_options(weighted("3/2", "-2"), format);
            let expected = blend(&pair(&base, &detail), &options, UnormZero::Zero);
            // Ties are unorm's alone; a third of all codes there, counting those of zero.
            let ties = expected.ties;
            assert_eq!(ties > 0, format.encoding == Encoding::Unorm, "{format:?}: {ties} ties");
            assert_every_blend(&pair(&base, &detail), &options, &expected.image);
        }
    }
}

/// (2, 1, 2)/3 is 127.5 (v + 1) = 212.5, 170, 212.5, and 32767.5 (v + 1) = 54612.5, 43690, 54612.5.
#[test]
fn a_tie_that_is_known() {
    // Over z = 200: 100 + 100, 30 + 70, and z1 z2; the same with unorm's odd components over 65535.
    let signed = [normal_map(1, 1, SNORM16, &[100, 30, 200]), normal_map(1, 1, SNORM16, &[100, 70, 200])];
    let odd = |x: u32, y: u32, z: u32| normal_map(1, 1, UNORM16, &[x, y, z].map(|u| (65_535 + u) / 2));
    // (2, 1, 2)/3 turned to z = 1: slopes 2 and 2.
    let unorm = [odd(1_999, 1_991, 1_001), odd(3, 11, 1_001)];
    for Subject { name, baker } in every_baker() {
        let texel = |maps: &[NormalMap; 2], format| {
            let options = blend_options(BlendMethod::add(), dx(format));
            let maps = maps.clone().map(|map| {
                let format = dx(map.format());
                normal_map(1, 1, format, &Image::from(&map).bits)
            });
            Image::from(&baker.blend(&pair(&maps[0], &maps[1]), &options).expect("a blend")).texel(0, 0)
        };
        assert_eq!(texel(&signed, UNORM8), [213.0, 170.0, 213.0], "{name}");
        assert_eq!(texel(&signed, UNORM16), [54_613.0, 43_690.0, 54_613.0], "{name}");
        // 127.5 (2/3 + 1) = 212.5 twice, and 127.5 (1/3 + 1) = 170.
        assert_eq!(texel(&unorm, UNORM8), [213.0, 213.0, 170.0], "{name}");
    }
}

/// Slopes whose x lies in the middle between two codes as nearly as any detail map allows.
#[test]
fn texels_next_to_a_boundary() {
    const TRIES: usize = 300_000;
    const KEPT: usize = 3_000;
    let mut random = Random::new(0xb10b);
    for format in [UNORM8, UNORM16, SNORM8, SNORM16] {
        let mut near: Vec<(f64, [[i64; 3]; 2])> = Vec::new();
        for _ in 0..TRIES {
            let [x1, y1, y2] = [0; 3].map(|_| random.any_magnitude(20_000));
            let [z1, z2] = [0; 2].map(|_| 2_000 + random.below(30_000) as i64);
            let y = y1 as f64 / z1 as f64 + y2 as f64 / z2 as f64;
            let v = middle(&mut random, format);
            let wanted = (v * v * (1.0 + y * y) / (1.0 - v * v)).sqrt();
            let x2 = (wanted - x1 as f64 / z1 as f64) * z2 as f64;
            if x2.abs() <= 32_767.0 {
                near.push(((x2 - x2.round()).abs() / z2 as f64, [[x1, y1, z1], [x2.round() as i64, y2, z2]]));
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.truncate(KEPT);
        assert!(near.len() == KEPT && near[0].0 < 1e-8, "nearest slope {:e}", near[0].0);
        let [base, detail] = [0, 1].map(|map| {
            let code = |component: i64| (32_768 + component) as u32;
            let bits: Vec<u32> = near.iter().flat_map(|(_, texel)| texel[map].map(code)).collect();
            normal_map(KEPT / 30, 30, BIASED16, &bits)
        });
        assert_right(&pair(&base, &detail), BlendMethod::add(), format);
        assert_right(&pair(&base, &detail), BlendMethod::add(), dx(format));
    }
}

/// A component in the middle between two codes or floats, often near 1, where it changes least with the slope.
fn middle(random: &mut Random, format: NormalFormat) -> f64 {
    let between = |a: f64, b: f64| (a + b) / 2.0;
    let mut from_top = |count: i64| random.any_magnitude(count - 1).abs();
    match format.depth {
        Depth::Float16 => {
            // From 2^-6 to 1.
            let bits = (0x3c00 - from_top(6 << 10) - 1) as u16;
            between(f16::from_bits(bits).to_f64(), f16::from_bits(bits + 1).to_f64())
        }
        Depth::Float32 => {
            let bits = (0x3f80_0000 - from_top(6 << 23) - 1) as u32;
            between(f32::from_bits(bits).into(), f32::from_bits(bits + 1).into())
        }
        Depth::Bits8 | Depth::Bits16 => {
            let (factor, centre) = factor_and_centre(format);
            (factor.floor() - 1.0 - from_top(factor as i64) as f64 + 0.5 + centre.fract()) / factor
        }
    }
}

/// One texel of each map, and the weight p/q of both, that all but meet the middle between two codes.
struct Near {
    /// Of the component from the middle, as a share of it.
    distance: f64,
    texels: [[i64; 3]; 2],
    weight: (i64, i64),
    is_z: bool,
}

fn nearest_weights(random: &mut Random, format: NormalFormat) -> Vec<Near> {
    const TRIES: usize = 2_000_000;
    const KEPT: usize = 25;
    let mut near: Vec<Near> = Vec::new();
    let mut farthest = f64::INFINITY;
    for _ in 0..TRIES {
        let texels = [0; 2].map(|_| {
            let [x, y] = [0; 2].map(|_| random.any_magnitude(32_767));
            [x, y, 1 + random.below(32_767) as i64]
        });
        let sum = [0, 1].map(|axis| texels.iter().map(|texel| texel[axis] as f64 / texel[2] as f64).sum::<f64>());
        let (square, v, is_z) = (sum[0] * sum[0] + sum[1] * sum[1], middle(random, format), random.below(2) == 0);
        // w with x/length = v, or 1/length = v, for the slopes w (x, y).
        let wanted = if is_z { (1.0 / (v * v) - 1.0) / square } else { v * v / (sum[0] * sum[0] - v * v * square) };
        let wanted = wanted.sqrt();
        if !(1e-3..1e3).contains(&wanted) {
            continue;
        }
        let weight = convergent(wanted, 65_535);
        // The component's change beside the weight's: 1 - v^2 for v = z, z^2 for v = x.
        let change = if is_z { 1.0 - v * v } else { 1.0 / (1.0 + wanted * wanted * square) };
        let distance = (weight.0 as f64 / weight.1 as f64 / wanted - 1.0).abs() * change;
        if distance < farthest {
            near.push(Near { distance, texels, weight, is_z });
            if near.len() >= 4 * KEPT {
                near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
                near.truncate(KEPT);
                farthest = near[KEPT - 1].distance;
            }
        }
    }
    near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    near.truncate(KEPT);
    near
}

/// A weight of two parts of 16 bits comes within 2^-32 of any number, and the best of millions within the error of f64.
#[test]
fn weights_nearest_to_a_boundary() {
    let mut random = Random::new(0x5ca1e);
    for format in [UNORM16, SNORM16, FLOAT16, FLOAT32] {
        let mut misrounded_by_f64 = 0;
        for Near { texels, weight: (p, q), is_z, .. } in nearest_weights(&mut random, format) {
            let maps = texels.map(|texel| normal_map(1, 1, dx(SNORM16), &texel.map(|part| part as u32 & 0xffff)));
            for p in [p, -p] {
                let weight = Rational::new(p, q).expect("a ratio");
                let options = blend_options(BlendMethod::Weighted { base: weight, detail: weight }, dx(format));
                let inputs = pair(&maps[0], &maps[1]);
                let exact = blend(&inputs, &options, UnormZero::Zero).image;
                assert_every_blend(&inputs, &options, &exact);
                let w = p as f64 / q as f64;
                let slope =
                    |axis: usize| texels.iter().map(|texel| texel[axis] as f64 / texel[2] as f64).sum::<f64>() * w;
                let (x, y) = (slope(0), slope(1));
                let length = (x * x + y * y + 1.0).sqrt();
                let (v, channel) = if is_z { (1.0 / length, 2) } else { (x / length, 0) };
                misrounded_by_f64 += usize::from(exact.number(channel) != rounded_by_f64(v, format));
            }
        }
        assert!(misrounded_by_f64 > 0, "{format:?}: f64 would do");
    }
}
