//! Surfaces whose parallax maps are known without a stencil.

use crate::support::{
    FILTERS, Image, Subject, every_baker, map_f32, map_u8, map_u16, parallax_formats, parallax_options,
};
use texbake::{Baker, Depth, Encoding, HeightMap, ParallaxFormat, ParallaxOptions, Size};

const U: f64 = 1.0 / (1 << 24) as f64;

const SNORM8: ParallaxFormat = ParallaxFormat { encoding: Encoding::Snorm, depth: Depth::Bits8 };
const BIASED8: ParallaxFormat = ParallaxFormat { encoding: Encoding::Biased, depth: Depth::Bits8 };
const UNORM16: ParallaxFormat = ParallaxFormat { encoding: Encoding::Unorm, depth: Depth::Bits16 };
const FLOAT32: ParallaxFormat = ParallaxFormat { encoding: Encoding::Float, depth: Depth::Float32 };

fn bake(baker: &Baker, map: &HeightMap, options: &ParallaxOptions) -> Image<ParallaxFormat> {
    Image::from(&baker.parallax(map, options).expect("a bake"))
}

#[test]
fn the_default_is_8_bit_snorm() {
    assert_eq!(ParallaxOptions::default().format, SNORM8);
    assert_eq!(ParallaxOptions::default(), parallax_options("1", SNORM8));
}

/// n_z = 1: the code of 2h - 1. No integer height is exactly 1/2, since 255 and 65535 are odd: 127 and 128 of 255 lie
/// 1/255 on either side, which snorm rounds to 0 (127/255 = 0.498) and biased to 128.
#[test]
fn a_flat_map_holds_its_height() {
    for Subject { name, baker } in every_baker() {
        for (height, snorm, unorm) in [
            (0, -127.0, 0.0),
            (1, -126.0, 257.0),
            // 127 (2 . 63/255 - 1) = -64.2.
            (63, -64.0, 16_191.0),
            (127, 0.0, 32_639.0),
            (128, 0.0, 32_896.0),
            (129, 1.0, 33_153.0),
            (254, 126.0, 65_278.0),
            (255, 127.0, 65_535.0),
        ] {
            let maps = [map_u8(9, 5, |_, _| height), map_u16(9, 5, |_, _| 257 * u16::from(height))];
            for map in &maps {
                for scale in ["24", "-1/3", "16777215"] {
                    for (format, expected) in [(SNORM8, snorm), (BIASED8, snorm + 128.0), (UNORM16, unorm)] {
                        let baked = bake(baker, map, &parallax_options(scale, format));
                        assert!(
                            (0..45).all(|i| baked.number(i) == expected),
                            "{name}, {height}, {format:?}: {baked:?}"
                        );
                    }
                }
            }
        }
        // A float height of 1/2 is exactly no offset; beyond 0 and 1 it counts as 0 and 1.
        for (height, expected) in [(0.5, 0.0), (0.75, 0.5), (0.0, -1.0), (1.0, 1.0), (-3.0, -1.0), (1e30, 1.0)] {
            let map = map_f32(9, 5, |_, _| height);
            let baked = bake(baker, &map, &parallax_options("24", FLOAT32));
            assert!((0..45).all(|i| baked.number(i) == expected), "{name}, {height}: {baked:?}");
            let baked = bake(baker, &map, &parallax_options("24", BIASED8));
            let code = 128.0 + (127.0f64 * expected + 0.5).floor();
            assert!((0..45).all(|i| baked.number(i) == code), "{name}, {height}: {baked:?}");
        }
    }
}

/// A plane of slope 1: (2h - 1)/sqrt(2).
#[test]
fn a_plane_has_one_normal() {
    // 51/255 = 1/5 of a texel for a code, 5 codes a column.
    let bytes = map_u8(40, 9, |x, _| (5 * x) as u8);
    let floats = map_f32(40, 9, |x, _| x as f32 / 64.0);
    for Subject { name, baker } in every_baker() {
        for filter in FILTERS {
            let options = ParallaxOptions { filter, ..parallax_options("51", SNORM8) };
            let baked = bake(baker, &bytes, &options);
            // 127 (2h - 1)/sqrt(2): no code is near a boundary here.
            for x in 1..39 {
                let exact = 127.0 * (2.0 * 5.0 * x as f64 / 255.0 - 1.0) / 2f64.sqrt();
                assert_eq!(baked.texel(x, 4), [exact.round()], "{name}, {filter}, column {x}: {exact}");
            }
            let options = ParallaxOptions { filter, ..parallax_options("64", FLOAT32) };
            let baked = bake(baker, &floats, &options);
            for x in 1..39 {
                let exact = (2.0 * x as f64 / 64.0 - 1.0) / 2f64.sqrt();
                // 2h - 1 is exact, n_z within 4.5 u (float_heights.rs), their product rounded once.
                let got = baked.texel(x, 4)[0];
                assert!((got - exact).abs() <= 5.6 * U, "{name}, {filter}, column {x}: {got} for {exact}");
            }
        }
    }
}

/// The offset shrinks with n_z: a steep slope leaves none.
#[test]
fn cliffs_have_no_parallax() {
    let stripes = map_u16(32, 32, |x, _| if x / 2 % 2 == 0 { 65_535 } else { 0 });
    for Subject { name, baker } in every_baker() {
        let baked = bake(baker, &stripes, &parallax_options("16777215", SNORM8));
        assert!((0..32 * 32).all(|i| baked.number(i) == 0.0), "{name}");
    }
}

#[test]
fn depths_that_no_encoding_has_are_refused() {
    let map = map_u8(4, 4, |x, y| (x * y) as u8);
    assert_eq!(parallax_formats().len(), 8);
    for Subject { baker, .. } in every_baker() {
        for (encoding, depth, message) in [
            (Encoding::Float, Depth::Bits8, "bits is 8: it must be 16f or 32f for the encoding float"),
            (
                Encoding::Snorm,
                Depth::Float32,
                "bits is 32f: it must be 8 or 16 for the encodings unorm, snorm and biased",
            ),
        ] {
            let format = ParallaxFormat { encoding, depth };
            let error = baker.parallax(&map, &parallax_options("1", format)).expect_err("no such code");
            assert_eq!(error.to_string(), message);
        }
        let error = baker.parallax(&map, &parallax_options("16777216", SNORM8)).expect_err("out of range");
        assert_eq!(error.to_string(), "scale is 16777216: it must be between -16777215 and 16777215 texels");
    }
    assert!(Size::new(1, 1).is_ok());
}
