//! Height maps into parallax maps: n_z (2h - 1).

use super::{assert_parallax, image};
use crate::support::{
    FLOAT32, SNORM8, UNORM8, assert_every_parallax_with_normals, map_f32, map_u8, map_u16, normal_map, parallax_options,
};
use texbake::{Depth, Encoding, NormalFormat, ParallaxFormat};

const fn format(encoding: Encoding, depth: Depth) -> ParallaxFormat {
    ParallaxFormat { encoding, depth }
}

const P_SNORM8: ParallaxFormat = format(Encoding::Snorm, Depth::Bits8);
const P_SNORM16: ParallaxFormat = format(Encoding::Snorm, Depth::Bits16);
const P_UNORM8: ParallaxFormat = format(Encoding::Unorm, Depth::Bits8);
const P_BIASED8: ParallaxFormat = format(Encoding::Biased, Depth::Bits8);
const P_FLOAT16: ParallaxFormat = format(Encoding::Float, Depth::Float16);
const P_FLOAT32: ParallaxFormat = format(Encoding::Float, Depth::Float32);

#[test]
fn parallax_of_a_flat_end() {
    let map = map_u8(2, 1, |x, _| [0, 255][x]);
    for (format, least, greatest) in [
        (P_SNORM8, -127.0, 127.0),
        (P_SNORM16, -32_767.0, 32_767.0),
        (P_UNORM8, 0.0, 255.0),
        (P_BIASED8, 1.0, 255.0),
        (P_FLOAT32, -1.0, 1.0),
    ] {
        // Two texels that wrap have no slope.
        assert_parallax(&map, &parallax_options("16777215", format), &[least, greatest]);
    }
}

/// No code is 1/2: 127 and 128 are -1/255 and 1/255, half a code of 127 and a little less.
#[test]
fn parallax_of_the_middle_height() {
    let eight = map_u8(2, 1, |x, _| [127, 128][x]);
    assert_parallax(&eight, &parallax_options("1", P_SNORM8), &[0.0, 0.0]);
    assert_parallax(&eight, &parallax_options("1", P_UNORM8), &[127.0, 128.0]);
    assert_parallax(&eight, &parallax_options("1", P_SNORM16), &[-128.0, 128.0]);
    assert_parallax(&eight, &parallax_options("1", P_FLOAT32), &[-1.0 / 255.0, 1.0 / 255.0]);
    let sixteen = map_u16(2, 1, |x, _| [32_767, 32_768][x]);
    assert_parallax(&sixteen, &parallax_options("1", P_SNORM16), &[0.0, 0.0]);
    // A float's is: to the sign of zero, and half-way between two codes of unorm.
    let float = map_f32(2, 1, |_, _| 0.5);
    assert_parallax(&float, &parallax_options("1", P_FLOAT32), &[0.0, 0.0]);
    assert_parallax(&float, &parallax_options("1", P_UNORM8), &[128.0, 128.0]);
}

#[test]
fn parallax_of_heights_beyond_0_and_1() {
    // Two by two that wrap: no slope.
    let map = map_f32(2, 2, |x, y| [-3.0, 7.0, f32::MIN, f32::MAX][2 * y + x]);
    for (format, least) in [(P_SNORM8, -127.0), (P_FLOAT32, -1.0)] {
        assert_parallax(&map, &parallax_options("1", format), &[least, -least, least, -least]);
    }
}

/// s = 1e6: n_z is 2e-6, so heights of 0 and 1 are -+0.066 of a 16-bit code.
#[test]
fn parallax_under_a_million_full_step() {
    let map = map_u8(4, 1, |x, _| if x < 2 { 0 } else { 255 });
    assert_parallax(&map, &parallax_options("1e6", P_SNORM16), &[0.0; 4]);
    assert_parallax(&map, &parallax_options("1e6", P_UNORM8), &[127.0, 127.0, 128.0, 128.0]);
    assert_parallax(&map, &parallax_options("1e6", P_FLOAT32), &[-2e-6, -2e-6, 2e-6, 2e-6]);
    let least = 34.0 / 16_777_216.0;
    assert_parallax(&map, &parallax_options("1e6", P_FLOAT16), &[-least, -least, least, least]);
}

/// With z above zero n_z (2h - 1) is a tie where n_z (2H - 255) is even: 2/3 of 255 and of -255, 4/5 of 255.
#[test]
fn parallax_ties() {
    for (normal, height, code) in [([2, 1, 2], 255, 213.0), ([2, 1, 2], 0, 43.0), ([3, 0, 4], 255, 230.0)] {
        let normals = normal_map(1, 1, SNORM8, &normal);
        let expected = |format: ParallaxFormat| image(normals.size(), format, &[code]);
        assert_every_parallax_with_normals(&map_u8(1, 1, |_, _| height), &normals, &expected(P_UNORM8));
    }
}

fn assert_with_normal(format: NormalFormat, texel: [u32; 3], expected: f64) {
    let normals = normal_map(1, 1, format, &texel);
    let map = map_u8(1, 1, |_, _| 255);
    assert_every_parallax_with_normals(&map, &normals, &image(normals.size(), P_SNORM8, &[expected]));
}

#[test]
fn parallax_with_z_at_or_below_zero() {
    for z in [0, 0x80, 0x81, 0xff] {
        // z counts as 1 of 127: beside x = 127, 1/127.004 of 127 is 0.99996.
        assert_with_normal(SNORM8, [127, 0, z], 1.0);
        assert_with_normal(SNORM8, [0, 0, z], 127.0);
    }
    // 2^-24 beside 1 is nothing.
    for z in [0.0f32, -0.0, -1.0] {
        assert_with_normal(FLOAT32, [1f32.to_bits(), 0, z.to_bits()], 0.0);
        assert_with_normal(FLOAT32, [0, 0, z.to_bits()], 127.0);
    }
    assert_with_normal(UNORM8, [128, 128, 0], 127.0);
}
