//! What moves, turns or lifts a height map moves, turns or leaves its normals: exactly.
//!
//! Unorm rounds half up, to the same side whatever the sign, and so do the codes of float heights, which are rounded in
//! f32: turned maps are compared in snorm and biased, of float heights in floats.

use super::inputs::{Heights, Terrain, edge, edges, filter, finite_float, normal_format, rational, terrain};
use super::{CASES, holds, on_the_cpu};
use crate::support::{Image, Subject, assert_same};
use proptest::prelude::*;
use texbake::{
    Channels, Convention, Depth, Edge, Edges, Encoding, Filter, NormalFormat, NormalOptions, Rational, Scale,
};

fn baked(subject: &Subject, terrain: &Terrain, options: &NormalOptions) -> Image {
    Image::from(&subject.baker.normal(&terrain.map().expect("a map"), options).expect("a bake"))
}

/// The codes of an image at other places.
fn moved(image: &Image, from: impl Fn(usize, usize) -> [usize; 2]) -> Image {
    let (width, channels) = (image.size.width(), image.format.channels.count());
    let code = |i: usize| {
        let [x, y] = from(i / channels % width, i / channels / width);
        image.bits[(y * width + x) * channels + i % channels]
    };
    Image { bits: (0..image.bits.len()).map(code).collect(), ..image.clone() }
}

/// A scale that there is.
fn texels() -> impl Strategy<Value = Rational> {
    rational().prop_filter("below 2^24", |scale| (scale.numerator() / scale.denominator()).abs() < 16_777_215)
}

fn options() -> impl Strategy<Value = NormalOptions> {
    (texels(), filter(), edges(), normal_format()).prop_map(|(scale, filter, edges, format)| NormalOptions {
        scale: Scale::Texels(scale),
        filter,
        edges,
        format,
        ..Default::default()
    })
}

#[test]
fn a_shifted_map_that_wraps_has_shifted_normals() {
    let inputs = (terrain(finite_float()), options(), 0..40usize, 0..40usize);
    holds(CASES, inputs, |(terrain, options, right, down)| {
        let options = NormalOptions { edges: Edges::both(Edge::Wrap), ..options };
        let (width, height) = (terrain.width, terrain.height);
        let from = |x: usize, y: usize| [(x + right) % width, (y + down) % height];
        let shifted = terrain.rearranged(width, height, from);
        for subject in on_the_cpu() {
            let expected = moved(&baked(subject, &terrain, &options), from);
            assert_same(subject.name, &baked(subject, &shifted, &options), &expected);
        }
    });
}

/// Floats in steps of 2^-8 and below 4: their sums are exact.
#[test]
fn a_lifted_map_has_the_same_normals() {
    let heights = terrain((0..512u16).prop_map(|steps| f32::from(steps) / 256.0));
    holds(CASES, (heights, options(), 0..128u8), |(terrain, options, lift)| {
        let lifted = |by: u8| {
            let heights = match &terrain.heights {
                Heights::U8(heights) => Heights::U8(heights.iter().map(|h| h / 2 + by).collect()),
                Heights::U16(heights) => Heights::U16(heights.iter().map(|h| h / 2 + 256 * u16::from(by)).collect()),
                Heights::F32(heights) => Heights::F32(heights.iter().map(|h| h + f32::from(by) / 256.0).collect()),
            };
            Terrain { heights, ..terrain }
        };
        for subject in on_the_cpu() {
            let expected = baked(subject, &lifted(0), &options);
            assert_same(subject.name, &baked(subject, &lifted(lift), &options), &expected);
        }
    });
}

/// 1 - h at -s, and -h of floats, is as steep as h at s.
#[test]
fn depths_are_heights_of_the_negative_scale() {
    holds(CASES, (terrain(finite_float()), options()), |(terrain, options)| {
        let heights = match &terrain.heights {
            Heights::U8(heights) => Heights::U8(heights.iter().map(|h| 255 - h).collect()),
            Heights::U16(heights) => Heights::U16(heights.iter().map(|h| 65_535 - h).collect()),
            Heights::F32(heights) => Heights::F32(heights.iter().map(|h| -h).collect()),
        };
        let Scale::Texels(scale) = options.scale else { panic!("texels") };
        let negative = Rational::new(-scale.numerator(), scale.denominator()).expect("a number");
        let turned = Terrain { heights, ..terrain };
        for subject in on_the_cpu() {
            let expected = baked(subject, &terrain, &options);
            let negative = NormalOptions { scale: Scale::Texels(negative), ..options };
            assert_same(subject.name, &baked(subject, &turned, &negative), &expected);
        }
    });
}

