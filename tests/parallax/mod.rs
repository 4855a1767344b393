//! Height maps to parallax maps, alone, beside normal maps and from given normals.

mod closed_forms;
mod fused;
mod given_normals;
mod heights;
mod sixteen_bits;

use crate::oracle::parallax;
use crate::support::assert_every_parallax;
use texbake::{HeightMap, ParallaxOptions};

/// Every baker makes the oracle's parallax map of integer heights.
fn assert_right(map: &HeightMap, options: &ParallaxOptions) {
    assert_every_parallax(map, options, &parallax(map, options).image);
}
