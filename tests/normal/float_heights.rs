//! Float heights: the same bytes from every baker, and within a derived bound of the real normal.
//!
//! The bound, with u = 2^-24 and the order of operations of `src/ops/normal/reference.rs`:
//!
//! - A slope is a sum of three weighted differences times a constant. On its way each difference meets six roundings:
//!   itself, the sum of the outer two, the product with its weight, the sum with the middle one, the constant (rounded
//!   to f32), the product with it. Powers of two round nothing. So the slope is off by at most
//!   gamma_6 (sum of |weighted differences|), where gamma_n = n u / (1 - n u) (Higham, Accuracy and Stability of
//!   Numerical Algorithms, section 3.1). Below 2^-25 it becomes 0, which adds 2^-25; the parts of subnormal heights
//!   that a division by 64 cuts off come to less than 2^-110.
//! - Unit vectors a/|a| and b/|b| differ by at most 2 |a - b| / (|a| + |b|) (Dunkl and Williams, 1964).
//! - Of the length's square, x^2 meets three roundings (square, two sums), so the square is off by gamma_3 of itself;
//!   its root by half of that and one rounding more, the reciprocal by another, the product with a component by
//!   another: 4.5 u of a component that is at most 1, and 2^-149 where a result is subnormal.
//! - f16 adds half a unit in the last place, at most 2^-11 of the value or 2^-25.
//! - A code v (m/2) + (c + 1)/2 meets one rounding of the product, at most u m/2, one of the sum, at most
//!   u (greatest code + 1), and the floor makes half a code of it.

use crate::oracle::{RealNormal, real_normals};
use crate::support::{
    FILTERS, FLOAT16, FLOAT32, FORMATS, Image, Random, Subject, assert_every_baker, every_baker, every_edges, map_f32,
    options,
};
use texbake::{Channels, Convention, Depth, Encoding, HeightMap, NormalFormat, NormalOptions};

const U: f64 = 1.0 / (1 << 24) as f64;

/// Six roundings, second-order terms, and those of the oracle's own f64.
const GAMMA_6: f64 = 6.001 * U;

/// How far an f32 component may be from the real one.
fn component_bound(real: &RealNormal) -> f64 {
    let slope_error = real.magnitude.map(|magnitude| GAMMA_6 * magnitude + 1.001 * 2f64.powi(-25) + 2f64.powi(-110));
    let moved = slope_error[0].hypot(slope_error[1]);
    let baked_length = (real.length - moved).max(1.0);
    let turned = (2.0 * moved / (real.length + baked_length)).min(2.0);
    turned + 4.501 * U + 2f64.powi(-149)
}

/// How far the number that stores the component `v` may be from `v` as a real number of codes.
fn code_bound(format: NormalFormat, v: f64, component_bound: f64) -> f64 {
    match format.depth {
        Depth::Float32 => component_bound,
        Depth::Float16 => component_bound + ((v.abs() + component_bound) * 2f64.powi(-11)).max(2f64.powi(-25)),
        Depth::Bits8 | Depth::Bits16 => {
            let (half, greatest) = half_and_greatest(format);
            half * component_bound + U * (half + greatest + 1.0) + 0.5
        }
    }
}

/// m/2 and the greatest code.
fn half_and_greatest(format: NormalFormat) -> (f64, f64) {
    let greatest = f64::from(format.encoding.greatest_code(format.depth).expect("integer codes"));
    if format.encoding == Encoding::Unorm { (greatest / 2.0, greatest) } else { (greatest, greatest) }
}

/// The component `v` as a real number of codes.
fn in_codes(format: NormalFormat, v: f64) -> f64 {
    match format.encoding {
        Encoding::Float => v,
        Encoding::Snorm => half_and_greatest(format).0 * v,
        Encoding::Unorm => half_and_greatest(format).0 * (v + 1.0),
        Encoding::Biased => half_and_greatest(format).0 * (v + 1.0) + 1.0,
    }
}

