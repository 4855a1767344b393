//! What the options mean, and what they refuse.

use crate::oracle;
use crate::support::{
    BIASED8, BIASED16, FORMATS, Image, Random, SNORM8, SNORM16, Subject, UNORM8, assert_every_baker, every_baker,
    every_difference_pair, map_f32, map_u8, map_u16, options, scale,
};
use texbake::{
    Baker, Channels, Convention, Depth, Encoding, Error, Grid, HeightMap, NormalFormat, NormalOptions, Rational, Scale,
    Size,
};

fn noise(width: usize, height: usize) -> HeightMap {
    let mut random = Random::new(77);
    map_u16(width, height, |_, _| random.bits() as u16)
}

fn number(text: &str) -> Rational {
    text.parse().expect("a number")
}

#[test]
fn the_defaults_are_what_they_say() {
    let options = NormalOptions::default();
    assert_eq!(format!("{} {}", options.filter, options.precision), "central exact");
    assert_eq!(format!("{} {}", options.edges.x, options.edges.y), "wrap wrap");
    let NormalFormat { encoding, depth, channels, convention } = options.format;
    assert_eq!(format!("{encoding} {depth} {channels} {convention}"), "unorm 8 xyz gl");
    assert_eq!(options.scale, scale("1"));
}

#[test]
fn physical_sizes_give_each_axis_its_slope() {
    let map = noise(64, 48);
    for (width, height, depth) in [("2", "2", "0.1"), ("2", "0.5", "0.1"), ("0.3", "7", "-0.01"), ("100", "1/3", "3/7")]
    {
        let physical = Scale::physical(number(width), number(height), number(depth));
        assert!(physical.resolve(map.size()).expect("in range").exact, "{width} x {height}, {depth}");
        for format in FORMATS {
            let options = NormalOptions { scale: physical, ..options("1", format) };
            assert_every_baker(&map, &options, &oracle::image(&map, &options));
        }
    }
}

#[test]
fn a_physical_plane_has_the_slope_of_its_units() {
    // 10 texels a metre along x, 5 along y: 0.1 m of height over 255 codes.
    let map = map_u8(20, 20, |x, y| (4 * x + 8 * y) as u8);
    let options = NormalOptions {
        scale: Scale::physical(number("2"), number("4"), number("2.55")),
        format: NormalFormat { convention: Convention::Dx, ..SNORM8 },
        ..Default::default()
    };
    // One code is 1 cm. Slopes 4 cm / 10 cm and 8 cm / 20 cm: (-2, -2, 5)/sqrt(33) * 127 = -44.2, -44.2, 110.5.
    for Subject { name, baker } in every_baker() {
        let baked = Image::from(&baker.normal(&map, &options).expect("a bake"));
        assert_eq!(baked.texel(9, 9), [-44.0, -44.0, 111.0], "{name}");
    }
}

#[test]
fn a_long_scale_is_replaced_by_the_ratio_that_the_report_names() {
    let map = noise(33, 17);
    for text in ["3.14159265358979", "0.000000001", "-123456.789012345"] {
        let asked = options(text, UNORM8);
        let found = asked.scale.resolve(map.size()).expect("in range");
        assert!(!found.exact && found.x == found.y, "{text}");
        let ratio = Scale::texels(Rational::new(found.x.into(), found.q.into()).expect("a ratio"));
        assert_every_baker(&map, &asked, &oracle::image(&map, &NormalOptions { scale: ratio, ..asked }));
    }
}

#[test]
fn two_channels_are_the_first_two_of_three() {
    let maps =
        [noise(53, 29), map_u8(53, 29, |x, y| (x * x + 7 * y) as u8), map_f32(53, 29, |x, y| (x * y % 13) as f32)];
    for Subject { name, baker } in every_baker() {
        for map in &maps {
            for format in FORMATS {
                let baked = |channels| {
                    Image::from(&baker.normal(map, &options("5", NormalFormat { channels, ..format })).expect("a bake"))
                };
                let (xyz, xy) = (baked(Channels::Xyz), baked(Channels::Xy));
                let first_two: Vec<u32> = xyz.bits.chunks(3).flat_map(|texel| &texel[..2]).copied().collect();
                assert_eq!(xy.bits.len(), 2 * map.size().texels(), "{name}, {format:?}");
                assert!(xy.bits == first_two, "{name}, {} heights, {format:?}", map.height_type());
            }
        }
    }
}

