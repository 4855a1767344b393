//! Any height map, any options: the same bytes everywhere, or a refusal that names what is wrong.

use super::inputs::{
    Heights, Terrain, any_float, any_parallax_format, bake_options, edges, filter, finite_float, is_stored,
    normal_format, normal_map, terrain,
};
use super::{CASES, FEW, agreed, holds, on_the_cpu};
use crate::support::{FLOAT16, FLOAT32, Format, Image, SNORM8, SNORM16, UNORM8, UNORM16, differences, every_baker, xy};
use proptest::prelude::*;
use texbake::{
    BakeOptions, Baker, Depth, Edges, Encoding, Error, Filter, HeightMap, Maps, NormalFormat, ParallaxFormat,
    Precision, Scale,
};

type Images = Maps<Image<NormalFormat>, Image<ParallaxFormat>>;

fn bake(baker: &Baker, map: &HeightMap, options: &BakeOptions) -> Result<Images, Error> {
    let maps = baker.bake(map, options)?;
    Ok(Maps {
        normal: maps.normal.as_ref().map(Image::from),
        parallax: maps.parallax.as_ref().map(Image::from),
        ..Maps::default()
    })
}

fn same(got: &Images, expected: &Images) -> Result<(), String> {
    fn of<F: Format>(got: &Option<Image<F>>, expected: &Option<Image<F>>) -> Result<(), String> {
        match (got, expected) {
            (Some(got), Some(expected)) => differences(got, expected),
            (None, None) => Ok(()),
            _ => Err("another map".into()),
        }
    }
    of(&got.normal, &expected.normal).and_then(|()| of(&got.parallax, &expected.parallax))
}

/// No code but those that the encoding writes; no float that is no number or beyond one.
fn assert_written<F: Format>(image: &Image<F>) {
    let (encoding, depth) = image.format.code();
    let least = match (encoding, depth) {
        (Encoding::Unorm, _) => 0.0,
        (Encoding::Biased, _) => 1.0,
        (Encoding::Snorm, Depth::Bits8) => -127.0,
        (Encoding::Snorm, _) => -32_767.0,
        (Encoding::Float, _) => -1.0,
    };
    for index in 0..image.bits.len() {
        let number = image.number(index);
        // Negated, for a NaN is neither.
        assert!(number >= least && (encoding != Encoding::Float || number <= 1.0), "{encoding} {depth}: {number}");
    }
}

#[test]
fn bakes_are_the_same_everywhere_or_refused() {
    holds(CASES, (terrain(any_float()), bake_options()), |(terrain, options)| {
        let stored =
            |normal: Option<NormalFormat>| normal.is_none_or(|format| is_stored(format.encoding, format.depth));
        let formats_go =
            stored(options.normal) && options.parallax.is_none_or(|format| is_stored(format.encoding, format.depth));
        let finite = match &terrain.heights {
            Heights::F32(heights) => heights.iter().all(|height| height.is_finite()),
            _ => true,
        };
        let result = agreed(on_the_cpu(), |baker| bake(baker, &terrain.map()?, &options), same);
        match result {
            Ok(images) => {
                assert!(formats_go && finite && (options.normal.is_some() || options.parallax.is_some()));
                images.normal.iter().for_each(assert_written);
                images.parallax.iter().for_each(assert_written);
            }
            Err(Error::NotFinite { x, y, .. }) => {
                let Heights::F32(heights) = &terrain.heights else { panic!("integers are finite") };
                let first = heights.iter().position(|height| !height.is_finite());
                assert_eq!(first, Some(y * terrain.width + x));
            }
            Err(Error::Parameter { parameter: "bits", .. }) => assert!(!formats_go),
            Err(Error::Parameter { parameter: "maps", .. }) => {
                assert!(options.normal.is_none() && options.parallax.is_none());
            }
            Err(Error::Parameter { parameter: "scale" | "size" | "depth", .. }) => {
                assert!(out_of_range(options.scale, terrain.width, terrain.height), "{}", options.scale);
            }
            Err(other) => panic!("{other}"),
        }
    });
}

/// Whether a scale is 2^24 and more, or near it, or no scale.
fn out_of_range(scale: Scale, width: usize, height: usize) -> bool {
    let number = |n: texbake::Rational| n.numerator() as f64 / n.denominator() as f64;
    let beyond = |texels: f64| texels.abs() > 16_777_214.0;
    match scale {
        Scale::Texels(texels) => beyond(number(texels)),
        Scale::Physical { size: [x, y], depth } => {
            let digits =
                |n: texbake::Rational| n.numerator().unsigned_abs().max(n.denominator().unsigned_abs()) > 1 << 40;
            let axis = |extent, count: usize| beyond(number(depth) / number(extent) * count as f64);
            number(x) <= 0.0
                || number(y) <= 0.0
                || axis(x, width)
                || axis(y, height)
                || digits(x)
                || digits(y)
                || digits(depth)
        }
    }
}

