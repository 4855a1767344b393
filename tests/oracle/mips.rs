//! Mip levels: means of slopes over rectangles of texels, by their definition.
//!
//! Integer heights: each texel of level 0 counts by the area that a texel of the level covers of it, in whole numbers of
//! 1/(w_k h_k) of a texel. Floats: sums in f64 in the order that the documentation gives, one rounding of the mean to
//! f32, and from there f32 as in level 0.

use super::floats::{least, stored, unit};
use super::integer::Factors;
use super::rounding::{rounded, square};
use super::slopes::{axis_scales, neighbourhoods, slope_sums, stencil};
use crate::support::Image;
use num_bigint::BigInt;
use num_integer::gcd;
use num_traits::ToPrimitive;
use texbake::{Convention, HeightMap, Heights, NormalOptions, ParallaxFormat, ParallaxOptions, Size};

/// The sizes of all levels.
pub fn level_sizes(size: Size) -> Vec<Size> {
    let mut sizes = vec![size];
    let mut shift = 1;
    while sizes.last().is_some_and(|last| last.texels() > 1) {
        let half = |side: usize| (side >> shift).max(1);
        sizes.push(Size::new(half(size.width()), half(size.height())).expect("a size"));
        shift += 1;
    }
    sizes
}

/// How much of texel `x` of `n` texel `i` of `count` covers, in parts of which a texel has `count`.
fn overlap(n: usize, count: usize, i: usize, x: usize) -> usize {
    ((i + 1) * n).min((x + 1) * count).saturating_sub((i * n).max(x * count))
}

/// The texels of `n` that texel `i` of `count` covers, with what it covers of them.
pub(super) fn covered(n: usize, count: usize, i: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).map(move |x| (x, overlap(n, count, i, x))).filter(|(_, part)| *part > 0)
}

/// The sums of one value of each texel over each texel of a level, by area.
fn area_sums(values: &[i64], size: Size, level: Size) -> Vec<i64> {
    let mut sums = Vec::new();
    for j in 0..level.height() {
        for i in 0..level.width() {
            let rows = covered(size.height(), level.height(), j);
            sums.push(
                rows.flat_map(|(y, part)| {
                    let columns = covered(size.width(), level.width(), i);
                    columns.map(move |(x, width)| values[y * size.width() + x] * (part * width) as i64)
                })
                .sum(),
            );
        }
    }
    sums
}

/// The normals of each level times some number, and the sums of 2H - M with what they are over.
struct LevelSums {
    size: Size,
    normals: Vec<[BigInt; 3]>,
    relief: Vec<i64>,
    /// The area of a texel.
    area: i64,
}

fn integer_sums(map: &HeightMap, options: &NormalOptions) -> Vec<LevelSums> {
    let factors = Factors::new(map, options);
    let slopes = slope_sums(map, options.filter, options.edges);
    let (gx, gy): (Vec<i64>, Vec<i64>) = slopes.into_iter().map(|[gx, gy]| (gx, gy)).unzip();
    let relief: Vec<i64> = match map.heights() {
        Heights::U8(codes) => codes.iter().map(|&code| 2 * i64::from(code) - 255).collect(),
        Heights::U16(codes) => codes.iter().map(|&code| 2 * i64::from(code) - 65_535).collect(),
        Heights::F32(_) => panic!("float heights have no integer sums"),
    };
    let level = |size: Size| {
        // Each sum counts parts of which a texel has w_k h_k, and a texel of the level is w h of them.
        let area = map.size().texels() as i64;
        let [gx, gy, relief] = [&gx, &gy, &relief].map(|values| area_sums(values, map.size(), size));
        let normal = |(gx, gy): (&i64, &i64)| {
            let [x, y, z] = factors.normal([*gx, *gy]);
            [x, y, z * area]
        };
        LevelSums { size, normals: gx.iter().zip(&gy).map(normal).collect(), relief, area }
    };
    level_sizes(map.size()).into_iter().map(level).collect()
}

/// The codes of all levels of a normal map of integer heights.
pub fn integer_levels(map: &HeightMap, options: &NormalOptions) -> Vec<Image> {
    let format = options.format;
    let image = |LevelSums { size, normals, .. }: LevelSums| {
        let codes = |normal: [BigInt; 3]| {
            let s = square(&normal);
            normal.map(|part| rounded(part, &s, format.encoding, format.depth).bits)
        };
        let texels = normals.into_iter().map(codes);
        let bits = texels.flat_map(|texel| texel.into_iter().take(format.channels.count())).collect();
        Image { size, format, bits }
    };
    integer_sums(map, options).into_iter().map(image).collect()
}

