//! Integer heights: every code of every level is the nearest, by big integers and the definition.

use super::assert_levels;
use crate::oracle::{integer_levels, integer_parallax_levels, level_sizes};
use crate::support::{
    FILTERS, FORMATS, Random, SNORM8, UNORM8, UNORM16, bakers, every_baker, every_edges, map_u8, map_u16, options,
    parallax_formats, scale,
};
use texbake::{
    BakeOptions, Baker, Channels, Convention, HeightMap, NormalFormat, NormalOptions, ParallaxFormat, ParallaxOptions,
    Size,
};

/// Options that take their turns, so that every size meets several and every option many sizes.
fn turns() -> impl Iterator<Item = (NormalOptions, ParallaxFormat)> {
    let scales = ["24", "7/3", "-0.35", "1e6", "16777215/16777213", "1e-3", "0"];
    let edges: Vec<_> = every_edges().collect();
    (0..).map(move |turn: usize| {
        let format = NormalFormat {
            channels: [Channels::Xyz, Channels::Xy][turn / 3 % 2],
            convention: [Convention::Gl, Convention::Dx][turn / 5 % 2],
            ..FORMATS[turn % 8]
        };
        let options = NormalOptions {
            scale: scale(scales[turn % scales.len()]),
            filter: FILTERS[turn % 4],
            edges: edges[turn / 2 % edges.len()],
            format,
            ..Default::default()
        };
        (options, parallax_formats()[turn / 7 % 8])
    })
}

fn assert_right(name: &str, baker: &Baker, map: &HeightMap, options: NormalOptions, parallax: ParallaxFormat) {
    let NormalOptions { scale, filter, edges, format, precision } = options;
    let both = BakeOptions {
        scale,
        filter,
        edges,
        normal: Some(format),
        parallax: Some(parallax),
        roughness: None,
        precision,
    };
    let levels = baker.bake_levels(map, &both).unwrap_or_else(|error| panic!("{name}: {error}"));
    let what = format!("{name}, {} heights of {}, {both:?}", map.height_type(), map.size());
    assert_levels(&what, &levels.normal.expect("normals"), &integer_levels(map, &options));
    // Green that points down turns no parallax.
    let options = ParallaxOptions { scale, filter, edges, format: parallax, precision };
    assert_levels(&what, &levels.parallax.expect("parallax"), &integer_parallax_levels(map, &options));
}

#[test]
fn every_small_size_is_right() {
    let mut random = Random::new(71);
    let mut turns = turns();
    for width in 1..=17 {
        for height in 1..=17 {
            let maps = [
                map_u8(width, height, |_, _| random.bits() as u8),
                map_u16(width, height, |_, _| random.bits() as u16),
            ];
            for map in &maps {
                let (options, parallax) = turns.next().expect("turns have no end");
                for subject in bakers(false) {
                    assert_right(subject.name, &subject.baker, map, options, parallax);
                }
            }
        }
    }
}

#[test]
fn larger_sizes_are_right() {
    let mut random = Random::new(72);
    let mut turns = turns();
    for [width, height] in [[64, 64], [100, 100], [255, 64], [256, 100], [255, 255], [100, 1], [3, 256], [600, 5]] {
        let maps =
            [map_u8(width, height, |_, _| random.bits() as u8), map_u16(width, height, |_, _| random.bits() as u16)];
        for map in &maps {
            let (options, parallax) = turns.next().expect("turns have no end");
            assert_right("cpu", &Baker::cpu(), map, options, parallax);
        }
    }
}

/// A strip has 2^17 texels: here a map has three, and rows of levels that two of them share.
#[test]
fn a_map_of_several_strips_is_right() {
    let mut random = Random::new(75);
    let map = map_u16(700, 400, |_, _| random.bits() as u16);
    assert_right("cpu", &Baker::cpu(), &map, options("24", UNORM16), ParallaxFormat::default());
}

