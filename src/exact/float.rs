//! The nearest float to a component A / sqrt(S), decided in integers.
//!
//! A / sqrt(S) with S = X^2 + Y^2 + Z^2 is a fraction with a power of two below only if it is 0 or 1 in magnitude
//! (a sum of three squares equal to 4^k is a single square), so it never lies half-way between two floats.

use half::f16;

/// The nearest f32 to `a / sqrt(s)`; `|a| < 2^53`, `a^2 <= s < 2^107`.
pub(crate) fn nearest_f32(a: i64, s: u128) -> f32 {
    // More than 25 bits, the last one sticky, round to 24 as the number itself does.
    rounded_to_odd(a, s, 26) as f32
}

/// The nearest f16 to `a / sqrt(s)`; `|a| < 2^53`, `a^2 <= s < 2^107`.
pub(crate) fn nearest_f16(a: i64, s: u128) -> f16 {
    // At most 24 bits are an f32 without rounding, so only the last conversion rounds.
    f16::from_f32(rounded_to_odd(a, s, 22) as f32)
}

/// `a / sqrt(s)` cut to its first `bits` bits, with one more that says whether anything was cut off.
fn rounded_to_odd(a: i64, s: u128, bits: i32) -> f64 {
    if a == 0 {
        return 0.0;
    }
    // Off by less than 2^-51 of its value, so the cut integer below is right or off by one.
    let estimate = a.unsigned_abs() as f64 / (s as f64).sqrt();
    let exponent = (estimate.to_bits() >> 52) as i32 - 1023;
    let shift = bits - 1 - exponent;
    let target = Wide::shifted(u128::from(a.unsigned_abs()).pow(2), 2 * shift as u32);
    let square = |n: u64| Wide::product(s, n * n);
    let mut cut = (estimate * power_of_two(shift)) as u64;
    if square(cut) > target {
        cut -= 1;
    } else if square(cut + 1) <= target {
        cut += 1;
    }
    let inexact = u64::from(square(cut) != target);
    let magnitude = (2 * cut + inexact) as f64 * power_of_two(-shift - 1);
    if a < 0 { -magnitude } else { magnitude }
}

/// 2^exponent, for normal results.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// An unsigned integer of 256 bits, for products that outgrow u128.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Wide {
    high: u128,
    low: u128,
}

impl Wide {
    /// `a b`.
    pub fn product(a: u128, b: u64) -> Self {
        let (a1, a0, b) = (a >> 64, a & u128::from(u64::MAX), u128::from(b));
        let (upper, carried) = (a1 * b, a0 * b);
        let (low, carry) = carried.overflowing_add(upper << 64);
        Self { high: (upper >> 64) + u128::from(carry), low }
    }

    /// `a 2^by`, by < 256.
    fn shifted(a: u128, by: u32) -> Self {
        match by {
            0 => Self { high: 0, low: a },
            1..128 => Self { high: a >> (128 - by), low: a << by },
            _ => Self { high: a << (by - 128), low: 0 },
        }
    }
}