/// A format whose rounding knows no up and down.
fn even(terrain: &Terrain, format: NormalFormat) -> NormalFormat {
    let is_float = matches!(terrain.heights, Heights::F32(_));
    match (is_float, format.encoding, format.depth) {
        (_, Encoding::Float, _) => format,
        (true, _, Depth::Bits8) => NormalFormat { encoding: Encoding::Float, depth: Depth::Float16, ..format },
        (true, ..) => NormalFormat { encoding: Encoding::Float, depth: Depth::Float32, ..format },
        (false, Encoding::Unorm, _) => NormalFormat { encoding: Encoding::Snorm, ..format },
        _ => format,
    }
}

/// The numbers of an image with zero at zero.
fn centred(image: &Image) -> Vec<[f64; 3]> {
    let zero = match (image.format.encoding, image.format.depth) {
        (Encoding::Biased, Depth::Bits8) => 128.0,
        (Encoding::Biased, _) => 32_768.0,
        _ => 0.0,
    };
    let channels = image.format.channels.count();
    let texel =
        |i: usize| std::array::from_fn(|c| if c < channels { image.number(i * channels + c) - zero } else { 0.0 });
    (0..image.size.texels()).map(texel).collect()
}

/// Bakes a map as it is and after `turn`, whose texel (x, y) is the map's at `from(x, y)`, and compares the normals,
/// each changed by `change`.
fn assert_turns(
    terrain: &Terrain,
    [options, turned_options]: [&NormalOptions; 2],
    [width, height]: [usize; 2],
    from: impl Fn(usize, usize) -> [usize; 2],
    change: impl Fn([f64; 3]) -> [f64; 3],
) {
    let turned = terrain.rearranged(width, height, &from);
    for subject in on_the_cpu() {
        let straight = centred(&baked(subject, terrain, options));
        let got = centred(&baked(subject, &turned, turned_options));
        assert_eq!(got.len(), width * height);
        for (i, got) in got.into_iter().enumerate() {
            let [x, y] = from(i % width, i / width);
            let expected = change(straight[y * terrain.width + x]);
            assert_eq!(got, expected, "{}, column {}, row {}", subject.name, i % width, i / width);
        }
    }
}

/// With any edges: mirrored about a vertical and a horizontal line, and about the diagonal; so turned too.
#[test]
fn turned_maps_have_turned_normals() {
    let inputs = (terrain(finite_float()), texels(), filter(), (edge(), edge()), normal_format());
    holds(CASES, inputs, |(terrain, scale, filter, (x, y), format): (Terrain, _, Filter, _, _)| {
        let format = even(&terrain, format);
        let with = |x, y| NormalOptions {
            scale: Scale::Texels(scale),
            filter,
            edges: Edges { x, y },
            format,
            ..Default::default()
        };
        let straight = with(x, y);
        let options = [&straight; 2];
        let (width, height) = (terrain.width, terrain.height);
        let size = [width, height];
        assert_turns(&terrain, options, size, |x, y| [width - 1 - x, y], |[x, y, z]| [-x, y, z]);
        assert_turns(&terrain, options, size, |x, y| [x, height - 1 - y], |[x, y, z]| [x, -y, z]);
        let across = with(y, x);
        let transposed = [&straight, &across];
        let sign = if format.convention == Convention::Gl { -1.0 } else { 1.0 };
        assert_turns(&terrain, transposed, [height, width], |x, y| [y, x], |[x, y, z]| [sign * y, sign * x, z]);
        // A quarter turn: to the left, as (y, width - 1 - x) says; x to the right becomes y up.
        let quarter = |[x, y, z]: [f64; 3]| [sign * y, -sign * x, z];
        assert_turns(&terrain, transposed, [height, width], |x, y| [width - 1 - y, x], quarter);
    });
}

/// Two channels are the first two of three, and green down is green up negated.
#[test]
fn channels_and_conventions_change_nothing_else() {
    holds(CASES, (terrain(finite_float()), options()), |(terrain, options)| {
        let format = even(&terrain, options.format);
        let with = |channels, convention| NormalFormat { channels, convention, ..format };
        for subject in on_the_cpu() {
            let of = |format| centred(&baked(subject, &terrain, &NormalOptions { format, ..options }));
            let three = of(with(Channels::Xyz, Convention::Gl));
            for (xy, xyz) in of(with(Channels::Xy, Convention::Gl)).iter().zip(&three) {
                assert_eq!([xy[0], xy[1]], [xyz[0], xyz[1]], "{}", subject.name);
            }
            for (down, up) in of(with(Channels::Xyz, Convention::Dx)).iter().zip(&three) {
                assert_eq!(*down, [up[0], -up[1], up[2]], "{}", subject.name);
            }
        }
    });
}
