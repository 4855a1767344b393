//! Neighbours, stencils and scales.

use num_bigint::BigInt;
use texbake::{Edge, Edges, Filter, HeightMap, Heights, Scale, Size};

/// The texel that stands for texel `i` of an axis of `n`, one step beyond the border at most.
fn neighbour(edge: Edge, i: i64, n: i64) -> i64 {
    match edge {
        _ if 0 <= i && i < n => i,
        _ if n == 1 => 0,
        Edge::Wrap => (i + n) % n,
        Edge::Clamp if i < 0 => 0,
        Edge::Clamp => n - 1,
        Edge::Mirror if i < 0 => 1,
        Edge::Mirror => n - 2,
    }
}

/// The 3 x 3 values around each texel, in reading order.
pub fn neighbourhoods<'a, T: Copy>(
    texels: &'a [T],
    size: Size,
    edges: Edges,
) -> impl Iterator<Item = [[T; 3]; 3]> + use<'a, T> {
    let (width, height) = (size.width() as i64, size.height() as i64);
    (0..width * height).map(move |i| {
        let (x, y) = (i % width, i / width);
        [-1, 0, 1].map(|down| {
            [-1, 0, 1].map(|right| {
                let (column, row) = (neighbour(edges.x, x + right, width), neighbour(edges.y, y + down, height));
                texels[(row * width + column) as usize]
            })
        })
    })
}

/// Weights of the slope along x, rows from the top, and what their sum is to be divided by; transposed for y.
pub fn stencil(filter: Filter) -> ([[i64; 3]; 3], i64) {
    match filter {
        Filter::Central => ([[0, 0, 0], [-1, 0, 1], [0, 0, 0]], 2),
        Filter::Sobel => ([[-1, 0, 1], [-2, 0, 2], [-1, 0, 1]], 8),
        Filter::Scharr => ([[-3, 0, 3], [-10, 0, 10], [-3, 0, 3]], 32),
        Filter::Prewitt => ([[-1, 0, 1], [-1, 0, 1], [-1, 0, 1]], 6),
    }
}

/// The stencil sums (Gx, Gy) of each texel of an integer map.
pub fn slope_sums(map: &HeightMap, filter: Filter, edges: Edges) -> Vec<[i64; 2]> {
    let heights: Vec<i64> = match map.heights() {
        Heights::U8(codes) => codes.iter().map(|&code| code.into()).collect(),
        Heights::U16(codes) => codes.iter().map(|&code| code.into()).collect(),
        Heights::F32(_) => panic!("float heights have no integer sums"),
    };
    let (weights, _) = stencil(filter);
    let sums = |around: [[i64; 3]; 3]| {
        let mut sums = [0, 0];
        for row in 0..3 {
            for column in 0..3 {
                sums[0] += weights[row][column] * around[row][column];
                sums[1] += weights[column][row] * around[row][column];
            }
        }
        sums
    };
    neighbourhoods(&heights, map.size(), edges).map(sums).collect()
}

/// The scale of each axis in texels as a fraction whose denominator is above zero.
pub fn axis_scales(scale: Scale, size: Size) -> [(BigInt, BigInt); 2] {
    match scale {
        Scale::Texels(s) => [0, 1].map(|_| (s.numerator().into(), s.denominator().into())),
        Scale::Physical { size: extents, depth } => {
            let counts = [size.width(), size.height()];
            [0, 1].map(|axis| {
                // depth / (extent / count)
                let above = BigInt::from(depth.numerator()) * extents[axis].denominator() * counts[axis];
                let below = BigInt::from(depth.denominator()) * extents[axis].numerator();
                (above, below)
            })
        }
    }
}

#[test]
fn neighbours_beyond_the_border() {
    for (edge, n, before, after) in [
        (Edge::Wrap, 4, 3, 0),
        (Edge::Clamp, 4, 0, 3),
        (Edge::Mirror, 4, 1, 2),
        (Edge::Mirror, 2, 1, 0),
        (Edge::Wrap, 1, 0, 0),
        (Edge::Clamp, 1, 0, 0),
        (Edge::Mirror, 1, 0, 0),
    ] {
        assert_eq!((neighbour(edge, -1, n), neighbour(edge, n, n)), (before, after), "{edge}, {n} texels");
    }
}

#[test]
fn every_stencil_gives_a_ramp_its_slope() {
    for filter in crate::support::FILTERS {
        let (weights, divisor) = stencil(filter);
        let along =
            |step: fn(usize, usize) -> i64| -> i64 { (0..9).map(|i| weights[i / 3][i % 3] * step(i / 3, i % 3)).sum() };
        assert_eq!(along(|_, column| column as i64), divisor, "{filter}");
        assert_eq!(along(|row, _| row as i64), 0, "{filter}");
    }
}