/// The codes of all levels of a parallax map of integer heights.
pub fn integer_parallax_levels(map: &HeightMap, options: &ParallaxOptions) -> Vec<Image<ParallaxFormat>> {
    let ParallaxOptions { scale, filter, edges, format, .. } = *options;
    let greatest = i64::from(map.height_type().greatest_code().expect("integer heights"));
    let image = |LevelSums { size, normals, relief, area }: LevelSums| {
        let code = |(normal, relief): (&[BigInt; 3], &i64)| {
            // z / |n| times the sum over the area times M.
            let s = square(normal) * (area * area) * (greatest * greatest);
            rounded(normal[2].clone() * *relief, &s, format.encoding, format.depth).bits
        };
        Image { size, format, bits: normals.iter().zip(&relief).map(code).collect() }
    };
    let normals = NormalOptions { scale, filter, edges, ..Default::default() };
    integer_sums(map, &normals).into_iter().map(image).collect()
}

/// What the wrong way would give: the mean of the real normals of a level's texels, at unit length.
pub fn mean_normals(map: &HeightMap, options: &NormalOptions, level: Size) -> Vec<[f64; 3]> {
    let unit: Vec<[f64; 3]> = integer_sums(map, options)[0]
        .normals
        .iter()
        .map(|normal| {
            let [x, y, z] = normal.each_ref().map(|part| part.to_f64().expect("finite"));
            let length = (x * x + y * y + z * z).sqrt();
            [x / length, y / length, z / length]
        })
        .collect();
    let (size, mut means) = (map.size(), Vec::new());
    for j in 0..level.height() {
        for i in 0..level.width() {
            let mut sum = [0.0; 3];
            for (y, part) in covered(size.height(), level.height(), j) {
                for (x, width) in covered(size.width(), level.width(), i) {
                    let normal = unit[y * size.width() + x];
                    sum = std::array::from_fn(|axis| sum[axis] + normal[axis] * (part * width) as f64);
                }
            }
            let length = sum.iter().map(|part| part * part).sum::<f64>().sqrt();
            means.push(sum.map(|part| part / length));
        }
    }
    means
}

/// The level from whose sums those of level `level` are made: the coarsest finer one of which each texel is made of whole
/// ones, and whose parts of a texel are the same; or level 0.
fn source(sizes: &[Size], level: usize) -> usize {
    let side = |size: Size, axis: usize| [size.width(), size.height()][axis];
    // Of n texels, a border of a level of c is at a multiple of n/c: in parts of 1/parts(c) it is whole.
    let parts = |c: usize, axis: usize| c / gcd(side(sizes[0], axis), c);
    (1..level)
        .rev()
        .find(|&finer| {
            (0..2).all(|axis| {
                let [fine, coarse] = [finer, level].map(|level| side(sizes[level], axis));
                fine % coarse == 0 && parts(fine, axis) == parts(coarse, axis)
            })
        })
        .unwrap_or(0)
}

/// Sums of float planes over the texels of each level, in the documented order.
fn float_sums(planes: &[Vec<f64>], sizes: &[Size]) -> Vec<Vec<Vec<f64>>> {
    let mut levels = vec![planes.to_vec()];
    for level in 1..sizes.len() {
        let source = source(sizes, level);
        let (fine, coarse) = (sizes[source], sizes[level]);
        let [parts_x, parts_y] =
            [coarse.width() / gcd(coarse.width(), fine.width()), coarse.height() / gcd(coarse.height(), fine.height())];
        // Overlaps have w_k parts to a texel; the sums have as few as are whole.
        let weight = |overlap: usize, count: usize, parts: usize| (overlap / (count / parts)) as f64;
        let plane = |plane: &Vec<f64>| {
            let mut sums = Vec::new();
            for j in 0..coarse.height() {
                let mut rows: Vec<_> = covered(fine.height(), coarse.height(), j).collect();
                if j == 0 {
                    rows.rotate_left(1);
                }
                for i in 0..coarse.width() {
                    let columns: Vec<_> = covered(fine.width(), coarse.width(), i).collect();
                    let along = |y: usize| {
                        let texel = |x: usize| plane[y * fine.width() + x];
                        let times = |value: f64, part: usize| value * weight(part, coarse.width(), parts_x);
                        let [(first, left), between @ .., (last, right)] = &columns[..] else {
                            return times(texel(columns[0].0), columns[0].1);
                        };
                        let whole = between.iter().fold(0.0, |sum, (x, _)| sum + texel(*x));
                        times(texel(*first), *left) + times(whole, coarse.width()) + times(texel(*last), *right)
                    };
                    sums.push(
                        rows.iter()
                            .fold(0.0, |sum, (y, part)| sum + along(*y) * weight(*part, coarse.height(), parts_y)),
                    );
                }
            }
            sums
        };
        let sums = levels[source].iter().map(plane).collect();
        levels.push(sums);
    }
    levels
}

