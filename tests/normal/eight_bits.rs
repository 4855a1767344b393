//! 8-bit heights: every pair of central differences there is.

use crate::oracle;
use crate::support::{
    BIASED8, BIASED16, SNORM8, SNORM16, UNORM8, UNORM16, assert_every_baker, every_difference_pair, options,
};
use std::collections::HashSet;
use texbake::{Edges, Filter, NormalFormat};

/// Integer, fractional, huge, tiny, negative, zero; last two rich in ties: X : Z = -Gx : 4 and -Gx : 60, since
/// q D M = 510 q.
const SCALES: [&str; 12] =
    ["24", "7/3", "0.35", "1e6", "16777215", "1e-6", "1/16777215", "-24", "-7/3", "0", "255/2", "17/2"];

fn every_pair_is_right(format: NormalFormat, scales: &[&str]) {
    let map = every_difference_pair();
    for scale in scales {
        let options = options(scale, format);
        assert_every_baker(&map, &options, &oracle::image(&map, &options));
    }
}

#[test]
fn the_map_holds_all_511_x_511_pairs() {
    let map = every_difference_pair();
    let pairs: HashSet<_> = oracle::slope_sums(&map, Filter::Central, Edges::default()).into_iter().collect();
    for gx in -255..=255 {
        for gy in -255..=255 {
            assert!(pairs.contains(&[gx, gy]), "({gx}, {gy}) is missing");
        }
    }
    assert_eq!(pairs.len(), 261_121);
}

#[test]
fn two_scales_are_rich_in_ties() {
    let map = every_difference_pair();
    // Each texel without a slope along an axis is a tie on that axis; quadruples a^2 + b^2 + q^2 = d^2 with an even
    // 255 a / d come on top, counted by a program of their own.
    let flat = oracle::slope_sums(&map, Filter::Central, Edges::default()).into_iter().flatten().filter(|g| *g == 0);
    let flat = flat.count();
    for (scale, quadruples) in [("255/2", 164), ("17/2", 188)] {
        assert_eq!(oracle::ties(&map, &options(scale, UNORM8)) - flat, quadruples, "{scale}");
    }
}

#[test]
fn every_pair_in_unorm_8() {
    every_pair_is_right(UNORM8, &SCALES);
}

#[test]
fn every_pair_in_unorm_16() {
    every_pair_is_right(UNORM16, &SCALES);
}

#[test]
fn every_pair_in_snorm_8() {
    every_pair_is_right(SNORM8, &SCALES);
}

#[test]
fn every_pair_in_snorm_16() {
    every_pair_is_right(SNORM16, &SCALES);
}

#[test]
fn every_pair_in_biased() {
    every_pair_is_right(BIASED8, &["24", "-7/3"]);
    every_pair_is_right(BIASED16, &["24", "-7/3"]);
}
