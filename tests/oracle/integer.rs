//! Codes of integer heights: A / sqrt(S) rounded by integer square roots.
//!
//! floor(m |A| / sqrt(S)) is the integer square root of floor(m^2 A^2 / S), and it is exact if its square times S is
//! m^2 A^2. Both encodings follow from that floor, since floor((r + n) / 2) = floor((floor(r) + n) / 2) for integers n.

use super::nearest_float::FloatLayout;
use super::slopes::{axis_scales, slope_sums, stencil};
use crate::support::Image;
use num_bigint::BigInt;
use num_integer::{Integer, Roots};
use num_traits::{Signed, ToPrimitive};
use std::collections::HashMap;
use texbake::{Channels, Convention, Depth, Encoding, HeightMap, NormalFormat, NormalOptions};

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

/// A code as it is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rounded {
    bits: u32,
    tie: bool,
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

/// Integers of any width.
trait Whole: Clone + Integer + Signed + Roots + From<i64> + ToPrimitive + Into<BigInt> {}
impl<T: Clone + Integer + Signed + Roots + From<i64> + ToPrimitive + Into<BigInt>> Whole for T {}

/// The normal is (x Gx, y Gy, z) over its length.
struct Factors<T> {
    x: T,
    y: T,
    z: T,
}

impl Factors<BigInt> {
    /// Eq. 7.43, (-dx, -dy, 1) with dx = s_x Gx / (D M) and s_x = n_x / d_x, times d_x d_y D M.
    fn new(map: &HeightMap, options: &NormalOptions) -> Self {
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
    fn small(&self) -> Option<Factors<i128>> {
        let fits = self.x.bits().max(self.y.bits()) <= 24 && self.z.bits() <= 46;
        let small = |factor: &BigInt| factor.to_i128().filter(|_| fits);
        Some(Factors { x: small(&self.x)?, y: small(&self.y)?, z: small(&self.z)? })
    }
}

impl<T: Whole> Factors<T> {
    fn rounded(&self, [gx, gy]: [i64; 2], format: NormalFormat) -> [Rounded; 3] {
        let normal = [self.x.clone() * gx.into(), self.y.clone() * gy.into(), self.z.clone()];
        let square = normal.iter().fold(T::zero(), |sum, part| sum + part.clone() * part.clone());
        normal.map(|part| match format.depth {
            Depth::Float16 => {
                Rounded { bits: FloatLayout::F16.nearest(&part.into(), &square.clone().into()), tie: false }
            }
            Depth::Float32 => {
                Rounded { bits: FloatLayout::F32.nearest(&part.into(), &square.clone().into()), tie: false }
            }
            Depth::Bits8 => code(part, &square, format.encoding, 8),
            Depth::Bits16 => code(part, &square, format.encoding, 16),
        })
    }
}

/// The nearest code of `bits` bits to a / sqrt(s).
fn code<T: Whole>(a: T, s: &T, encoding: Encoding, bits: u32) -> Rounded {
    let mask = (1 << bits) - 1;
    let half_up = |doubled: i64, exact: bool| ((doubled + 1).div_euclid(2), exact && doubled.rem_euclid(2) == 1);
    match encoding {
        Encoding::Unorm => {
            // L (v + 1) / 2 is half of L v + L.
            let greatest = (1 << bits) - 1;
            let (floor, exact) = floor_of_multiple(greatest, a, s);
            let (code, tie) = half_up(floor + greatest, exact);
            Rounded { bits: code as u32, tie }
        }
        Encoding::Snorm | Encoding::Biased => {
            let greatest = (1 << (bits - 1)) - 1;
            let (floor, exact) = floor_of_multiple(2 * greatest, a, s);
            let (code, tie) = half_up(floor, exact);
            assert!(!tie, "a sum of three squares that is 4^k times an odd square halves to no integer");
            let offset = if encoding == Encoding::Biased { greatest + 1 } else { 0 };
            Rounded { bits: (code + offset) as u32 & mask, tie }
        }
        Encoding::Float => panic!("floats have no codes"),
    }
}

/// floor(m a / sqrt(s)), and whether nothing was cut off.
fn floor_of_multiple<T: Whole>(m: i64, a: T, s: &T) -> (i64, bool) {
    let negative = a.is_negative();
    let multiple = T::from(m) * a;
    let square = multiple.clone() * multiple;
    let root = (square.clone() / s.clone()).sqrt();
    let exact = root.clone() * root.clone() * s.clone() == square;
    let root = root.to_i64().expect("no component is above 1");
    if negative { (-root - i64::from(!exact), exact) } else { (root, exact) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::{BIASED8, FORMATS, Random, SNORM8, UNORM8, UNORM16, map_u16, options};

    fn codes(normal: [i64; 3], format: NormalFormat) -> [(u32, bool); 3] {
        let square: i64 = normal.iter().map(|part| part * part).sum();
        normal.map(|part| {
            let bits = 8 * format.depth.bytes() as u32;
            let Rounded { bits, tie } = code(BigInt::from(part), &square.into(), format.encoding, bits);
            (bits, tie)
        })
    }

    #[test]
    fn known_vectors_have_known_codes() {
        // 127.5 (v + 1): 212.5, 170, 212.5.
        assert_eq!(codes([2, 1, 2], UNORM8), [(213, true), (170, false), (213, true)]);
        // 42.5 rounds up as well.
        assert_eq!(codes([-2, -1, 2], UNORM8), [(43, true), (85, false), (213, true)]);
        // 204, 127.5, 229.5.
        assert_eq!(codes([3, 0, 4], UNORM8), [(204, false), (128, true), (230, true)]);
        assert_eq!(codes([0, 0, 1], UNORM8), [(128, true), (128, true), (255, false)]);
        // 32767.5 (v + 1): 54612.5 and 43690.
        assert_eq!(codes([2, 1, 2], UNORM16), [(54613, true), (43690, false), (54613, true)]);
        // 127 v: -84.67, 42.33, 84.67; -84 and -85 as bytes are 172 and 171.
        assert_eq!(codes([-2, 1, 2], SNORM8), [(171, false), (42, false), (85, false)]);
        assert_eq!(codes([-2, 0, 2], BIASED8), [(38, false), (128, false), (218, false)]);
        assert_eq!(codes([-1, 0, 0], SNORM8)[0], (129, false));
    }

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
