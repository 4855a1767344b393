//! The floats that estimates are made in, and unit vectors of integers in them.
//!
//! Errors are in e, half a unit in the last place of 1 (2^-24 for f32, 2^-53 for f64), to first order.

use crate::map::TexelFormat;
use crate::ops::blend::Number;
use crate::ops::{Precision, Vector};

/// f32 or f64.
pub(super) trait Real: Number + Default + PartialOrd + Send + Sync {
    const ONE: Self;

    /// The nearest.
    fn of(value: f64) -> Self;

    fn of_integer(value: i32) -> Self;

    fn sqrt(self) -> Self;

    /// One over this.
    fn inverse(self) -> Self;
}

macro_rules! real {
    ($($float:ty)*) => {$(
        impl Real for $float {
            const ONE: Self = 1.0;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $float
            }

            #[inline(always)]
            fn of_integer(value: i32) -> Self {
                value as $float
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn inverse(self) -> Self {
                1.0 / self
            }
        }
    )*};
}

real!(f32 f64);

/// What an operation on integers computes in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arithmetic {
    /// f32, whatever its error.
    Fast,
    /// f32 that decides between codes of 8 bits, and integers where it leaves a doubt.
    Near,
    /// f64 that decides between codes of any type, and integers where it leaves a doubt.
    Nearer,
}

impl Arithmetic {
    /// What suits these outputs.
    pub fn new(precision: Precision, mut outputs: impl Iterator<Item = TexelFormat>) -> Self {
        match precision {
            Precision::Fast => Self::Fast,
            Precision::Exact if outputs.all(|format| format.depth.bytes() == 1) => Self::Near,
            Precision::Exact => Self::Nearer,
        }
    }
}

/// (x, y, z) over its length, for integers; (0, 0, 1) for (0, 0, 0).
///
/// Where x, y and z are exact in V, their squares are off by e of their value, S by 3e, its root by 2.5e, one over it
/// by 3.5e, and the components by 4.5e.
#[inline(always)]
pub(super) fn unit<V: Real>([x, y, z]: Vector<V>) -> Vector<V> {
    let square = (x * x + y * y) + z * z;
    let nothing = square < V::ONE;
    let [z, square] = if nothing { [V::ONE; 2] } else { [z, square] };
    let inverse = square.sqrt().inverse();
    [without_sign(x * inverse), without_sign(y * inverse), without_sign(z * inverse)]
}

/// Adding zero makes -0 into 0, as integers have it.
#[inline(always)]
pub(super) fn without_sign<V: Real>(value: V) -> V {
    value + V::default()
}
