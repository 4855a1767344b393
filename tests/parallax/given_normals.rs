//! Heights with the normals of a map that is there already.

use crate::oracle::{float_parallax_with_normals, parallax_with_normals};
use crate::support::{
    BIASED16, FLOAT16, FLOAT32, FORMATS, INTEGER_FORMATS, Image, Random, SNORM8, SNORM16, Subject, UNORM8,
    assert_every_parallax_with_normals, dx, every_baker, flat_map, landmarks, map_f32, map_of_texels, map_u8, map_u16,
    normal_map, parallax_formats, random_codes, xy,
};
use texbake::{HeightMap, NormalFormat, NormalMap, ParallaxFormat, Precision};

const WIDTH: usize = 71;
const HEIGHT: usize = 37;

fn heights(random: &mut Random) -> [HeightMap; 2] {
    [map_u8(WIDTH, HEIGHT, |_, _| random.bits() as u8), map_u16(WIDTH, HEIGHT, |_, _| random.bits() as u16)]
}

fn assert_right(map: &HeightMap, normals: &NormalMap, format: ParallaxFormat) {
    assert_every_parallax_with_normals(map, normals, &parallax_with_normals(map, normals, format).image);
}

#[test]
fn every_mix_of_integer_formats() {
    let mut random = Random::new(0x91e5);
    let heights = heights(&mut random);
    for (i, format) in INTEGER_FORMATS.into_iter().enumerate() {
        for (j, format) in [format, xy(format), dx(format)].into_iter().enumerate() {
            let normals = random_codes(&mut random, WIDTH, HEIGHT, format);
            for (k, map) in heights.iter().enumerate() {
                for step in [0, 3] {
                    assert_right(map, &normals, parallax_formats()[(i + 2 * j + k + step) % 8]);
                }
            }
        }
    }
}

/// All heights beside all codes of x, the others flat and upright.
#[test]
fn every_height_beside_every_code() {
    let map = map_u8(256, 256, |x, _| x as u8);
    for format in [UNORM8, SNORM8, xy(UNORM8), xy(SNORM8)] {
        let [_, zero, one] = landmarks(format);
        let normals = map_of_texels(256, 256, format, |_, y| [y as u32, zero, one]);
        for format in parallax_formats().into_iter().filter(|format| !format.depth.is_float()) {
            assert_right(&map, &normals, format);
        }
    }
}

/// n_z = c/d and 2H - M a multiple of d: ties of unorm, as in sixteen_bits.rs.
#[test]
fn pythagorean_ties() {
    let mut random = Random::new(0x6e5);
    let quadruples = [[1, 2, 2, 3], [0, 3, 4, 5], [14, 5, 2, 15], [12, 9, 8, 17], [24, 8, 6, 26]];
    let at = |x: usize| quadruples[x % 5];
    let map = map_u16(200, 4, |x, _| {
        let d = at(x)[3] | 1;
        ((65_535 + d * (2 * (random.any_magnitude(65_535 / d - 1) / 2) + 1)) / 2) as u16
    });
    let normals = map_of_texels(200, 4, SNORM16, |x, y| [0, 1, 2].map(|i| (at(x)[i] * (y as i64 + 1)) as u32));
    for format in parallax_formats() {
        let expected = parallax_with_normals(&map, &normals, format);
        assert!(expected.ties > 300 || format != parallax_formats()[1], "{} ties", expected.ties);
        assert_every_parallax_with_normals(&map, &normals, &expected.image);
    }
}

#[test]
fn floats_in_either_map() {
    let mut random = Random::new(0xf9a5);
    let [bytes, words] = heights(&mut random);
    let edges = [0.0, -0.0, 0.5, 1.0, -2.0, 3.5, 1e-40, f32::MAX];
    let floats =
        map_f32(WIDTH, HEIGHT, |x, _| if x < 8 { edges[x] } else { random.below(1 << 24) as f32 / 16_777_216.0 });
    let mut float_normals = |format: NormalFormat| {
        map_of_texels(WIDTH, HEIGHT, format, |_, y| {
            [0; 3].map(|_| match (y % 4, format == FLOAT16 || format == xy(FLOAT16)) {
                (0, true) => random.below(0x3c00) as u32,
                (_, true) => (random.below(0x7c00) | (random.bits() & 0x8000)) as u32,
                (0, false) => (random.below(1 << 24) as f32 / 16_777_216.0).to_bits(),
                (_, false) => random.finite().clamp(-65_536.0, 65_536.0).to_bits(),
            })
        })
    };
    let normals = [FLOAT32, xy(FLOAT32), FLOAT16, xy(FLOAT16)].map(&mut float_normals);
    let mut cases: Vec<(&HeightMap, &NormalMap)> = Vec::new();
    normals.iter().for_each(|normals| cases.extend([(&bytes, normals), (&words, normals), (&floats, normals)]));
    let integers = [UNORM8, xy(SNORM16)].map(|format| random_codes(&mut Random::new(3), WIDTH, HEIGHT, format));
    integers.iter().for_each(|normals| cases.push((&floats, normals)));
    for (i, (map, normals)) in cases.into_iter().enumerate() {
        // A device compiles a kernel for each mix of depths.
        let formats = parallax_formats();
        for format in if i == 0 { &formats[..] } else { &formats[i % 8..][..1] } {
            let expected = float_parallax_with_normals(map, normals, *format);
            assert_every_parallax_with_normals(map, normals, &expected);
        }
    }
}

#[test]
fn known_texels() {
    // n_z = 4/5 and h = 1: 127 . 0.8 = 101.6; h = 0 is its negative; 204/255 = 0.8: 127 . 0.8 . 0.6 = 60.96.
    let normals = [
        normal_map(3, 1, SNORM8, &[3, 0, 4, 93, 0, 124, 0, 60, 80]),
        normal_map(3, 1, dx(BIASED16), &[32_771, 32_768, 32_772, 32_861, 32_768, 32_892, 32_768, 32_828, 32_848]),
    ];
    let map = map_u8(3, 1, |x, _| [255, 0, 204][x]);
    for Subject { name, baker } in every_baker() {
        for normals in &normals {
            let baked = baker.parallax_with_normals(&map, normals, ParallaxFormat::default(), Precision::Exact);
            let baked = Image::from(&baked.expect("a bake"));
            let numbers: Vec<f64> = (0..3).map(|i| baked.number(i)).collect();
            assert_eq!(numbers, [102.0, -102.0, 61.0], "{name}, {:?}", normals.format());
        }
    }
}

#[test]
fn other_sizes_and_no_directions_are_refused() {
    let map = map_u8(4, 3, |_, _| 9);
    for Subject { name, baker } in every_baker() {
        let refusal = |normals: &NormalMap| {
            let baked = baker.parallax_with_normals(&map, normals, ParallaxFormat::default(), Precision::Exact);
            baked.expect_err(name).to_string()
        };
        assert_eq!(
            refusal(&flat_map(3, 4, UNORM8)),
            "size of the normal map is 3 x 4: it must be 4 x 3, as the first map's"
        );
        let mut bits = Image::from(&flat_map(4, 3, FLOAT32)).bits;
        bits[3 * 6 + 2] = f32::NAN.to_bits();
        assert_eq!(
            refusal(&normal_map(4, 3, FLOAT32, &bits)),
            "the normal at column 2, row 1 has a component of NaN: components must be between -65536 and 65536; \
             texbake check --repair -o FILE makes such texels flat"
        );
    }
    assert_eq!(FORMATS.len(), parallax_formats().len());
}