#[test]
fn every_encoding_edge_and_filter_is_right() {
    let mut random = Random::new(73);
    let map = map_u16(12, 10, |_, _| random.bits() as u16);
    for normal in FORMATS {
        for edges in every_edges() {
            for filter in FILTERS {
                let parallax = ParallaxFormat { encoding: normal.encoding, depth: normal.depth };
                let options = NormalOptions { filter, edges, ..options("24", normal) };
                assert_right("cpu", &Baker::cpu(), &map, options, parallax);
            }
        }
    }
}

#[test]
fn every_device_has_the_same_levels() {
    let mut random = Random::new(74);
    let map = map_u8(100, 37, |_, _| random.bits() as u8);
    for subject in every_baker() {
        assert_right(subject.name, &subject.baker, &map, options("24", UNORM8), ParallaxFormat::default());
    }
}

/// The widest numbers that a small map can make: 24 bits of scale, heights of 0 and 65535 only, and sums that no factor
/// is common to.
#[test]
fn extreme_scales_and_heights_are_right() {
    for (text, format) in [("16777215", UNORM16), ("16777215/16777214", UNORM16), ("1/16777215", SNORM8)] {
        let map = map_u16(31, 29, |x, y| if (x / 3 + y / 5) % 2 == 0 { 0 } else { 65_535 });
        for filter in FILTERS {
            let options = NormalOptions { filter, ..options(text, format) };
            assert_right("cpu", &Baker::cpu(), &map, options, ParallaxFormat::default());
        }
    }
}

/// Half of the texels of a level have no slope along an axis, or Pythagorean ones: ties, all of which round up.
#[test]
fn ties_of_means_round_up() {
    // Slopes of 3/4, 0, 5/12 and their negatives, two texels each, whose means are as exact.
    let map = map_u8(16, 4, |x, _| [0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 0, 0, 255, 255, 255, 255][x]);
    for text in ["1/2", "3/2", "3/4", "15/4", "8/15", "255/2"] {
        assert_right("cpu", &Baker::cpu(), &map, options(text, UNORM8), ParallaxFormat::default());
    }
}

#[test]
fn levels_have_the_sizes_of_a_mip_chain() {
    let sizes = |width, height| -> Vec<String> {
        let map = map_u8(width, height, |x, y| (x * y) as u8);
        let levels = Baker::cpu().normal_levels(&map, &options("24", UNORM8)).expect("levels");
        levels.iter().map(|level| level.size().to_string()).collect()
    };
    assert_eq!(sizes(8, 8), ["8 x 8", "4 x 4", "2 x 2", "1 x 1"]);
    assert_eq!(sizes(13, 3), ["13 x 3", "6 x 1", "3 x 1", "1 x 1"]);
    assert_eq!(sizes(1, 5), ["1 x 5", "1 x 2", "1 x 1"]);
    assert_eq!(sizes(1, 1), ["1 x 1"]);
    for (width, height) in [(1, 1), (17, 100), (4096, 3), (65_535, 65_536)] {
        let size = Size::new(width, height).expect("a size");
        assert_eq!(size.levels().collect::<Vec<_>>(), level_sizes(size));
    }
}

/// The largest level is the map without mips, in both precisions.
#[test]
fn level_0_is_the_map() {
    let map = map_u16(33, 20, |x, y| (x * 1999 + y * 777) as u16);
    for precision in [texbake::Precision::Exact, texbake::Precision::Fast] {
        let options = NormalOptions { precision, ..options("24", UNORM16) };
        for baker in [Baker::reference(), Baker::cpu(), Baker::cpu_threads(3).expect("threads")] {
            let levels = baker.normal_levels(&map, &options).expect("levels");
            assert_eq!(levels[0], baker.normal(&map, &options).expect("a map"));
            let exact = NormalOptions { precision: texbake::Precision::Exact, ..options };
            assert_levels("levels below the largest", &levels[1..], &integer_levels(&map, &exact)[1..]);
        }
    }
}
