//! Every edge on either axis, every filter, every awkward size.

use super::float_heights::assert_within_bound;
use crate::oracle;
use crate::support::{
    EDGES, FILTERS, FLOAT32, Image, Random, SNORM16, Subject, UNORM8, assert_every_baker, assert_same, every_baker,
    every_edges, map_f32, map_u8, map_u16, options,
};
use texbake::{Edges, NormalOptions};

const SIZES: [[usize; 2]; 13] =
    [[1, 1], [1, 7], [7, 1], [2, 2], [2, 3], [3, 2], [3, 3], [5, 3], [13, 11], [31, 37], [64, 1], [1, 65], [97, 5]];

#[test]
fn u8_heights() {
    let mut random = Random::new(8);
    for [width, height] in SIZES {
        let map = map_u8(width, height, |_, _| random.bits() as u8);
        for_all_edges_and_filters(&options("7/3", UNORM8), |options| {
            assert_every_baker(&map, options, &oracle::image(&map, options));
        });
    }
}

#[test]
fn u16_heights() {
    let mut random = Random::new(16);
    for [width, height] in SIZES {
        let map = map_u16(width, height, |_, _| random.bits() as u16);
        for_all_edges_and_filters(&options("7/3", SNORM16), |options| {
            assert_every_baker(&map, options, &oracle::image(&map, options));
        });
    }
}

#[test]
fn f32_heights() {
    let mut random = Random::new(32);
    for [width, height] in SIZES {
        let map = map_f32(width, height, |_, _| random.below(1000) as f32 / 1000.0);
        for_all_edges_and_filters(&options("7/3", FLOAT32), |options| {
            let mut reference = None;
            for Subject { name, baker } in every_baker() {
                let baked = Image::from(&baker.normal(&map, options).expect("a bake"));
                assert_within_bound(&map, options, &baked);
                assert_same(
                    format_args!("{name}, {options:?}"),
                    &baked,
                    reference.get_or_insert_with(|| baked.clone()),
                );
            }
        });
    }
}

/// Tall, so that every backend needs several bands, and in rows that no vector and no word divides.
#[test]
fn maps_of_many_bands() {
    let mut random = Random::new(64);
    let bytes = map_u8(61, 5003, |_, _| random.bits() as u8);
    let words = map_u16(61, 5003, |_, _| random.bits() as u16);
    for (filter, edge) in FILTERS.into_iter().zip(EDGES.into_iter().cycle()) {
        let options = NormalOptions { filter, edges: Edges::both(edge), ..options("24", UNORM8) };
        for map in [&bytes, &words] {
            assert_every_baker(map, &options, &oracle::image(map, &options));
        }
    }
}

/// Wide, with one row or few.
#[test]
fn wide_maps() {
    let mut random = Random::new(128);
    let map = map_u16(70_001, 3, |_, _| random.bits() as u16);
    for edge in EDGES {
        let options = NormalOptions { edges: Edges::both(edge), ..options("24", UNORM8) };
        assert_every_baker(&map, &options, &oracle::image(&map, &options));
    }
}

fn for_all_edges_and_filters(options: &NormalOptions, mut check: impl FnMut(&NormalOptions)) {
    for edges in every_edges() {
        for filter in FILTERS {
            check(&NormalOptions { edges, filter, ..*options });
        }
    }
}
