//! Roughness of mip levels in f64, by the definitions: how far slopes, or normals, lie from their own mean.

use super::mips::{covered, level_sizes};
use super::slopes::{axis_scales, neighbourhoods, stencil};
use num_traits::ToPrimitive;
use texbake::{BakeOptions, HeightMap, Heights, RoughnessMethod, Size};

/// What is scattered less than this share of what it is scattered about is not scattered at all; nothing here lies
/// between that and [`SCATTERED`].
const EVEN: f64 = 1.0 / (1u64 << 45) as f64;

/// The least share that the roughness of a texel comes from.
pub const SCATTERED: f64 = 1.0 / (1u64 << 20) as f64;

/// The slopes (dx, dy) of each texel, y down the rows.
fn slopes(map: &HeightMap, options: &BakeOptions) -> Vec<[f64; 2]> {
    let heights: Vec<f64> = match map.heights() {
        Heights::U8(codes) => codes.iter().map(|&code| f64::from(code) / 255.0).collect(),
        Heights::U16(codes) => codes.iter().map(|&code| f64::from(code) / 65_535.0).collect(),
        Heights::F32(heights) => heights.iter().map(|&height| height.into()).collect(),
    };
    let (weights, divisor) = stencil(options.filter);
    let scales = axis_scales(options.scale, map.size())
        .map(|(n, d)| n.to_f64().expect("finite") / d.to_f64().expect("finite") / divisor as f64);
    let slope = |around: [[f64; 3]; 3]| {
        let sum = |axis: usize| {
            let weight = |row: usize, column: usize| [weights[row][column], weights[column][row]][axis] as f64;
            (0..9).map(|at| weight(at / 3, at % 3) * around[at / 3][at % 3]).sum::<f64>()
        };
        [scales[0] * sum(0), scales[1] * sum(1)]
    };
    neighbourhoods(&heights, map.size(), options.edges).map(slope).collect()
}

/// Their mean, and the mean square of their distance from it.
fn scatter<const N: usize>(vectors: &[(f64, [f64; N])]) -> ([f64; N], f64) {
    let area: f64 = vectors.iter().map(|(part, _)| part).sum();
    let mean = std::array::from_fn(|axis| vectors.iter().map(|(part, v)| part * v[axis]).sum::<f64>() / area);
    let distance = |v: &[f64; N]| (0..N).map(|axis| (v[axis] - mean[axis]).powi(2)).sum::<f64>();
    (mean, vectors.iter().map(|(part, v)| part * distance(v)).sum::<f64>() / area)
}

/// `scattered`, or nothing if it is none of `of`.
fn settled(scattered: f64, of: f64) -> f64 {
    assert!(scattered <= of * EVEN || scattered > of * SCATTERED, "{scattered} of {of} is neither much nor nothing");
    if scattered <= of * EVEN { 0.0 } else { scattered }
}

/// The roughness of a texel that covers these slopes, each by its part.
fn widened(method: RoughnessMethod, base: f64, slopes: &[(f64, [f64; 2])]) -> f64 {
    let alpha_squared = base.powi(4);
    match method {
        RoughnessMethod::Lean => {
            let ([dx, dy], variance) = scatter(slopes);
            (alpha_squared + settled(variance, variance + dx * dx + dy * dy)).min(1.0).powf(0.25)
        }
        RoughnessMethod::Toksvig => {
            let unit = |&(part, [dx, dy]): &(f64, [f64; 2])| {
                let length = (dx * dx + dy * dy + 1.0).sqrt();
                (part, [dx / length, dy / length, 1.0 / length])
            };
            // Of unit vectors, the mean square of their distance from their mean N is 1 - |N|^2.
            let (_, scattered) = scatter(&slopes.iter().map(unit).collect::<Vec<_>>());
            let length = (1.0 - settled(scattered, 1.0)).sqrt();
            let shorter = settled(scattered, 1.0) / (1.0 + length);
            let s = 2.0 / alpha_squared - 2.0;
            let widened = 1.0 / (1.0 / s + shorter / length);
            (2.0 / (widened + 2.0)).powf(0.25)
        }
    }
}

/// The roughness of each texel of all levels, from 0 to 1.
pub fn roughness(map: &HeightMap, options: &BakeOptions) -> Vec<(Size, Vec<f64>)> {
    let wanted = options.roughness.expect("roughness is asked for");
    let base = wanted.base.numerator() as f64 / wanted.base.denominator() as f64;
    let (slopes, size) = (slopes(map, options), map.size());
    let level = |level: Size| {
        let all = |n: usize, count: usize| (0..count).map(|i| covered(n, count, i).collect()).collect();
        let rows: Vec<Vec<(usize, usize)>> = all(size.height(), level.height());
        let columns: Vec<Vec<(usize, usize)>> = all(size.width(), level.width());
        let texel = |(rows, columns): (&Vec<_>, &Vec<_>)| {
            let parts =
                rows.iter().flat_map(|(y, height)| columns.iter().map(move |(x, width)| (y, x, height * width)));
            let under: Vec<_> = parts.map(|(y, x, part)| (part as f64, slopes[y * size.width() + x])).collect();
            widened(wanted.method, base, &under)
        };
        let texels = rows.iter().flat_map(|rows| columns.iter().map(move |columns| (rows, columns)));
        (level, texels.map(texel).collect())
    };
    level_sizes(size).into_iter().map(level).collect()
}
