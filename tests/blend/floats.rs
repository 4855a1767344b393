//! Float maps, and float maps beside integer ones: the same bytes as f32 in the documented order.

use super::every_method;
use crate::oracle::float_blend;
use crate::support::{
    BIASED16, FLOAT16, FLOAT32, Random, SNORM8, UNORM8, UNORM16, assert_every_blend, blend_options, dx, map_u8,
    map_u16, normal_map, pair, random_codes, weighted, xy,
};
use half::f16;
use texbake::{BlendInputs, BlendMethod, Channels, Depth, NormalFormat, NormalMap};

const WIDTH: usize = 64;
const HEIGHT: usize = 42;

const INPUTS: [[NormalFormat; 2]; 8] = [
    [FLOAT32, FLOAT32],
    [FLOAT32, dx(FLOAT32)],
    [FLOAT16, FLOAT32],
    [xy(FLOAT16), dx(FLOAT16)],
    [dx(xy(FLOAT32)), FLOAT16],
    [UNORM8, FLOAT32],
    [xy(FLOAT32), xy(dx(BIASED16))],
    [dx(FLOAT16), SNORM8],
];

const OUTPUTS: [NormalFormat; 6] = [FLOAT32, UNORM8, FLOAT32, FLOAT16, dx(UNORM16), xy(BIASED16)];

/// Stripes of everything that components up to 65536 can do.
fn hard_normals(random: &mut Random, format: NormalFormat) -> NormalMap {
    if !format.depth.is_float() {
        return random_codes(random, WIDTH, HEIGHT, format);
    }
    let greatest = 65_536.0;
    let stripes: [fn(&mut Random) -> [f32; 3]; 7] = [
        // Unit normals, as maps hold.
        |random| {
            let [x, y] = [0; 2].map(|_| random.any_magnitude(1 << 20) as f32 / (1 << 16) as f32);
            let length = (x * x + y * y + 1.0).sqrt();
            [x / length, y / length, 1.0 / length]
        },
        // Nearly unit, and below.
        |random| [0; 3].map(|_| random.any_magnitude(1 << 24) as f32 / (1 << 24) as f32),
        // Of any length, z of either sign.
        |random| [0; 3].map(|_| random.any_magnitude(1 << 40) as f32 / (1 << 24) as f32),
        // Any bits.
        |random| [0; 3].map(|_| random.finite()),
        // Zeros of either sign, subnormals, and both limits below which components count as zero.
        |random| {
            let values = [0.0, -0.0, 1e-45, -1e-40, f32::MIN_POSITIVE, 2f32.powi(-25), -2f32.powi(-24), 1.0, 2.9e-8];
            [0; 3].map(|_| values[random.below(9) as usize])
        },
        |random| {
            let values = [65_536.0, -65_536.0, 65_504.0, 1.0, -1.0, 0.5, 2f32.powi(-26), 2f32.powi(-14)];
            [0; 3].map(|_| values[random.below(8) as usize])
        },
        // Flat, and almost.
        |random| {
            [random.any_magnitude(7) as f32 * 2f32.powi(-24), random.any_magnitude(3) as f32 * 2f32.powi(-13), 1.0]
        },
    ];
    let mut bits = Vec::new();
    for y in 0..HEIGHT {
        for _ in 0..WIDTH {
            let components = stripes[y / 6](random).map(|part: f32| part.clamp(-greatest, greatest));
            bits.extend(components.iter().take(format.channels.count()).map(|&part| match format.depth {
                // The greatest half is 65504.
                Depth::Float16 => f16::from_f32(part.clamp(-65_504.0, 65_504.0)).to_bits().into(),
                _ => part.to_bits(),
            }));
        }
    }
    normal_map(WIDTH, HEIGHT, format, &bits)
}

#[test]
fn every_method_in_the_documented_order() {
    let mut random = Random::new(0xf10a);
    for (i, formats) in INPUTS.into_iter().enumerate() {
        let [base, detail] = formats.map(|format| hard_normals(&mut random, format));
        // Each method with two mixes: a device compiles a kernel for each.
        for j in [i, (i + 3) % 8] {
            let options = blend_options(every_method()[j], OUTPUTS[(i + j) % OUTPUTS.len()]);
            let inputs = pair(&base, &detail);
            assert_every_blend(&inputs, &options, &float_blend(&inputs, &options));
        }
    }
}

#[test]
fn every_output_format() {
    let mut random = Random::new(0x0f0f);
    let [base, detail] = [FLOAT32, FLOAT16].map(|format| hard_normals(&mut random, format));
    let inputs = pair(&base, &detail);
    for format in crate::support::FORMATS.into_iter().flat_map(|format| [format, xy(format)]) {
        let options = blend_options(BlendMethod::add(), format);
        assert_every_blend(&inputs, &options, &float_blend(&inputs, &options));
    }
}

#[test]
fn weights_of_any_size() {
    let mut random = Random::new(0xf16);
    for formats in [[FLOAT32, FLOAT32], [FLOAT16, UNORM16]] {
        let [base, detail] = formats.map(|format| hard_normals(&mut random, format));
        for (a, b) in [
            ("0", "0"),
            ("1", "-1"),
            ("65535", "65535"),
            ("-65535", "1/1"),
            ("1/65535", "-1/65535"),
            ("65535/65534", "-1/65534"),
            ("0", "-3"),
            ("0.35", "7/3"),
        ] {
            let options = blend_options(weighted(a, b), FLOAT32);
            for inputs in [pair(&base, &detail), pair(&base, &base)] {
                assert_every_blend(&inputs, &options, &float_blend(&inputs, &options));
            }
        }
    }
}

#[test]
fn masks() {
    let mut random = Random::new(0xf3a5);
    let bytes = map_u8(WIDTH, HEIGHT, |x, y| (x * 4 + y) as u8);
    let words = map_u16(WIDTH, HEIGHT, |x, y| (x * 1040 + 300 * y) as u16);
    for formats in [[FLOAT32, FLOAT32], [UNORM8, FLOAT16]] {
        let [base, detail] = formats.map(|format| hard_normals(&mut random, format));
        for (mask, format) in [(&bytes, UNORM8), (&words, FLOAT32)] {
            let options = blend_options(BlendMethod::Masked, format);
            let inputs = BlendInputs { mask: Some(mask), ..pair(&base, &detail) };
            assert_every_blend(&inputs, &options, &float_blend(&inputs, &options));
        }
    }
}

/// Two channels of floats too: z is the root of what is left, or 2^-24.
#[test]
fn known_floats() {
    // x = 0.6, y = 0: z = 0.8 in f32; added to itself the slope is 3/2: (3, 0, 2)/sqrt(13).
    let map = normal_map(1, 1, xy(FLOAT32), &[0.6f32.to_bits(), 0]);
    assert_eq!(map.format().channels, Channels::Xy);
    for crate::support::Subject { name, baker } in crate::support::every_baker() {
        let blended = baker.blend(&pair(&map, &map), &blend_options(BlendMethod::add(), FLOAT32)).expect("a blend");
        let texel = crate::support::Image::from(&blended).texel(0, 0);
        for (got, exact) in texel.iter().zip([3.0 / 13f64.sqrt(), 0.0, 2.0 / 13f64.sqrt()]) {
            // z is off by 3 u of 0.64 / 2 z, the sum's parts by two roundings each, the unit vector's by 4.5 u.
            assert!((got - exact).abs() < 12.0 * 2f64.powi(-24), "{name}: {texel:?}");
        }
    }
}
