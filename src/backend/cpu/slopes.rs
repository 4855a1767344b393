//! From the sums of a texel and its height to its normal and its parallax: in written floats, or estimated.

use super::output::Fraction;
use super::plane::{BLOCK, Plane};
use super::real::{Real, without_sign};
use super::sums::Height;
use crate::ops::Vector;
use crate::ops::bake::{FloatSlope, IntegerSlope, float_parallax};

/// How heights of one type become components.
pub(super) trait Slopes<T: Height>: Sync {
    type Component: Copy + Default;

    /// The unit normal.
    fn normal(&self, sums: [T::Sum; 2]) -> Vector<Self::Component>;

    /// n_z (2h - 1).
    fn parallax(&self, z: Self::Component, height: T) -> Self::Component;

    /// The normal beyond doubt.
    fn exact_normal(&self, _: [T::Sum; 2]) -> Fraction {
        unreachable!("written floats have no doubts")
    }

    /// The parallax beyond doubt.
    fn exact_parallax(&self, _: [T::Sum; 2], _: T) -> Fraction {
        unreachable!("written floats have no doubts")
    }
}

/// The components of integer heights in floats: the normal is (kx Gx, ky Gy, 1) over its length.
///
/// To first order in e (see [`super::real`]): kx is off by e of its value, x = kx Gx by 2e (|Gx| < 2^20 is exact in
/// both), x^2 by 5e, x^2 + y^2 by 6e, S by 7e, its root by 4.5e, one over it by 5.5e. So z is off by 5.5e and x and y
/// by 8.5e of their value. The parallax is z times (2H - M) (1/M), of which 2H - M is exact, 1/M is off by e and the
/// two products by e each: it is off by 8.5e. Nothing leaves the range of f32: kx is 0 or above 2^-45, and x is below
/// 2^23, for |Gx| is at most D M / 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate<V> {
    slope: IntegerSlope,
    kx: V,
    ky: V,
    /// M.
    greatest: i32,
    /// 1/M.
    over_greatest: V,
}

impl<V: Real> Estimate<V> {
    /// For heights up to `greatest`.
    pub fn new(slope: IntegerSlope, greatest: i32) -> Self {
        let over_z = |part: i32| V::of(f64::from(part) / slope.z as f64);
        let over_greatest = V::of(1.0 / f64::from(greatest));
        Self { slope, kx: over_z(slope.px), ky: over_z(slope.py), greatest, over_greatest }
    }
}

impl<T: Height<Sum = i32> + Into<i32>, V: Real> Slopes<T> for Estimate<V> {
    type Component = V;

    #[inline(always)]
    fn normal(&self, [gx, gy]: [i32; 2]) -> Vector<V> {
        let [x, y] = [V::of_integer(gx) * self.kx, V::of_integer(gy) * self.ky];
        let inverse = ((x * x + y * y) + V::ONE).sqrt().inverse();
        [without_sign(x * inverse), without_sign(y * inverse), inverse]
    }

    #[inline(always)]
    fn parallax(&self, z: V, height: T) -> V {
        z * (V::of_integer(2 * height.into() - self.greatest) * self.over_greatest)
    }

    fn exact_normal(&self, sums: [i32; 2]) -> Fraction {
        self.slope.normal(sums)
    }

    fn exact_parallax(&self, sums: [i32; 2], height: T) -> Fraction {
        let (_, s) = self.slope.normal(sums);
        ([self.slope.parallax(height.into(), self.greatest), 0, 0], s)
    }
}

impl Slopes<f32> for FloatSlope {
    type Component = f32;

    #[inline(always)]
    fn normal(&self, sums: [f32; 2]) -> Vector<f32> {
        FloatSlope::normal(self, sums)
    }

    #[inline(always)]
    fn parallax(&self, z: f32, height: f32) -> f32 {
        float_parallax(z, height)
    }
}

vectorised! {
    pub(super) fn normals<T: Height, S: Slopes<T>>(
        slopes: &S,
        [gx, gy]: &[Plane<T::Sum>; 2],
        [x, y, z]: &mut [Plane<S::Component>; 3],
        count: usize,
    ) {
        for i in 0..count.min(BLOCK) {
            [x[i], y[i], z[i]] = slopes.normal([gx[i], gy[i]]);
        }
    }
}

vectorised! {
    pub(super) fn parallaxes<T: Height, S: Slopes<T>>(
        slopes: &S,
        z: &Plane<S::Component>,
        heights: &[T],
        parallax: &mut Plane<S::Component>,
    ) {
        for ((parallax, z), height) in parallax.iter_mut().zip(z).zip(heights) {
            *parallax = slopes.parallax(*z, *height);
        }
    }
}
