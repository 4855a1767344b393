//! Float heights: sums in f64 in the written order, then f32 as in level 0.

use super::assert_levels;
use crate::oracle::{float_levels, float_parallax_levels};
use crate::support::{FILTERS, FORMATS, Random, every_baker, every_edges, map_f32, options, parallax_formats};
use texbake::{BakeOptions, Baker, Channels, Convention, HeightMap, NormalFormat, NormalOptions, ParallaxOptions};

fn assert_right(name: &str, baker: &Baker, map: &HeightMap, turn: usize) {
    let channels = [Channels::Xyz, Channels::Xy][turn / 3 % 2];
    let convention = [Convention::Gl, Convention::Dx][turn / 5 % 2];
    let normal = NormalFormat { channels, convention, ..FORMATS[turn % 8] };
    let edges = every_edges().nth(turn % 9).expect("nine edges");
    let scale = ["24", "7/3", "-0.35", "1000"][turn % 4];
    let options = NormalOptions { filter: FILTERS[turn / 4 % 4], edges, ..options(scale, normal) };
    let NormalOptions { scale, filter, edges, precision, .. } = options;
    let parallax = parallax_formats()[turn / 2 % 8];
    let both = BakeOptions {
        scale,
        filter,
        edges,
        normal: Some(normal),
        parallax: Some(parallax),
        roughness: None,
        precision,
    };
    let what = format!("{name}, {}, {both:?}", map.size());
    let levels = baker.bake_levels(map, &both).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_levels(&what, &levels.normal.expect("normals"), &float_levels(map, &options));
    let options = ParallaxOptions { scale, filter, edges, format: parallax, precision };
    assert_levels(&what, &levels.parallax.expect("parallax"), &float_parallax_levels(map, &options));
}

/// Heights of many magnitudes, so that the order of a sum shows in its last bits.
fn uneven(random: &mut Random, width: usize, height: usize) -> HeightMap {
    map_f32(width, height, |_, _| (random.below(2001) as f32 / 700.0 - 1.0) * 2f32.powi(random.below(20) as i32 - 12))
}

#[test]
fn every_small_size_is_right() {
    let mut random = Random::new(81);
    for width in 1..=17 {
        for height in 1..=17 {
            let map = uneven(&mut random, width, height);
            assert_right("reference", &Baker::reference(), &map, 17 * width + height);
            assert_right("cpu", &Baker::cpu(), &map, 17 * width + height);
        }
    }
}

#[test]
fn larger_sizes_are_right() {
    let mut random = Random::new(82);
    for (turn, [width, height]) in
        [[64, 64], [100, 100], [255, 64], [256, 100], [255, 255], [600, 3]].iter().enumerate()
    {
        assert_right("cpu", &Baker::cpu(), &uneven(&mut random, *width, *height), turn);
    }
}

/// A strip has 2^17 texels: here a map has three, rows of levels that two of them share, and all levels come from level 0.
#[test]
fn a_map_of_several_strips_is_right() {
    let mut random = Random::new(84);
    assert_right("cpu", &Baker::cpu(), &uneven(&mut random, 601, 500), 7);
}

#[test]
fn every_device_has_the_same_levels() {
    let mut random = Random::new(83);
    let map = uneven(&mut random, 100, 37);
    for subject in every_baker() {
        assert_right(subject.name, &subject.baker, &map, 7);
    }
}
