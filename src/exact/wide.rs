//! Squares that a component is divided by the root of, in 128 bits and in 256.

use std::ops::Add;

/// The square S of a length, under a component A / sqrt(S).
pub(crate) trait Radicand: Copy + PartialEq {
    /// What A is held in.
    type Part: Copy + PartialEq;

    /// A^2.
    fn square(part: Self::Part) -> Self;

    /// The nearest to A; zero only for zero.
    fn float(part: Self::Part) -> f64;

    /// S, off by 2^-52 of its value at most.
    fn to_f64(self) -> f64;

    /// The product with a factor that leaves 256 bits enough.
    fn times(self, factor: u64) -> Wide;
}

/// `|A| < 2^53`, `S < 2^107`: what one texel's heights give.
impl Radicand for u128 {
    type Part = i64;

    fn square(part: i64) -> Self {
        Self::from(part.unsigned_abs()).pow(2)
    }

    fn float(part: i64) -> f64 {
        part as f64
    }

    fn to_f64(self) -> f64 {
        self as f64
    }

    fn times(self, factor: u64) -> Wide {
        Wide::product(self, factor)
    }
}

/// `|A| < 2^88`, `S < 2^178`: what the sums of many texels give.
impl Radicand for Wide {
    type Part = i128;

    fn square(part: i128) -> Self {
        let part = part.unsigned_abs();
        let (high, low) = ((part >> 64) as u64, part as u64);
        Self::product(part, low) + Self::product(part, high).shifted(64)
    }

    fn float(part: i128) -> f64 {
        part as f64
    }

    fn to_f64(self) -> f64 {
        self.high as f64 * 2f64.powi(128) + self.low as f64
    }

    fn times(self, factor: u64) -> Wide {
        Self::product(self.low, factor) + Self { high: self.high * u128::from(factor), low: 0 }
    }
}

/// An unsigned integer of 256 bits, for products that outgrow u128.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Wide {
    high: u128,
    low: u128,
}

impl Wide {
    /// `a b`.
    fn product(a: u128, b: u64) -> Self {
        let (a1, a0, b) = (a >> 64, a & u128::from(u64::MAX), u128::from(b));
        let (upper, carried) = (a1 * b, a0 * b);
        let (low, carry) = carried.overflowing_add(upper << 64);
        Self { high: (upper >> 64) + u128::from(carry), low }
    }

    /// `self 2^by`, by < 256, of which no bit may be lost.
    pub(super) fn shifted(self, by: u32) -> Self {
        match by {
            0 => self,
            1..128 => Self { high: (self.high << by) | (self.low >> (128 - by)), low: self.low << by },
            _ => Self { high: self.low << (by - 128), low: 0 },
        }
    }
}

impl Add for Wide {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Self { high: self.high + other.high + u128::from(carry), low }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigUint;

    fn big(wide: Wide) -> BigUint {
        (BigUint::from(wide.high) << 128) + wide.low
    }

    #[test]
    fn products_shifts_and_sums_keep_every_bit() {
        let parts = [0, 1, u64::MAX.into(), (1 << 88) - 1, (1 << 87) + 12_345, 0x12_3456_789a_bcde_f011_2233i128];
        for a in parts {
            for b in parts {
                let (x, y) = (BigUint::from(a as u128), BigUint::from(b as u128));
                let squares = Wide::square(-a) + Wide::square(b);
                assert_eq!(big(squares), &x * &x + &y * &y);
                for factor in [0, 1, 65_535, u32::MAX.into(), (1 << 54) - 1] {
                    assert_eq!(big(squares.times(factor)), (&x * &x + &y * &y) * factor);
                }
                let near = squares.to_f64() / (a as f64 * a as f64 + b as f64 * b as f64).max(1.0);
                assert!((a, b) == (0, 0) || (near - 1.0).abs() < 1e-15, "{a}, {b}");
                for by in [0, 1, 63, 64, 77] {
                    assert_eq!(big(squares.shifted(by)), (&x * &x + &y * &y) << by);
                }
            }
        }
        assert_eq!(big(Wide::square(3).shifted(128)), BigUint::from(9u32) << 128);
        assert_eq!(big(Wide::square(3).shifted(200)), BigUint::from(9u32) << 200);
    }
}
