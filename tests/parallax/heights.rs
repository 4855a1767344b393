//! 8-bit heights: every height beside every difference of its neighbours; any filter and edge.

use super::assert_right;
use crate::oracle::{parallax, slope_sums};
use crate::support::{FILTERS, Random, every_edges, map_u8, map_u16, number, parallax_formats, parallax_options};
use std::collections::HashSet;
use texbake::{Depth, Edges, Encoding, Filter, HeightMap, ParallaxFormat, ParallaxOptions, Scale};

/// 1023 x 513 heights of 8 bits that hold all 256 heights beside all 511 central differences along x.
///
/// Odd columns of odd rows hold the heights, a row for each; the even columns beside them walk through all differences;
/// even rows are one height, so that nothing slopes along y.
fn every_height_and_difference() -> HeightMap {
    let walk: Vec<u8> = (1..=255).rev().flat_map(|d| [0, d]).chain([0, 0]).collect();
    map_u8(1023, 513, |x, y| match (x % 2, y % 2) {
        (1, 1) => (y / 2) as u8,
        (0, 1) => walk[x / 2],
        _ => 77,
    })
}

fn integer_formats() -> impl Iterator<Item = ParallaxFormat> {
    parallax_formats().into_iter().filter(|format| !format.depth.is_float())
}

#[test]
fn the_map_holds_all_256_x_511_pairs() {
    let map = every_height_and_difference();
    let texbake::Heights::U8(heights) = map.heights() else { panic!("bytes") };
    let sums = slope_sums(&map, Filter::Central, Edges::default());
    let level = sums.iter().zip(heights).filter(|([_, gy], _)| *gy == 0);
    let pairs: HashSet<(i64, u8)> = level.map(|([gx, _], height)| (*gx, *height)).collect();
    for height in 0..=255 {
        assert!((-255..=255).all(|gx| pairs.contains(&(gx, height))), "height {height}");
    }
}

#[test]
fn every_height_beside_every_difference() {
    let map = every_height_and_difference();
    for format in integer_formats() {
        let scales: &[&str] = if format.encoding == Encoding::Biased { &["24"] } else { &["24", "7/3", "-255/2"] };
        for scale in scales {
            assert_right(&map, &parallax_options(scale, format));
        }
    }
}

/// X : Z = -Gx : 4 and -Gx : 60, as in normal/eight_bits.rs: 3-4-5 triangles and their kin.
#[test]
fn some_heights_are_ties() {
    let map = every_height_and_difference();
    let unorm = ParallaxFormat { encoding: Encoding::Unorm, depth: Depth::Bits8 };
    for scale in ["255/2", "17/2"] {
        let options = parallax_options(scale, unorm);
        // L n_z (2H - M)/M = n_z (2H - 255): even for n_z = 4/5 and 2H - 255 = 5 (2k + 1), never for n_z = 1.
        let ties = parallax(&map, &options).ties;
        assert!(ties > 100, "{scale}: {ties} ties");
        assert_right(&map, &options);
    }
}

#[test]
fn any_heights_filter_edge_and_scale() {
    let mut random = Random::new(0x9a7a);
    let bytes = map_u8(67, 31, |_, _| random.bits() as u8);
    let words = map_u16(67, 31, |x, _| if x < 40 { random.bits() as u16 } else { 33_000 + random.below(60) as u16 });
    let physical = Scale::physical(number("2"), number("0.5"), number("0.1"));
    for (i, filter) in FILTERS.into_iter().enumerate() {
        for (j, format) in parallax_formats().into_iter().enumerate() {
            // The oracle of floats is slow.
            let scales: &[&str] =
                if format.depth.is_float() { &["24"] } else { &["24", "16777215", "-1/16777215", "0.35"] };
            for map in [&bytes, &words] {
                for text in scales {
                    assert_right(map, &ParallaxOptions { filter, ..parallax_options(text, format) });
                }
                let edges = every_edges().nth((3 * i + j) % 9).expect("nine edges");
                assert_right(map, &ParallaxOptions { filter, edges, scale: physical, ..parallax_options("1", format) });
            }
        }
    }
}

#[test]
fn small_and_narrow_maps() {
    let mut random = Random::new(0x111);
    for (width, height) in [(1, 1), (1, 9), (9, 1), (2, 2), (3, 2), (5, 1), (33, 3)] {
        let map = map_u8(width, height, |_, _| random.bits() as u8);
        for format in integer_formats() {
            assert_right(&map, &parallax_options("24", format));
        }
    }
}