/// What GPUs bake: a kernel is compiled for each of these.
fn mix() -> impl Strategy<Value = (usize, Option<NormalFormat>, Option<ParallaxFormat>)> {
    let snorm = Some(ParallaxFormat::default());
    prop::sample::select(vec![
        (0, Some(UNORM8), None),
        (0, Some(xy(SNORM16)), None),
        (1, Some(UNORM16), snorm),
        (1, Some(FLOAT16), None),
        (2, Some(SNORM8), None),
        (2, Some(FLOAT32), None),
    ])
}

#[test]
fn gpus_bake_the_same_bytes() {
    let inputs = (terrain(finite_float()), mix(), filter(), edges(), -99_999..99_999i32);
    holds(6 * FEW, inputs, |(terrain, (kind, normal, parallax), filter, edges, scale)| {
        let terrain = of_kind(terrain, kind);
        let scale = Scale::texels(scale);
        let options =
            BakeOptions { scale, filter, edges, normal, parallax, roughness: None, precision: Precision::Exact };
        agreed(every_baker(), |baker| bake(baker, &terrain.map()?, &options), same).expect("a bake");
    });
}

/// Heights of 8 bits, 16 bits or floats made of any.
fn of_kind(terrain: Terrain, kind: usize) -> Terrain {
    let bits: Vec<u32> = match &terrain.heights {
        Heights::U8(heights) => heights.iter().map(|&height| u32::from(height) * 0x0101).collect(),
        Heights::U16(heights) => heights.iter().map(|&height| height.into()).collect(),
        Heights::F32(heights) if kind == 2 => heights.iter().map(|height| height.to_bits()).collect(),
        Heights::F32(heights) => heights.iter().map(|height| height.to_bits() >> 12).collect(),
    };
    let is_float = matches!(terrain.heights, Heights::F32(_));
    let heights = match kind {
        0 => Heights::U8(bits.iter().map(|&bits| (bits >> 8) as u8).collect()),
        1 => Heights::U16(bits.iter().map(|&bits| bits as u16).collect()),
        _ if is_float => Heights::F32(bits.iter().map(|&bits| f32::from_bits(bits)).collect()),
        _ => Heights::F32(bits.iter().map(|&bits| bits as f32 / 65_535.0).collect()),
    };
    Terrain { heights, ..terrain }
}

/// Heights, and normals from elsewhere.
#[test]
fn parallax_of_any_normals_is_the_same_everywhere_or_refused() {
    let inputs = (terrain(finite_float()), normal_format()).prop_flat_map(|(terrain, format)| {
        let normals = normal_map(terrain.width, terrain.height, format);
        (Just(terrain), normals, any_parallax_format())
    });
    holds(CASES, inputs, |(terrain, normals, format)| {
        let heights = terrain.map().expect("finite heights");
        let run = |baker: &Baker| {
            let map = baker.parallax_with_normals(&heights, &normals, format, Precision::Exact)?;
            Ok(Image::from(&map))
        };
        match agreed(on_the_cpu(), run, differences) {
            Ok(image) => assert_written(&image),
            Err(Error::Parameter { parameter, .. }) => {
                assert!(parameter == "bits" && !is_stored(format.encoding, format.depth));
            }
            Err(Error::NoDirection { value, .. }) => assert!(value.is_nan() || value.abs() > 65_536.0),
            Err(other) => panic!("{other}"),
        }
    });
}

/// Both maps in one pass are the maps baked alone.
#[test]
fn fused_bakes_are_the_maps_baked_alone() {
    let inputs = (terrain(finite_float()), normal_format(), -999..999i32, filter(), edges());
    holds(CASES, inputs, |(terrain, format, scale, filter, edges): (_, _, _, Filter, Edges)| {
        let map = terrain.map().expect("finite heights");
        let parallax = ParallaxFormat { encoding: format.encoding, depth: format.depth };
        let [both, normal, alone] = [(true, true), (true, false), (false, true)].map(|(normal, other)| BakeOptions {
            scale: Scale::texels(scale),
            filter,
            edges,
            normal: normal.then_some(format),
            parallax: other.then_some(parallax),
            roughness: None,
            precision: Precision::Exact,
        });
        for subject in on_the_cpu() {
            let bake = |options| bake(&subject.baker, &map, options).expect("a bake");
            let expected = Maps { normal: bake(&normal).normal, parallax: bake(&alone).parallax, ..Maps::default() };
            same(&bake(&both), &expected).unwrap_or_else(|report| panic!("{}: {report}", subject.name));
        }
    });
}
