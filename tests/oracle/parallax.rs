//! Parallax maps of integer heights: n_z (2h - 1) is z (2H - M) over M times the normal's length (FGED2 section 7.7).

use super::Exact;
use super::integer::Factors;
use super::rounding::{Rounded, Whole, rounded, rounded_wide, square};
use super::slopes::slope_sums;
use super::texels::{UnormZero, normals};
use crate::support::Image;
use std::collections::HashMap;
use texbake::{HeightMap, Heights, NormalMap, NormalOptions, ParallaxFormat, ParallaxOptions, Size};

/// The parallax map of heights with their own normals.
pub fn parallax(map: &HeightMap, options: &ParallaxOptions) -> Exact<ParallaxFormat> {
    let ParallaxOptions { scale, filter, edges, format, .. } = *options;
    let factors = Factors::new(map, &NormalOptions { scale, filter, edges, ..Default::default() });
    let (heights, greatest) = codes(map);
    // z (2H - M) of at most 46 bits fits 128 bits with its square and the code's.
    let small = factors.small().filter(|factors| factors.z < 1 << 30);
    let mut known = HashMap::new();
    let texels = slope_sums(map, filter, edges).into_iter().zip(heights).map(|(sums, height)| {
        *known.entry((sums, height)).or_insert_with(|| match &small {
            Some(factors) => code(factors, sums, height, greatest, format),
            None => code(&factors, sums, height, greatest, format),
        })
    });
    stored(texels, map.size(), format)
}

fn code<T: Whole>(factors: &Factors<T>, sums: [i64; 2], height: i64, greatest: i64, format: ParallaxFormat) -> Rounded {
    let normal = factors.normal(sums);
    let s = square(&normal) * T::from(greatest * greatest);
    rounded(factors.z.clone() * T::from(2 * height - greatest), &s, format.encoding, format.depth)
}

/// The parallax map of heights with the normals of a map.
pub fn parallax_with_normals(map: &HeightMap, normal_map: &NormalMap, format: ParallaxFormat) -> Exact<ParallaxFormat> {
    let (heights, greatest) = codes(map);
    let normals = normals(normal_map, normal_map.format().convention, UnormZero::Zero).vectors;
    let texels = normals.into_iter().zip(heights).map(|(normal, height)| {
        let normal = normal.map(i128::from);
        let a = normal[2] * i128::from(2 * height - greatest);
        rounded_wide(a, square(&normal) * i128::from(greatest * greatest), format.encoding, format.depth)
    });
    stored(texels, map.size(), format)
}

fn stored(texels: impl Iterator<Item = Rounded>, size: Size, format: ParallaxFormat) -> Exact<ParallaxFormat> {
    let rounded: Vec<Rounded> = texels.collect();
    let ties = rounded.iter().filter(|rounded| rounded.tie).count();
    Exact { image: Image { size, format, bits: rounded.iter().map(|rounded| rounded.bits).collect() }, ties }
}

/// The codes of all heights, and that of h = 1.
fn codes(map: &HeightMap) -> (Vec<i64>, i64) {
    match map.heights() {
        Heights::U8(codes) => (codes.iter().map(|&code| code.into()).collect(), 255),
        Heights::U16(codes) => (codes.iter().map(|&code| code.into()).collect(), 65_535),
        Heights::F32(_) => panic!("float heights have no codes"),
    }
}