#[test]
fn snorm_never_writes_its_least_code_and_biased_is_snorm_in_the_middle() {
    let steep = every_difference_pair();
    let floats = map_f32(64, 64, |x, _| ((x * 7) % 11) as f32);
    for Subject { name, baker } in every_baker() {
        for map in [&steep, &floats] {
            for (snorm, biased, middle) in [(SNORM8, BIASED8, 128.0), (SNORM16, BIASED16, 32768.0)] {
                let bake = |format| Image::from(&baker.normal(map, &options("16777215", format)).expect("a bake"));
                let (snorm, biased) = (bake(snorm), bake(biased));
                let numbers = |image: &Image| (0..image.bits.len()).map(|i| image.number(i)).collect::<Vec<_>>();
                let (snorm, biased) = (numbers(&snorm), numbers(&biased));
                let least = snorm.iter().copied().fold(f64::INFINITY, f64::min);
                assert_eq!(least, 1.0 - middle, "{name}: the slopes are steep enough for the least code there is");
                assert!(
                    snorm.iter().zip(&biased).all(|(s, b)| s + middle == *b),
                    "{name}: biased is not snorm + {middle}"
                );
            }
        }
    }
}

/// The message of a bake that must fail.
fn refusal(baker: &Baker, map: &HeightMap, options: &NormalOptions) -> String {
    match baker.normal(map, options) {
        Err(error @ Error::Parameter { .. }) => error.to_string(),
        other => panic!("{options:?} gave {other:?}"),
    }
}

#[test]
fn depths_that_no_encoding_has_are_refused() {
    let map = noise(4, 4);
    for Subject { baker, .. } in every_baker() {
        for (encoding, depth, message) in [
            (Encoding::Float, Depth::Bits8, "bits is 8: it must be 16f or 32f for the encoding float"),
            (Encoding::Float, Depth::Bits16, "bits is 16: it must be 16f or 32f for the encoding float"),
            (
                Encoding::Unorm,
                Depth::Float32,
                "bits is 32f: it must be 8 or 16 for the encodings unorm, snorm and biased",
            ),
            (
                Encoding::Snorm,
                Depth::Float16,
                "bits is 16f: it must be 8 or 16 for the encodings unorm, snorm and biased",
            ),
            (
                Encoding::Biased,
                Depth::Float16,
                "bits is 16f: it must be 8 or 16 for the encodings unorm, snorm and biased",
            ),
        ] {
            let format = NormalFormat { encoding, depth, ..UNORM8 };
            assert_eq!(refusal(baker, &map, &options("1", format)), message);
        }
    }
}

#[test]
fn scales_out_of_range_are_refused() {
    let map = noise(4, 4);
    for Subject { baker, .. } in every_baker() {
        for text in ["16777216", "-16777216", "1e9"] {
            let value = text.parse::<f64>().expect("a number");
            assert_eq!(
                refusal(baker, &map, &options(text, UNORM8)),
                format!("scale is {value}: it must be between -16777215 and 16777215 texels")
            );
        }
        for (width, height, named) in [("0", "1", "0"), ("1", "-2", "-2")] {
            let scale = Scale::physical(number(width), number(height), number("1"));
            let message = refusal(baker, &map, &NormalOptions { scale, ..Default::default() });
            assert!(message.contains(&format!("is {named}:")) && message.contains("above zero"), "{message}");
        }
    }
}

#[test]
fn sizes_that_do_not_fit_are_refused() {
    let message = Grid::new(3, 2, vec![0u8; 5]).expect_err("one is missing").to_string();
    assert_eq!(message, "number of texels is 5: it must be 6 for a map of 3 x 2");
    for (width, height) in [(0, 1), (1, 0), (1 << 31, 1), (usize::MAX, 2), (1 << 30, 1 << 30)] {
        let message = Size::new(width, height).expect_err("out of range").to_string();
        assert_eq!(
            message,
            format!("size is {width}x{height}: it must be at least 1x1 and at most 2147483647 texels on each side")
        );
    }
}

#[test]
fn heights_without_a_slope_are_named_by_position() {
    for (value, name) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        let mut heights = vec![0.5; 12];
        heights[7] = value;
        heights[11] = value;
        let grid = Grid::new(4, 3, heights).expect("a grid");
        let error = HeightMap::try_from(grid).expect_err("a height is not finite");
        assert!(matches!(error, Error::NotFinite { x: 3, y: 1, .. }), "{error:?}");
        assert!(error.to_string().starts_with(&format!("the height at column 3, row 1 is {name}: ")), "{error}");
    }
}
