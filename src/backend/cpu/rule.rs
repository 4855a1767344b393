//! From the sums of a texel to its codes: in written floats, in fast floats, or proved.

use super::round::{Prove, Round};
use crate::ops::bake::{FloatSlope, IntegerSlope};

/// From the stencil sums of a texel to its codes.
pub(super) trait Rule: Sync {
    type Sum: Copy + Default + PartialEq;
    type Code: Copy + Default;

    /// The codes, and whether any of them is in doubt.
    fn codes(&self, sums: [Self::Sum; 2]) -> ([Self::Code; 3], bool);

    /// The codes beyond doubt; slow.
    fn exact_codes(&self, _: [Self::Sum; 2]) -> [Self::Code; 3] {
        unreachable!("this rule has no doubts")
    }
}

/// Float heights: the reference's own arithmetic.
pub(super) struct Written<R> {
    pub slope: FloatSlope,
    pub round: R,
}

/// Integer heights, `fast`.
pub(super) struct Estimated<R> {
    pub estimate: Estimate<f32>,
    pub round: R,
}

/// Integer heights, `exact`: an estimate whose error is bounded, and integers where that bound leaves a doubt.
pub(super) struct Proved<V, R> {
    pub slope: IntegerSlope,
    pub estimate: Estimate<V>,
    pub round: R,
}

/// The normal of integer slopes in floats: (kx Gx, ky Gy, 1) over its length.
///
/// With e half a unit in the last place of 1 (2^-24 for f32, 2^-53 for f64), to first order in e: kx is off by e of
/// its value, x = kx Gx by 2e (|Gx| < 2^20 is exact in both), x^2 by 5e, x^2 + y^2 by 6e, S by 7e, its root by 4.5e,
/// one over it by 5.5e. So z is off by 5.5e and x and y by 8.5e of their value. Nothing leaves the range of f32: kx is
/// 0 or above 2^-45, and x is below 2^23, for |Gx| is at most D M / 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate<V> {
    kx: V,
    ky: V,
}

macro_rules! estimate_in {
    ($float:ty) => {
        impl From<IntegerSlope> for Estimate<$float> {
            fn from(slope: IntegerSlope) -> Self {
                let over_z = |part: i32| (f64::from(part) / slope.z as f64) as $float;
                Self { kx: over_z(slope.px), ky: over_z(slope.py) }
            }
        }

        impl Estimate<$float> {
            #[inline(always)]
            fn normal(&self, [gx, gy]: [i32; 2]) -> [$float; 3] {
                let [x, y] = [gx as $float * self.kx, gy as $float * self.ky];
                let inverse = 1.0 / ((x * x + y * y) + 1.0).sqrt();
                // Adding zero makes -0 into 0, as integers have it.
                [x * inverse + 0.0, y * inverse + 0.0, inverse]
            }
        }

        impl<R: Prove<$float> + Sync> Rule for Proved<$float, R> {
            type Sum = i32;
            type Code = R::Code;

            #[inline(always)]
            fn codes(&self, sums: [i32; 2]) -> ([R::Code; 3], bool) {
                let [x, y, z] = self.estimate.normal(sums);
                let round = &self.round;
                let [x, y, z] = [round.code_or_doubt(x), round.code_or_doubt(y), round.code_or_doubt(z)];
                ([x.0, y.0, z.0], x.1 | y.1 | z.1)
            }

            #[cold]
            fn exact_codes(&self, sums: [i32; 2]) -> [R::Code; 3] {
                let (normal, s) = self.slope.normal(sums);
                normal.map(|component| self.round.exact(component, s))
            }
        }
    };
}

estimate_in!(f32);
estimate_in!(f64);

impl<R: Round + Sync> Rule for Written<R> {
    type Sum = f32;
    type Code = R::Code;

    #[inline(always)]
    fn codes(&self, sums: [f32; 2]) -> ([R::Code; 3], bool) {
        let [x, y, z] = self.slope.normal(sums);
        ([self.round.code(x), self.round.code(y), self.round.code(z)], false)
    }
}

impl<R: Round + Sync> Rule for Estimated<R> {
    type Sum = i32;
    type Code = R::Code;

    #[inline(always)]
    fn codes(&self, sums: [i32; 2]) -> ([R::Code; 3], bool) {
        let [x, y, z] = self.estimate.normal(sums);
        ([self.round.code(x), self.round.code(y), self.round.code(z)], false)
    }
}
