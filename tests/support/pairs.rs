//! Height maps that contain chosen pairs of slope sums.

use super::{map_u8, map_u16};
use texbake::{Filter, HeightMap};

/// 1023 x 1023 heights of 8 bits whose central differences contain all 511 x 511 pairs (Gx, Gy).
///
/// A texel in an odd column and an odd row has its horizontal neighbours in even columns and odd rows, its vertical
/// ones in odd columns and even rows. So the first kind holds a walk along x with all 511 differences, the second one
/// along y, and the odd texels are their product.
pub fn every_difference_pair() -> HeightMap {
    let walk: Vec<u8> = (1..=255).rev().flat_map(|d| [0, d]).chain([0, 0]).collect();
    map_u8(1023, 1023, |x, y| match (x % 2, y % 2) {
        (0, 1) => walk[x / 2],
        (1, 0) => walk[y / 2],
        _ => 128,
    })
}

/// A map of 3 x 3 cells of 16-bit heights; the stencil sums at the cells' middles are the given pairs (Gx, Gy).
///
/// With any filter but central both sums must be even; see [`greatest_sum`].
pub fn map_of_pairs(filter: Filter, pairs: &[[i64; 2]]) -> HeightMap {
    assert!(!pairs.is_empty(), "a map has texels");
    let columns = (pairs.len() as f64).sqrt().ceil() as usize;
    let rows = pairs.len().div_ceil(columns);
    let cells: Vec<_> = pairs.iter().map(|&pair| cell(filter, pair)).collect();
    let flat = cell(filter, [0, 0]);
    map_u16(3 * columns, 3 * rows, |x, y| cells.get(y / 3 * columns + x / 3).unwrap_or(&flat)[y % 3][x % 3])
}

/// Stencil sums up to here can be made.
pub fn greatest_sum(filter: Filter) -> i64 {
    60_000 * weights(filter).0
}

/// Weights of the stencil's middle row and of the two beside it.
fn weights(filter: Filter) -> (i64, i64) {
    match filter {
        Filter::Central => (1, 0),
        Filter::Sobel => (2, 1),
        Filter::Scharr => (10, 3),
        Filter::Prewitt => (1, 1),
    }
}

/// 3 x 3 heights with the stencil sums (Gx, Gy) in the middle.
fn cell(filter: Filter, pair: [i64; 2]) -> [[u16; 3]; 3] {
    let (centre, outer) = weights(filter);
    // g = outer a + centre b; the corners make a, which is even, and the sides make b.
    let split = |g: i64| {
        let a = (0..10).step_by(2).find(|a| (g - outer * a) % centre == 0).expect("even sums can be made");
        (a, (g - outer * a) / centre)
    };
    let [(ax, bx), (ay, by)] = pair.map(split);
    const MIDDLE: i64 = 32767;
    let height = |code: i64| u16::try_from(code).expect("a sum in range");
    let sides = |b: i64| [height(MIDDLE - b.div_euclid(2)), height(MIDDLE - b.div_euclid(2) + b)];
    let ([w, e], [n, s]) = (sides(bx), sides(by));
    let [nw, ne, sw, se] = [0, (ax - ay) / 2, 0, (ax + ay) / 2].map(|step| height(MIDDLE + step));
    [[nw, n, ne], [w, 0, e], [sw, s, se]]
}
