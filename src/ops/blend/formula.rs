//! The formula of each method, whatever it is computed in.

use super::BlendMethod;
use crate::ops::Vector;
use std::ops::{Add, Mul, Sub};

/// What a formula is computed in: i64, which is exact; f64, exact too since every part of an exact blend is below 2^53;
/// f32, which rounds in the order written here.
pub(crate) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    fn abs(self) -> Self;
}

macro_rules! number {
    ($($type:ty)*) => {$(
        impl Number for $type {
            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }
        }
    )*};
}

number!(i64 f32 f64);

/// The blended normal, of any length, of two normals over l1 and l2 with the weights a/q and b/q.
#[inline(always)]
pub(crate) fn blended<T: Number>(
    method: BlendMethod,
    [a, b, q]: [T; 3],
    [l1, l2]: [T; 2],
    [x1, y1, z1]: Vector<T>,
    [x2, y2, z2]: Vector<T>,
) -> Vector<T> {
    let overlay = |v1: T, v2: T| l2 * v1 + (l1 - v1.abs()) * v2;
    match method {
        BlendMethod::Weighted { .. } | BlendMethod::Masked => {
            let (ca, cb) = (a * z2, b * z1);
            [ca * x1 + cb * x2, ca * y1 + cb * y2, q * (z1 * z2)]
        }
        BlendMethod::Linear => [l2 * x1 + l1 * x2, l2 * y1 + l1 * y2, l2 * z1 + l1 * z2],
        BlendMethod::Overlay => [overlay(x1, x2), overlay(y1, y2), overlay(z1, z2)],
        BlendMethod::Udn => [l2 * x1 + l1 * x2, l2 * y1 + l1 * y2, l2 * z1],
        BlendMethod::Whiteout => [l2 * x1 + l1 * x2, l2 * y1 + l1 * y2, z1 * z2],
        BlendMethod::Rnm => {
            // t = (x1, y1, z1 + 1), u = (-x2, -y2, z2); t (t.u) / t_z - u, times t_z.
            let tz = z1 + l1;
            let tu = tz * z2 - (x1 * x2 + y1 * y2);
            [tu * x1 + l1 * tz * x2, tu * y1 + l1 * tz * y2, tz * (tu - l1 * z2)]
        }
    }
}
