//! 8-bit maps: every pair of codes of one channel, and any codes of all three.

use super::{assert_right, every_method};
use crate::oracle::{UnormZero, blend};
use crate::support::{
    BIASED8, BIASED16, FORMATS, Random, SNORM8, SNORM16, UNORM8, UNORM16, assert_blends, bakers, blend_options, dx,
    landmarks, map_of_texels, pair, random_codes, weighted, xy,
};
use texbake::{NormalFormat, NormalMap};

/// Both maps in any mix of encodings, channels and conventions.
const INPUTS: [[NormalFormat; 2]; 5] = [
    [UNORM8, UNORM8],
    [SNORM8, dx(BIASED8)],
    [xy(UNORM8), dx(SNORM8)],
    [dx(BIASED8), xy(UNORM8)],
    [xy(SNORM8), xy(dx(BIASED8))],
];

const OUTPUTS: [NormalFormat; 7] = [UNORM8, SNORM16, dx(UNORM16), BIASED8, xy(UNORM8), SNORM8, dx(BIASED16)];

/// Two maps of 256 x 512 texels that hold all 65536 pairs of codes for x.
///
/// In the upper half y is flat and z is 1, so that slopes lie along one axis. In the lower half y runs through all pairs
/// too, and z is anything; a map without z rebuilds it.
fn every_pair_of_codes(random: &mut Random, formats: [NormalFormat; 2]) -> [NormalMap; 2] {
    [0, 1].map(|map| {
        let [_, zero, one] = landmarks(formats[map]);
        map_of_texels(256, 512, formats[map], |column, row| {
            let codes = [column as u32, row as u32 % 256];
            let other = codes[1 - map] ^ 0x5a;
            if row < 256 { [codes[map], zero, one] } else { [codes[map], other, random.below(256) as u32] }
        })
    })
}

fn every_pair_is_right(methods: &[usize]) {
    let mut random = Random::new(0x0256_0256);
    for (i, formats) in INPUTS.into_iter().enumerate() {
        let [base, detail] = every_pair_of_codes(&mut random, formats);
        for &method in methods {
            assert_right(&pair(&base, &detail), every_method()[method], OUTPUTS[(2 * i + method) % OUTPUTS.len()]);
        }
    }
}

#[test]
fn every_pair_of_codes_in_slope_space() {
    every_pair_is_right(&[0, 1, 2]);
}

#[test]
fn every_pair_of_codes_in_linear_and_overlay_blends() {
    every_pair_is_right(&[3, 4]);
}

#[test]
fn every_pair_of_codes_in_udn_whiteout_and_rnm_blends() {
    every_pair_is_right(&[5, 6, 7]);
}

/// GPUs see each format twice in either map.
#[test]
fn every_mix_of_formats() {
    let mut random = Random::new(8);
    for (i, &first) in FORMATS[..6].iter().enumerate() {
        for (j, &second) in FORMATS[..6].iter().enumerate() {
            let formats = match (i + j) % 4 {
                0 => [first, second],
                1 => [dx(first), second],
                2 => [xy(first), dx(second)],
                _ => [first, xy(second)],
            };
            let [base, detail] = formats.map(|format| random_codes(&mut random, 61, 17, format));
            let method = every_method()[(i + 2 * j) % 8];
            let format = FORMATS[(3 * i + j) % 8];
            let options = blend_options(method, if j % 2 == 0 { format } else { dx(format) });
            let expected = blend(&pair(&base, &detail), &options, UnormZero::Zero).image;
            assert_blends(bakers((i + j) % 3 == 0), &pair(&base, &detail), &options, &expected);
        }
    }
}

/// All signs, both ends of the range, weights that cancel, and none.
const WEIGHTS: [[&str; 2]; 14] = [
    ["1", "1"],
    ["1", "-1"],
    ["-1", "-1"],
    ["0", "1"],
    ["1", "0"],
    ["0", "0"],
    ["65535", "65535"],
    ["65535", "-65535"],
    ["-65535", "1"],
    ["1/65535", "1"],
    ["1/65535", "-1/65535"],
    ["65535/65534", "-1/65534"],
    ["32768/32767", "-1/32767"],
    ["7/3", "1/9"],
];

#[test]
fn weights_of_either_sign_and_any_size() {
    let mut random = Random::new(77);
    for (i, [base_weight, detail_weight]) in WEIGHTS.into_iter().enumerate() {
        for formats in [[UNORM8, SNORM8], [UNORM16, xy(UNORM16)], [dx(BIASED16), UNORM8]] {
            let [base, detail] = formats.map(|format| random_codes(&mut random, 47, 31, format));
            for format in [UNORM8, UNORM16, SNORM16] {
                assert_right(&pair(&base, &detail), weighted(base_weight, detail_weight), format);
            }
            // Nearly the same bumps with weights that nearly cancel.
            let format = FORMATS[i % 8];
            assert_right(&pair(&base, &base), weighted(base_weight, detail_weight), format);
        }
    }
}
