//! Several maps out of one dispatch: each must have the bytes that the reference gives it, alone or not.

use crate::Baker;
use crate::exact::Scale;
use crate::map::{Channels, Convention, Depth, Edge, Edges, Encoding, Grid, HeightMap, NormalFormat, ParallaxFormat};
use crate::ops::bake::{BakeOptions, Filter};

/// Lavapipe; `None` where it is not installed.
fn lavapipe() -> Option<Baker> {
    let baker = Baker::gpu(Some("vulkan:llvmpipe")).ok();
    if baker.is_none() {
        assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none_or(|value| value != "1"), "no lavapipe");
        println!("not tested: no lavapipe");
    }
    baker
}

/// A number without pattern.
fn scrambled(x: usize, y: usize) -> u32 {
    super::self_test::scrambled((x + 977 * y) as u32)
}

/// Heights of every type; the floats go beyond 0 and 1.
fn maps(width: usize, height: usize) -> [HeightMap; 3] {
    [
        Grid::from_fn(width, height, |x, y| scrambled(x, y) as u8).unwrap().into(),
        Grid::from_fn(width, height, |x, y| scrambled(x, y) as u16).unwrap().into(),
        Grid::from_fn(width, height, |x, y| scrambled(x, y) as u16 as f32 / 30_000.0 - 0.5)
            .unwrap()
            .try_into()
            .unwrap(),
    ]
}

fn normal(encoding: Encoding, depth: Depth) -> Option<NormalFormat> {
    Some(NormalFormat { encoding, depth, ..Default::default() })
}

fn parallax(encoding: Encoding, depth: Depth) -> Option<ParallaxFormat> {
    Some(ParallaxFormat { encoding, depth })
}

/// Every depth beside two others, and parallax maps alone.
fn formats() -> Vec<(Option<NormalFormat>, Option<ParallaxFormat>)> {
    use Depth::{Bits8, Bits16, Float16, Float32};
    use Encoding::{Biased, Float, Snorm, Unorm};
    let normals = [normal(Unorm, Bits8), normal(Snorm, Bits16), normal(Float, Float16), normal(Float, Float32)];
    let parallaxes =
        [parallax(Snorm, Bits8), parallax(Biased, Bits16), parallax(Float, Float16), parallax(Float, Float32)];
    let both = (0..4).flat_map(|i| [(normals[i], parallaxes[i]), (normals[i], parallaxes[(i + 1) % 4])]);
    let xy = NormalFormat { channels: Channels::Xy, convention: Convention::Dx, ..Default::default() };
    both.chain(parallaxes.map(|parallax| (None, parallax)))
        .chain([(None, parallax(Unorm, Bits8)), (Some(xy), parallax(Unorm, Bits16))])
        .collect()
}

/// Asserts that all maps have the reference's bytes.
fn assert_like_reference(gpu: &Baker, heights: &HeightMap, options: &BakeOptions) {
    let [got, expected] = [gpu, &Baker::reference()].map(|baker| baker.bake(heights, options).unwrap());
    let what = format!("{} x {:?} {options:?}", heights.size(), heights.height_type());
    for (got, expected) in [
        (got.normal.as_ref().map(|map| map.codes()), expected.normal.as_ref().map(|map| map.codes())),
        (got.parallax.as_ref().map(|map| map.codes()), expected.parallax.as_ref().map(|map| map.codes())),
    ] {
        assert!(got.map(|codes| codes.bytes()) == expected.map(|codes| codes.bytes()), "{what}");
    }
    assert!(got.normal.is_some() || got.parallax.is_some(), "{what}");
}

#[test]
fn any_mix_of_formats_is_the_references() {
    let Some(gpu) = lavapipe() else { return };
    for heights in maps(37, 11) {
        for (normal, parallax) in formats() {
            let options = BakeOptions { scale: Scale::texels(2), normal, parallax, ..Default::default() };
            assert_like_reference(&gpu, &heights, &options);
        }
    }
}

#[test]
fn any_size_edge_filter_and_scale_is_the_references() {
    let Some(gpu) = lavapipe() else { return };
    let (normal, parallax) = (normal(Encoding::Unorm, Depth::Bits8), parallax(Encoding::Snorm, Depth::Bits16));
    for (width, height) in [(1, 1), (2, 1), (1, 5), (3, 3), (4, 2), (67, 33)] {
        for heights in maps(width, height) {
            for (edge, filter, scale) in [
                (Edge::Wrap, Filter::Central, "24"),
                (Edge::Clamp, Filter::Sobel, "-7/3"),
                (Edge::Mirror, Filter::Scharr, "16777213/9699691"),
                (Edge::Wrap, Filter::Prewitt, "0"),
                (Edge::Clamp, Filter::Central, "0.001"),
            ] {
                let scale = Scale::texels(scale.parse::<crate::exact::Rational>().unwrap());
                let edges = Edges::both(edge);
                let options = BakeOptions { scale, filter, edges, normal, parallax, ..Default::default() };
                assert_like_reference(&gpu, &heights, &options);
            }
        }
    }
}
