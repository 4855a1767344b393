//! A transition for each texel.

use super::assert_right;
use crate::oracle::{UnormZero, blend};
use crate::support::{
    BIASED16, FLOAT32, Image, Random, SNORM8, SNORM16, Subject, UNORM8, UNORM16, assert_every_blend, assert_same,
    blend_options, dx, every_baker, map_f32, map_u8, map_u16, normal_map, pair, random_codes, xy,
};
use texbake::{BlendInputs, BlendMethod, HeightMap, NormalFormat, NormalMap, Rational};

const INPUTS: [[NormalFormat; 2]; 4] =
    [[UNORM8, UNORM8], [SNORM8, xy(dx(UNORM8))], [UNORM16, BIASED16], [xy(SNORM16), UNORM8]];

fn masked<'a>(maps: &'a [NormalMap; 2], mask: &'a HeightMap) -> BlendInputs<&'a NormalMap, &'a HeightMap> {
    BlendInputs { mask: Some(mask), ..pair(&maps[0], &maps[1]) }
}

/// Each row holds one pair of texels under all 256 codes.
#[test]
fn every_code_of_an_8_bit_mask() {
    let mut random = Random::new(256);
    let mask = map_u8(256, 40, |x, _| x as u8);
    for formats in INPUTS {
        let maps = formats.map(|format| repeated_columns(&random_codes(&mut random, 1, 40, format), 256));
        for format in [UNORM8, UNORM16, SNORM16] {
            assert_right(&masked(&maps, &mask), BlendMethod::Masked, format);
        }
    }
}

/// A map of one column, side by side with itself.
fn repeated_columns(column: &NormalMap, times: usize) -> NormalMap {
    let rows = Image::from(column).bits;
    let repeated: Vec<u32> =
        rows.chunks(column.format().channels.count()).flat_map(|texel| texel.repeat(times)).collect();
    normal_map(times, column.size().height(), column.format(), &repeated)
}

#[test]
fn masks_of_16_bits_and_floats() {
    let mut random = Random::new(65_536);
    for formats in INPUTS {
        let maps = formats.map(|format| random_codes(&mut random, 97, 61, format));
        let ends = [0, 1, 32_767, 32_768, 65_534, 65_535];
        let words = map_u16(97, 61, |x, _| if x < 6 { ends[x] } else { random.bits() as u16 });
        // Below 0 and above 1, at the middle between two codes, and anywhere.
        let ends = [-1.0, -0.0, 1.5, f32::MAX, 1e-45, 0.5 / 65_535.0, 1.0 / 65_535.0, 1.0];
        let floats = map_f32(97, 61, |x, _| if x < 8 { ends[x] } else { random.below(1 << 24) as f32 / 16_777_216.0 });
        for mask in [&words, &floats] {
            for format in [UNORM8, SNORM16, UNORM16] {
                assert_right(&masked(&maps, mask), BlendMethod::Masked, format);
            }
        }
    }
}

/// A mask of one code is the transition of that code, of floats too.
#[test]
fn an_even_mask_is_a_transition() {
    let mut random = Random::new(42);
    let maps = [UNORM8, xy(SNORM16)].map(|format| random_codes(&mut random, 37, 29, format));
    let floats = maps.clone().map(|map| as_floats(&map));
    for (mask, t) in [
        (map_u8(37, 29, |_, _| 0), (0, 1)),
        (map_u8(37, 29, |_, _| 51), (51, 255)),
        (map_u8(37, 29, |_, _| 254), (254, 255)),
        (map_u16(37, 29, |_, _| 1), (1, 65_535)),
        (map_u16(37, 29, |_, _| 32_768), (32_768, 65_535)),
        (map_u16(37, 29, |_, _| 65_535), (1, 1)),
        (map_f32(37, 29, |_, _| 0.2), (13_107, 65_535)),
    ] {
        let transition = BlendMethod::transition(Rational::new(t.0, t.1).expect("a ratio")).expect("between 0 and 1");
        for Subject { name, baker } in every_baker() {
            let blended = |maps: &[NormalMap; 2], mask, method, format| {
                let inputs = BlendInputs { mask, ..pair(&maps[0], &maps[1]) };
                Image::from(&baker.blend(&inputs, &blend_options(method, format)).expect("a blend"))
            };
            for format in [UNORM16, FLOAT32] {
                let by_mask = blended(&maps, Some(&mask), BlendMethod::Masked, format);
                assert_same(format_args!("{name}, t = {t:?}"), &by_mask, &blended(&maps, None, transition, format));
            }
            // Floats multiply by the parts of the ratio as they stand: only those of lowest terms are the same.
            if t.1 == 65_535 && t.0 == 32_768 || t.1 == 255 && t.0 == 254 {
                let by_mask = blended(&floats, Some(&mask), BlendMethod::Masked, FLOAT32);
                assert_same(format_args!("{name}, t = {t:?}"), &by_mask, &blended(&floats, None, transition, FLOAT32));
            }
        }
    }
}

/// The codes of a map over the greatest of them, as floats.
fn as_floats(map: &NormalMap) -> NormalMap {
    let (components, greatest) = crate::oracle::components(map, UnormZero::Zero);
    let bits: Vec<u32> = components.iter().map(|&u| (u as f32 / greatest as f32).to_bits()).collect();
    let format = NormalFormat { channels: map.format().channels, convention: map.format().convention, ..FLOAT32 };
    normal_map(map.size().width(), map.size().height(), format, &bits)
}

/// The same bytes as a mask of 16 bits: t = H / 255 = 257 H / 65535.
#[test]
fn a_mask_means_the_same_in_8_and_16_bits() {
    let mut random = Random::new(257);
    let maps = [UNORM8, UNORM8].map(|format| random_codes(&mut random, 64, 32, format));
    let codes: Vec<u8> = (0..64 * 32).map(|_| random.bits() as u8).collect();
    let (bytes, words) =
        (map_u8(64, 32, |x, y| codes[64 * y + x]), map_u16(64, 32, |x, y| 257 * u16::from(codes[64 * y + x])));
    let options = blend_options(BlendMethod::Masked, UNORM16);
    let expected = blend(&masked(&maps, &bytes), &options, UnormZero::Zero).image;
    for mask in [&bytes, &words] {
        assert_every_blend(&masked(&maps, mask), &options, &expected);
    }
}
