//! The nearest float to a component A / sqrt(S), decided in integers.
//!
//! A / sqrt(S) with S = X^2 + Y^2 + Z^2 is a fraction with a power of two below only if it is 0 or 1 in magnitude
//! (a sum of three squares equal to 4^k is a single square), so it never lies half-way between two floats.

use super::Radicand;
use half::f16;

/// The nearest f32 to `a / sqrt(s)`, `a^2 <= s`.
pub(crate) fn nearest_f32<S: Radicand>(a: S::Part, s: S) -> f32 {
    // More than 25 bits, the last one sticky, round to 24 as the number itself does.
    rounded_to_odd(a, s, 26) as f32
}

/// The nearest f16 to `a / sqrt(s)`, `a^2 <= s`.
pub(crate) fn nearest_f16<S: Radicand>(a: S::Part, s: S) -> f16 {
    // At most 24 bits are an f32 without rounding, so only the last conversion rounds.
    f16::from_f32(rounded_to_odd(a, s, 22) as f32)
}

/// `a / sqrt(s)` cut to its first `bits` bits, with one more that says whether anything was cut off.
fn rounded_to_odd<S: Radicand>(a: S::Part, s: S, bits: i32) -> f64 {
    let value = S::float(a);
    if value == 0.0 {
        return 0.0;
    }
    // Off by at most 2^-51 of its value, so the cut integer below is right or off by one.
    let estimate = value.abs() / s.to_f64().sqrt();
    let exponent = (estimate.to_bits() >> 52) as i32 - 1023;
    let shift = bits - 1 - exponent;
    let target = S::square(a).times(1).shifted(2 * shift as u32);
    let square = |n: u64| s.times(n * n);
    let mut cut = (estimate * power_of_two(shift)) as u64;
    if square(cut) > target {
        cut -= 1;
    } else if square(cut + 1) <= target {
        cut += 1;
    }
    let inexact = u64::from(square(cut) != target);
    let magnitude = (2 * cut + inexact) as f64 * power_of_two(-shift - 1);
    magnitude.copysign(value)
}

/// 2^exponent, for normal results.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}
