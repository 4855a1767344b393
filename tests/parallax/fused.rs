//! Both maps in one pass: not a byte of either differs from baking it alone.

use crate::oracle::float_parallax;
use crate::support::{
    FILTERS, FLOAT32, FORMATS, Image, Random, Subject, assert_every_parallax, assert_same, bakers, dx, every_baker,
    every_edges, map_f32, map_u8, map_u16, parallax_formats, scale, xy,
};
use texbake::{BakeOptions, Baker, Filter, HeightMap, NormalFormat, NormalOptions, ParallaxFormat, ParallaxOptions};

fn maps() -> [HeightMap; 3] {
    let mut random = Random::new(0xf05ed);
    [
        map_u8(61, 23, |_, _| random.bits() as u8),
        map_u16(61, 23, |x, _| if x < 30 { random.bits() as u16 } else { 33_000 + random.below(60) as u16 }),
        map_f32(61, 23, |x, y| match (x / 20, y / 8) {
            (0, 0) => random.finite(),
            (0, _) => random.below(1 << 24) as f32 / 16_777_216.0,
            (1, _) => 0.5 + random.below(100) as f32 * 0.01,
            _ => 0.5,
        }),
    ]
}

/// Fails unless the maps baked together are those baked one by one.
fn assert_fused_is_alone(name: &str, baker: &Baker, map: &HeightMap, options: &BakeOptions) {
    let BakeOptions { scale, filter, edges, precision, .. } = *options;
    let both = baker.bake(map, options).expect("a bake");
    let what = format!("{name}, {} heights, {options:?}", map.height_type());
    let (normal, parallax) = (options.normal.expect("asked for"), options.parallax.expect("asked for"));
    let alone = baker.normal(map, &NormalOptions { scale, filter, edges, format: normal, precision }).expect("a bake");
    assert_same(&what, &Image::from(&both.normal.expect("a normal map")), &Image::from(&alone));
    let alone = ParallaxOptions { scale, filter, edges, format: parallax, precision };
    let alone = baker.parallax(map, &alone).expect("a bake");
    assert_same(&what, &Image::from(&both.parallax.expect("a parallax map")), &Image::from(&alone));
}

fn both(scale_text: &str, normal: NormalFormat, parallax: ParallaxFormat) -> BakeOptions {
    BakeOptions { scale: scale(scale_text), normal: Some(normal), parallax: Some(parallax), ..Default::default() }
}

/// Every normal format beside every parallax format; types of heights, channels and conventions in turn. GPUs
/// bake each format twice.
#[test]
fn every_mix_of_formats() {
    for (i, normal) in FORMATS.into_iter().enumerate() {
        for (j, parallax) in parallax_formats().into_iter().enumerate() {
            let normal = [normal, xy(normal), dx(normal), dx(xy(normal))][(i / 2 + j) % 4];
            let options = both(["24", "-7/3", "0.35"][(i + j) % 3], normal, parallax);
            for Subject { name, baker } in bakers((i + j) % 4 == 0) {
                assert_fused_is_alone(name, baker, &maps()[(i + 2 * j) % 3], &options);
            }
        }
    }
}

#[test]
fn every_filter_and_edge() {
    for (i, filter) in FILTERS.into_iter().enumerate() {
        for (j, edges) in every_edges().enumerate() {
            let options = BakeOptions { filter, edges, ..both("24", FORMATS[j % 2], parallax_formats()[2 + j % 2]) };
            for Subject { name, baker } in every_baker() {
                assert_fused_is_alone(name, baker, &maps()[(i + j) % 3], &options);
            }
        }
    }
}

/// Rows of more texels than a tile, and single ones.
#[test]
fn sizes_of_all_kinds() {
    for (width, height) in [(1, 1), (1, 40), (40, 1), (2, 2), (3, 5), (515, 3), (130, 130)] {
        let maps = [
            map_u8(width, height, |x, y| ((x * 7) ^ (y * 3)) as u8),
            map_f32(width, height, |x, y| (x ^ y) as f32 / 64.0),
        ];
        for map in &maps {
            for normal in [FORMATS[0], xy(FORMATS[1])] {
                for Subject { name, baker } in every_baker() {
                    assert_fused_is_alone(name, baker, map, &both("5", normal, ParallaxFormat::default()));
                }
            }
        }
    }
}

/// The parallax map of float heights is (2h - 1) times the z of their normal map, which float_heights.rs proves.
#[test]
fn float_heights_follow_the_documented_order() {
    let [.., map] = maps();
    let hard = {
        let mut random = Random::new(0x4a2d);
        map_f32(64, 32, |x, _| match x % 4 {
            0 => random.finite(),
            1 => [0.0, -0.0, 0.5, 1.0, 1e-45, f32::MAX, -1.0, 2.0][random.below(8) as usize],
            _ => random.below(1 << 24) as f32 / 16_777_216.0,
        })
    };
    let reference = Baker::reference();
    for map in [&map, &hard] {
        for (filter, scale_text) in [(Filter::Central, "24"), (Filter::Scharr, "1/16777215"), (Filter::Sobel, "-7/3")] {
            let normal = NormalOptions { filter, scale: scale(scale_text), format: FLOAT32, ..Default::default() };
            let normals = Image::from(&reference.normal(map, &normal).expect("a bake"));
            let z = || normals.bits.chunks(3).map(|texel| f32::from_bits(texel[2]));
            for format in parallax_formats() {
                let options = ParallaxOptions { filter, scale: scale(scale_text), format, ..Default::default() };
                assert_every_parallax(map, &options, &float_parallax(map, z(), format));
            }
        }
    }
}

#[test]
fn one_map_alone_or_none() {
    let [map, ..] = maps();
    for Subject { name, baker } in every_baker() {
        let options = both("3", FORMATS[0], ParallaxFormat::default());
        let normal_only = baker.bake(&map, &BakeOptions { parallax: None, ..options }).expect("a bake");
        assert!(normal_only.normal.is_some() && normal_only.parallax.is_none(), "{name}");
        let parallax_only = baker.bake(&map, &BakeOptions { normal: None, ..options }).expect("a bake");
        assert!(parallax_only.normal.is_none() && parallax_only.parallax.is_some(), "{name}");
        let error = baker.bake(&map, &BakeOptions { normal: None, parallax: None, ..options }).expect_err("nothing");
        assert_eq!(error.to_string(), "maps is none: it must be normal, parallax or both");
    }
}