/// Fails if a code is farther from the real normal than the bound.
pub fn assert_within_bound(map: &HeightMap, options: &NormalOptions, baked: &Image) {
    let reals = real_normals(map, options);
    let channels = options.format.channels.count();
    assert_eq!(baked.bits.len(), reals.len() * channels, "{options:?}");
    for (texel, real) in reals.iter().enumerate() {
        let component_bound = component_bound(real);
        for (channel, &v) in real.normal[..channels].iter().enumerate() {
            let got = baked.number(texel * channels + channel);
            let error = (got - in_codes(options.format, v)).abs();
            let bound = code_bound(options.format, v, component_bound);
            let (x, y) = (texel % map.size().width(), texel / map.size().width());
            // A NaN is above every bound.
            assert!(
                error <= bound,
                "({x}, {y}) channel {channel}: got {got} for {v}, {error:e} > {bound:e}, {options:?}"
            );
        }
    }
}

const WIDTH: usize = 192;
const STRIPE: usize = 9;

/// Stripes of everything that finite floats can do.
fn hard_heights() -> HeightMap {
    let mut random = Random::new(0xf32);
    let stripes: [fn(usize, usize, &mut Random) -> f32; 16] = [
        // Subnormals: a ramp, and any.
        |x, y, _| f32::from_bits((x + 7 * y) as u32),
        |_, _, random| f32::from_bits(random.below(1 << 23) as u32 | (random.bits() as u32 & (1 << 31))),
        // The greatest, side by side and in pairs.
        |x, y, _| if (x + y) % 2 == 0 { f32::MAX } else { f32::MIN },
        |x, y, _| if (x / 2 + y / 2) % 2 == 0 { f32::MAX } else { f32::MIN },
        |x, _, _| if x % 3 == 0 { f32::MAX } else { 0.0 },
        // Huge ramps.
        |x, y, _| 1e30 * (x as f32 + 0.25 * y as f32),
        |x, y, _| -1e38 * (x % 4) as f32 + 1e36 * y as f32,
        // Both zeros.
        |x, y, _| if (x * y) % 3 == 0 { -0.0 } else { 0.0 },
        // Anything finite, and anything within a range of exponents.
        |_, _, random| random.finite(),
        |_, _, random| f32::from_bits(((127 - 30) << 23) + random.below(60 << 23) as u32),
        |_, _, random| f32::from_bits(((127 - 4) << 23) + random.below(8 << 23) as u32),
        // What height maps hold: [0, 1], metres, codes of 8 bits.
        |_, _, random| random.below(1 << 24) as f32 / (1 << 24) as f32,
        |x, y, random| 8848.0 + 0.1 * (x as f32 - y as f32) + random.below(100) as f32 * 0.001,
        |_, _, random| random.below(256) as f32 / 255.0,
        // Neighbours one unit in the last place apart, about where slopes snap to zero.
        |x, y, _| f32::from_bits(1f32.to_bits() + ((x * x + y) % 3) as u32),
        |x, y, _| 2f32.powi(-26) * ((x * y) % 7) as f32 * (1.0 + x as f32 * 2f32.powi(-9)),
    ];
    map_f32(WIDTH, STRIPE * stripes.len(), |x, y| stripes[y / STRIPE](x, y, &mut random))
}

const SCALES: [&str; 8] = ["1", "24", "0.35", "-7/3", "16777215", "1/16777215", "1e-6", "0"];

#[test]
fn every_baker_gives_the_reference_bytes_within_the_bound() {
    let map = hard_heights();
    for filter in FILTERS {
        for format in FORMATS {
            for scale in SCALES {
                let options = NormalOptions { filter, ..options(scale, format) };
                let reference = Image::from(&every_baker()[0].baker.normal(&map, &options).expect("a bake"));
                assert_within_bound(&map, &options, &reference);
                assert_every_baker(&map, &options, &reference);
            }
        }
    }
}

#[test]
fn every_edge_channel_and_convention_gives_the_reference_bytes() {
    let map = hard_heights();
    for edges in every_edges() {
        for (channels, convention) in [(Channels::Xy, Convention::Dx), (Channels::Xyz, Convention::Dx)] {
            let format = NormalFormat { channels, convention, ..FLOAT32 };
            let options = NormalOptions { edges, ..options("24", format) };
            let reference = Image::from(&every_baker()[0].baker.normal(&map, &options).expect("a bake"));
            assert_within_bound(&map, &options, &reference);
            assert_every_baker(&map, &options, &reference);
        }
    }
}

