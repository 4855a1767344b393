//! From a component to its code: as the reference rounds floats, or proved to be the nearest.

use super::f16_bits::nearest_f16_of_f32;
use crate::exact::{CodeRounding, Radicand, nearest_f16, nearest_f32};
use crate::map::TexelFormat;
use half::f16;
use std::marker::PhantomData;

/// Rounds a component in f32 as the reference does.
pub(super) trait Round {
    type Code: Copy + Default;

    fn code(&self, component: f32) -> Self::Code;
}

/// Rounds an estimate of a component, and says whether the estimate's error could change the code.
pub(super) trait Prove<V> {
    type Code: Copy + Default;

    fn code_or_doubt(&self, estimate: V) -> (Self::Code, bool);

    /// The code of `a / sqrt(s)`.
    fn exact<S: Radicand>(&self, a: S::Part, s: S) -> Self::Code;
}

/// Integer codes.
pub(super) struct ToInteger<C> {
    rounding: CodeRounding,
    code: PhantomData<C>,
}

/// Half floats.
pub(super) struct ToF16;

/// Floats.
pub(super) struct ToF32;

impl<C> ToInteger<C> {
    pub fn new(format: TexelFormat) -> Self {
        let rounding = CodeRounding::new(format).expect("checked with the options");
        Self { rounding, code: PhantomData }
    }
}

/// The low bits of a float that is an integer, in two's complement: next to 1.5 * 2^23 a float's last place is 1.
#[inline(always)]
fn integer_bits_f32(integer: f32) -> u32 {
    (integer + 12_582_912.0).to_bits()
}

/// The same for f64, whose last place is 1 next to 1.5 * 2^52.
#[inline(always)]
fn integer_bits_f64(integer: f64) -> u32 {
    (integer + 6_755_399_441_055_744.0).to_bits() as u32
}

/// Which bits of an integer a code stores.
macro_rules! round_to {
    ($code:ty) => {
        impl Round for ToInteger<$code> {
            type Code = $code;

            /// `CodeRounding::code_of_float`; its conversion, which saturates, would cost more.
            #[inline(always)]
            fn code(&self, component: f32) -> $code {
                let CodeRounding { m, c, offset, .. } = self.rounding;
                let code = component * (m as f32 * 0.5) + (c as f32 + 1.0) * 0.5;
                integer_bits_f32(code.floor()).wrapping_add(offset as u32) as $code
            }
        }
    };
}

round_to!(u8);
round_to!(u16);

/// Integer codes from an estimate.
///
/// The code is floor(w) for w = v m/2 + (c + 1)/2. For unorm (c + 1)/2 is an integer, which is added last, so that
/// w = v m/2 keeps the sign of v; for snorm it is 1/2.
///
/// An estimate v that is off by 13e (see [`super::real`]), the most of any operation, makes v m/2 off by 14e of at
/// most 127.5 (8 bits, f32: 1.07e-4) or 32767.5 (16 bits, f64: 5.1e-11), and the 1/2 of snorm adds half a unit in the
/// last place (3.9e-6 of 127, 1.9e-12 of 32767). Codes of 8 bits from f64 are far within the latter. Where w is further than DOUBT from every integer, floor(w) is right. It is right too where v is
/// below 2^-17, however near w is to an integer: for unorm that integer is 0, and the sign is right; for snorm w is
/// near 1/2 instead.
macro_rules! prove {
    ($code:ty, $float:ty, $doubt:expr, $integer_bits:ident) => {
        impl Prove<$float> for ToInteger<$code> {
            type Code = $code;

            #[inline(always)]
            fn code_or_doubt(&self, estimate: $float) -> ($code, bool) {
                const DOUBT: $float = $doubt;
                const SIGN_DECIDES: $float = 1.0 / 131_072.0;
                let CodeRounding { m, c, offset, .. } = self.rounding;
                let (half, whole) = if c == 0 { (0.5, 0) } else { (0.0, (c + 1) / 2) };
                let w = estimate * (m as $float * 0.5) + half;
                let floor = w.floor();
                let from_half = (w - floor - 0.5).abs();
                let doubt = (from_half > 0.5 - DOUBT) & (estimate.abs() > SIGN_DECIDES);
                ($integer_bits(floor).wrapping_add((whole + offset) as u32) as $code, doubt)
            }

            fn exact<S: Radicand>(&self, a: S::Part, s: S) -> $code {
                self.rounding.code(a, s) as $code
            }
        }
    };
}

prove!(u8, f32, 1.0 / 8192.0, integer_bits_f32);
prove!(u8, f64, 1.0 / 8_589_934_592.0, integer_bits_f64);
prove!(u16, f64, 1.0 / 8_589_934_592.0, integer_bits_f64);

impl Round for ToF16 {
    type Code = f16;

    #[inline(always)]
    fn code(&self, component: f32) -> f16 {
        nearest_f16_of_f32(component)
    }
}

