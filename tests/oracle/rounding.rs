//! A / sqrt(S) as codes, by integer square roots.
//!
//! floor(m |A| / sqrt(S)) is the integer square root of floor(m^2 A^2 / S), and it is exact if its square times S is
//! m^2 A^2. Both encodings follow from that floor, since floor((r + n) / 2) = floor((floor(r) + n) / 2) for integers n.

use super::nearest_float::FloatLayout;
use num_bigint::BigInt;
use num_integer::{Integer, Roots};
use num_traits::{Signed, ToPrimitive};
use texbake::{Depth, Encoding};

/// Integers of any width.
pub trait Whole: Clone + Integer + Signed + Roots + From<i64> + ToPrimitive + Into<BigInt> {}
impl<T: Clone + Integer + Signed + Roots + From<i64> + ToPrimitive + Into<BigInt>> Whole for T {}

/// A code as it is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounded {
    pub bits: u32,
    /// Whether the value lies exactly half-way between two codes.
    pub tie: bool,
}

/// X^2 + Y^2 + Z^2.
pub fn square<T: Whole>(normal: &[T; 3]) -> T {
    normal.iter().fold(T::zero(), |sum, part| sum + part.clone() * part.clone())
}

/// What stores the number nearest to `a / sqrt(s)`, which is at most 1 in magnitude.
pub fn rounded<T: Whole>(a: T, s: &T, encoding: Encoding, depth: Depth) -> Rounded {
    let nearest = |layout: FloatLayout, a: T| layout.nearest(&a.into(), &s.clone().into());
    match depth {
        Depth::Float16 => Rounded { bits: nearest(FloatLayout::F16, a), tie: false },
        Depth::Float32 => Rounded { bits: nearest(FloatLayout::F32, a), tie: false },
        Depth::Bits8 => code(a, s, encoding, 8),
        Depth::Bits16 => code(a, s, encoding, 16),
    }
}

/// The same for parts of any size: in 128 bits where m^2 A^2 fits them, m below 2^16.
pub fn rounded_wide(a: i128, s: i128, encoding: Encoding, depth: Depth) -> Rounded {
    if a.abs() < 1 << 46 {
        rounded(a, &s, encoding, depth)
    } else {
        rounded(BigInt::from(a), &s.into(), encoding, depth)
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
    use crate::support::{BIASED8, FORMATS, Random, SNORM8, UNORM8, UNORM16};
    use texbake::NormalFormat;

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
    fn narrow_and_wide_integers_agree() {
        let mut random = Random::new(46);
        for format in FORMATS {
            for _ in 0..100 {
                let normal = [0; 3].map(|_| i128::from(random.any_magnitude((1 << 46) - 1)));
                let (s, [a, ..]) = (square(&normal), normal);
                let wide = rounded(BigInt::from(a), &s.into(), format.encoding, format.depth);
                assert_eq!(rounded_wide(a, s, format.encoding, format.depth), wide, "{normal:?}, {format:?}");
            }
        }
    }
}