/// 1/64 of the subnormals is rounded, and the greatest scale makes nothing of them.
#[test]
fn slopes_below_2_to_the_minus_25_are_flat() {
    let step = 2f32.powi(-26);
    for Subject { name, baker } in every_baker() {
        // A central difference of 2^-25 is a slope of 2^-26, one of 2^-24 a slope of 2^-25.
        for (rise, expected) in [(step, 0.0), (2.0 * step, -f64::from(2.0 * step))] {
            let map = map_f32(8, 4, |x, _| x as f32 * rise);
            let baked = Image::from(&baker.normal(&map, &options("1", FLOAT32)).expect("a bake"));
            assert_eq!(baked.texel(3, 1), [expected, 0.0, 1.0], "{name}, {rise:e}");
        }
    }
}

#[test]
fn flat_maps_are_exactly_flat() {
    let flat_codes = [
        [0x80, 0x80, 0xff],
        [0x8000, 0x8000, 0xffff],
        [0, 0, 0x7f],
        [0, 0, 0x7fff],
        [0x80, 0x80, 0xff],
        [0x8000, 0x8000, 0xffff],
        [0, 0, 0x3c00],
        [0, 0, 0x3f80_0000],
    ];
    let heights = [0.0, -0.0, 1.0, -1.0, 0.1, 1e-45, -1e-40, f32::MIN_POSITIVE, 8848.86, 1e30, f32::MAX, f32::MIN];
    for height in heights {
        let map = map_f32(37, 5, |_, _| height);
        for (format, flat) in FORMATS.into_iter().zip(flat_codes) {
            for scale in ["1", "-16777215", "1/16777215"] {
                let expected = Image { size: map.size(), format, bits: flat.repeat(map.size().texels()) };
                assert_every_baker(&map, &options(scale, format), &expected);
            }
        }
    }
}

/// The bound can fail: a code that is off by one, or a float by a few units in the last place.
#[test]
fn the_bound_catches_a_wrong_code() {
    let map = map_f32(16, 16, |x, y| ((x * 5 + y * 3) % 7) as f32 / 7.0);
    for (format, wrong) in [(FORMATS[0], 1), (FORMATS[1], 1), (FLOAT32, 40), (FLOAT16, 2)] {
        let options = options("1", format);
        let mut baked = Image::from(&every_baker()[0].baker.normal(&map, &options).expect("a bake"));
        assert_within_bound(&map, &options, &baked);
        baked.bits[3 * 17] += wrong;
        let caught = std::panic::catch_unwind(|| assert_within_bound(&map, &options, &baked));
        assert!(caught.is_err(), "{format:?}");
    }
}

/// Integer codes as floats: the same slopes, so nearly the same normals, whatever the depth.
#[test]
fn float_heights_agree_with_integer_heights() {
    let mut random = Random::new(5);
    let codes: Vec<u16> = (0..64 * 64).map(|_| random.bits() as u16).collect();
    let floats = map_f32(64, 64, |x, y| f32::from(codes[64 * y + x]) / 65535.0);
    let integers = crate::support::map_u16(64, 64, |x, y| codes[64 * y + x]);
    for Subject { name, baker } in every_baker() {
        let [from_floats, from_integers] =
            [&floats, &integers].map(|map| Image::from(&baker.normal(map, &options("3", FLOAT32)).expect("a bake")));
        for i in 0..from_floats.bits.len() {
            // Heights in [0, 1] are rounded to 2^-25, slopes to 3 (2^-25 + 6 u), the normal no more than the slopes.
            let error = (from_floats.number(i) - from_integers.number(i)).abs();
            assert!(error <= 2.0 * 3.0 * (0.5 * U + 6.0 * U) + 5.0 * U, "{name}: code {i} is off by {error:e}");
        }
    }
}
