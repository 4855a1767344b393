//! Normal maps of integer heights.

use super::rounding::{Rounded, Whole, rounded, square};
use super::slopes::{axis_scales, slope_sums, stencil};
use crate::support::Image;
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::ToPrimitive;
use std::collections::HashMap;
use texbake::{Convention, HeightMap, NormalFormat, NormalOptions};

/// The codes of a normal map.
pub fn image(map: &HeightMap, options: &NormalOptions) -> Image {
    let channels = options.format.channels.count();
    let bits = texels(map, options).iter().flat_map(|texel| &texel[..channels]).map(|rounded| rounded.bits).collect();
    Image { size: map.size(), format: options.format, bits }
}

/// How many codes lie exactly half-way between two integers before they are rounded.
pub fn ties(map: &HeightMap, options: &NormalOptions) -> usize {
    let channels = options.format.channels.count();
    texels(map, options).iter().flat_map(|texel| &texel[..channels]).filter(|rounded| rounded.tie).count()
}

fn texels(map: &HeightMap, options: &NormalOptions) -> Vec<[Rounded; 3]> {
    let factors = Factors::new(map, options);
    let rounded = |sums| match factors.small() {
        Some(factors) => factors.rounded(sums, options.format),
        None => factors.rounded(sums, options.format),
    };
    let mut known = HashMap::new();
    let sums = slope_sums(map, options.filter, options.edges);
    sums.into_iter().map(|sums| *known.entry(sums).or_insert_with(|| rounded(sums))).collect()
}

/// The normal is (x Gx, y Gy, z) over its length.
pub struct Factors<T> {
    x: T,
    y: T,
    pub z: T,
}

impl Factors<BigInt> {
    /// Eq. 7.43, (-dx, -dy, 1) with dx = s_x Gx / (D M) and s_x = n_x / d_x, times d_x d_y D M.
    pub fn new(map: &HeightMap, options: &NormalOptions) -> Self {
        let (_, divisor) = stencil(options.filter);
        let greatest = map.height_type().greatest_code().expect("integer heights");
        let [(nx, dx), (ny, dy)] = axis_scales(options.scale, map.size());
        let x = -nx * &dy;
        let y = match options.format.convention {
            Convention::Dx => -ny * &dx,
            Convention::Gl => ny * &dx,
        };
        let z = dx * dy * divisor * greatest;
        let common = x.gcd(&y).gcd(&z);
        Self { x: x / &common, y: y / &common, z: z / common }
    }

    /// The same in 128 bits, if (2^16 A)^2 and S fit: |G| is below 2^21.
    pub fn small(&self) -> Option<Factors<i128>> {
        let fits = self.x.bits().max(self.y.bits()) <= 24 && self.z.bits() <= 46;
        let small = |factor: &BigInt| factor.to_i128().filter(|_| fits);
        Some(Factors { x: small(&self.x)?, y: small(&self.y)?, z: small(&self.z)? })
    }
}

impl<T: Whole> Factors<T> {
    /// The normal of two stencil sums, times some number.
    pub fn normal(&self, [gx, gy]: [i64; 2]) -> [T; 3] {
        [self.x.clone() * gx.into(), self.y.clone() * gy.into(), self.z.clone()]
    }

    fn rounded(&self, sums: [i64; 2], format: NormalFormat) -> [Rounded; 3] {
        let normal = self.normal(sums);
        let square = square(&normal);
        normal.map(|part| rounded(part, &square, format.encoding, format.depth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::{FORMATS, Random, UNORM8, map_u16, options};
    use texbake::Channels;

    #[test]
    fn big_and_small_integers_agree() {
        let mut random = Random::new(1);
        let map = map_u16(31, 29, |_, _| random.bits() as u16);
        for format in FORMATS {
            let options = options("16777215/16777213", format);
            let big = Factors::new(&map, &options);
            let small = big.small().expect("parts below 2^24");
            for sums in slope_sums(&map, options.filter, options.edges) {
                assert_eq!(big.rounded(sums, format), small.rounded(sums, format), "{sums:?}, {format:?}");
            }
        }
    }

    #[test]
    fn two_channels_are_cut_off() {
        let map = map_u16(2, 2, |x, _| 100 * x as u16);
        let mut options = options("24", UNORM8);
        options.format.channels = Channels::Xy;
        assert_eq!(image(&map, &options).bits.len(), 8);
    }
}