/// A unit normal and a mean height.
type FloatTexel = ([f32; 3], f32);

/// The unit normals and the mean heights, at least 0 and at most 1, of all levels of float heights.
fn float_texels(map: &HeightMap, options: &NormalOptions) -> Vec<(Size, Vec<FloatTexel>)> {
    let Heights::F32(heights) = map.heights() else { panic!("heights are floats here") };
    let (weights, divisor) = stencil(options.filter);
    let [centre, outer] = [weights[1][2] as f32, weights[0][2] as f32];
    let small = |height: f32| least(2f32.powi(-90), height) / 64.0;
    let sums = |around: [[f32; 3]; 3]| {
        let [[nw, n, ne], [w, _, e], [sw, s, se]] = around.map(|row| row.map(small));
        [outer * ((ne - nw) + (se - sw)) + centre * (e - w), outer * ((sw - nw) + (se - ne)) + centre * (s - n)]
    };
    let slopes: Vec<[f32; 2]> = neighbourhoods(heights, map.size(), options.edges).map(sums).collect();
    let planes = [
        slopes.iter().map(|[gx, _]| f64::from(*gx)).collect(),
        slopes.iter().map(|[_, gy]| f64::from(*gy)).collect(),
        heights.iter().map(|height| f64::from(height.clamp(0.0, 1.0))).collect(),
    ];
    let factor = axis_scales(options.scale, map.size())
        .map(|(n, d)| (n.to_f64().expect("finite") / (d * divisor).to_f64().expect("finite")) as f32 * 64.0);
    let green = if options.format.convention == Convention::Gl { 1.0 } else { -1.0 };
    let sizes = level_sizes(map.size());
    let texels = |(size, sums): (&Size, Vec<Vec<f64>>)| {
        let area = |n: usize, count: usize| n / gcd(n, count);
        let weight = area(map.size().width(), size.width()) * area(map.size().height(), size.height());
        let mean = |plane: usize, texel: usize| (sums[plane][texel] / weight as f64) as f32;
        let texel = |texel: usize| {
            let snapped = |slope| least(2f32.powi(-25), slope);
            let (x, y) = (snapped(mean(0, texel) * -factor[0]), snapped(mean(1, texel) * (green * factor[1])));
            (unit([x, y, 1.0]), mean(2, texel))
        };
        (*size, (0..size.texels()).map(texel).collect())
    };
    sizes.iter().zip(float_sums(&planes, &sizes)).map(texels).collect()
}

/// The codes of all levels of a normal map of float heights.
pub fn float_levels(map: &HeightMap, options: &NormalOptions) -> Vec<Image> {
    let format = options.format;
    let image = |(size, texels): (Size, Vec<FloatTexel>)| {
        let components = texels.iter().flat_map(|(normal, _)| &normal[..format.channels.count()]);
        Image { size, format, bits: components.map(|v| stored(*v, format)).collect() }
    };
    float_texels(map, options).into_iter().map(image).collect()
}

/// The codes of all levels of a parallax map of float heights.
pub fn float_parallax_levels(map: &HeightMap, options: &ParallaxOptions) -> Vec<Image<ParallaxFormat>> {
    let ParallaxOptions { scale, filter, edges, format, .. } = *options;
    let parallax = |(normal, height): &FloatTexel| least(2f32.powi(-100), normal[2] * (2.0 * height - 1.0));
    let image = |(size, texels): (Size, Vec<FloatTexel>)| Image {
        size,
        format,
        bits: texels.iter().map(|texel| stored(parallax(texel), format)).collect(),
    };
    let normals = NormalOptions { scale, filter, edges, ..Default::default() };
    float_texels(map, &normals).into_iter().map(image).collect()
}