impl Round for ToF32 {
    type Code = f32;

    #[inline(always)]
    fn code(&self, component: f32) -> f32 {
        component
    }
}

impl Prove<f64> for ToF16 {
    type Code = f16;

    /// The component lies between the f32 neighbours of the estimate's nearest f32, one of which may be a tie.
    #[inline(always)]
    fn code_or_doubt(&self, estimate: f64) -> (f16, bool) {
        let nearest = estimate as f32;
        let low = nearest_f16_of_f32(nearest * (1.0 - f32::EPSILON));
        let high = nearest_f16_of_f32(nearest * (1.0 + f32::EPSILON));
        (low, low.to_bits() != high.to_bits())
    }

    fn exact<S: Radicand>(&self, a: S::Part, s: S) -> f16 {
        nearest_f16(a, s)
    }
}

impl Prove<f64> for ToF32 {
    type Code = f32;

    /// The estimate is off by 13e (see [`super::real`]), a side by e more; 16e lie between them.
    #[inline(always)]
    fn code_or_doubt(&self, estimate: f64) -> (f32, bool) {
        const SIDE: f64 = 8.0 * f64::EPSILON;
        let [low, high] = [(estimate * (1.0 - SIDE)) as f32, (estimate * (1.0 + SIDE)) as f32];
        (low, low != high)
    }

    fn exact<S: Radicand>(&self, a: S::Part, s: S) -> f32 {
        nearest_f32(a, s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Depth, Encoding};

    fn to_integer<C>(encoding: Encoding, depth: Depth) -> ToInteger<C> {
        ToInteger::new(TexelFormat { encoding, depth, channels: 3 })
    }

    #[test]
    fn integer_codes_are_in_doubt_near_their_boundaries_alone() {
        let unorm = to_integer::<u8>(Encoding::Unorm, Depth::Bits8);
        for (v, code) in [(1f32, 255), (-1.0, 0), (0.0, 128), (1e-9, 128), (-1e-9, 127), (0.5, 191)] {
            assert_eq!(unorm.code_or_doubt(f64::from(v)), (code, false), "unorm {v}");
            assert_eq!(unorm.code_or_doubt(v), (code, false), "unorm {v}");
        }
        for k in [-127f32, -3.0, 1.0, 100.0] {
            assert!(unorm.code_or_doubt(k / 127.5).1 && unorm.code_or_doubt((k + 0.00008) / 127.5).1, "unorm {k}");
            assert!(!unorm.code_or_doubt((k + 0.001) / 127.5).1, "unorm {k}");
        }
        let snorm = to_integer::<u8>(Encoding::Snorm, Depth::Bits8);
        for (v, code) in [(1f32, 127), (-1.0, 129), (0.0, 0), (-1e-9, 0), (-1.0 / 127.0, 255)] {
            assert_eq!(snorm.code_or_doubt(v), (code, false), "snorm {v}");
        }
        assert!(snorm.code_or_doubt(0.5f32 / 127.0).1 && snorm.code_or_doubt(-0.5f64 / 127.0).1);
        let words = to_integer::<u16>(Encoding::Unorm, Depth::Bits16);
        for (v, code) in [(1.0, 65535), (-1.0, 0), (0.0, 32768), (-1e-12, 32767)] {
            assert_eq!(words.code_or_doubt(v), (code, false), "unorm {v}");
        }
        assert!(words.code_or_doubt(7.0 / 32767.5).1 && words.code_or_doubt((7.0 - 4e-11) / 32767.5).1);
        assert!(!words.code_or_doubt((7.0 + 1e-9) / 32767.5).1);
    }

    #[test]
    fn floats_are_in_doubt_near_half_way_alone() {
        let [ulp, f16_ulp] = [2f64.powi(-24), 2f64.powi(-11)]; // of 0.6
        let [below, f16_below] = [10_066_329.0 * ulp, 1228.0 * f16_ulp];
        for off in [0.0, 1e-15, -1e-15] {
            assert!(ToF32.code_or_doubt(below + ulp / 2.0 + off).1, "{off}");
            assert!(ToF16.code_or_doubt(f16_below + f16_ulp / 2.0 + off).1, "{off}");
        }
        assert_eq!(ToF32.code_or_doubt(below + ulp * 0.501), ((below + ulp) as f32, false));
        assert_eq!(ToF32.code_or_doubt(below + ulp * 0.499), (below as f32, false));
        assert_eq!(ToF16.code_or_doubt(f16_below + f16_ulp * 0.501), (f16::from_f64(f16_below + f16_ulp), false));
        assert_eq!(ToF16.code_or_doubt(f16_below + f16_ulp * 0.499), (f16::from_f64(f16_below), false));
        for exact in [0.0, 1.0] {
            assert_eq!(ToF32.code_or_doubt(exact), (exact as f32, false));
            assert_eq!(ToF16.code_or_doubt(exact), (f16::from_f64(exact), false));
        }
    }
}
