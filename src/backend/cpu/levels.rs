//! Mip levels: what the heights of a row add to them, and from sums over a texel to its codes.

use super::bake::sums_of_columns;
use super::output::{Fraction, Output, Proving, written};
use super::plane::{BLOCK, Plane, padded};
use super::real::without_sign;
use super::slopes::{normals, parallaxes};
use super::sums::Height;
use crate::exact::{Radicand, Wide};
use crate::map::CodesMut;
use crate::ops::bake::{BakePlan, FloatSlope, IntegerSlope, Slope};
use crate::stream::Band;

/// A height that levels are made of.
pub(crate) trait LevelHeight: Height {
    /// What a parallax map has of it, times its greatest code: 2H - M of a code, and h, at least 0 and at most 1, of a
    /// float.
    fn relief(self) -> Self::Sum;
}

macro_rules! codes {
    ($($code:ty),*) => {$(
        impl LevelHeight for $code {
            #[inline(always)]
            fn relief(self) -> i32 {
                2 * i32::from(self) - i32::from(Self::MAX)
            }
        }
    )*};
}

codes!(u8, u16);

impl LevelHeight for f32 {
    #[inline(always)]
    fn relief(self) -> f32 {
        self.clamp(0.0, 1.0)
    }
}

/// What is summed up over the texels of levels: Gx, Gy and, for a parallax map, the relief.
pub(crate) fn planes(plan: &BakePlan) -> usize {
    2 + usize::from(plan.parallax.is_some())
}

/// The samples of a row of a strip, plane after plane.
pub(crate) fn samples<T: LevelHeight>(plan: &BakePlan, strip: &Band<'_, T>, row: usize, samples: &mut [T::Sum]) {
    let (gx, rest) = samples.split_at_mut(strip.width);
    let (gy, relief) = rest.split_at_mut(strip.width);
    sums_of_columns(plan, strip, row, 0, [gx, gy]);
    relief.iter_mut().zip(strip.row(row as isize)).for_each(|(relief, height)| *relief = height.relief());
}

/// Gx and Gy of the texels of a row of a strip.
pub(crate) fn sums_of_row<T: LevelHeight>(
    plan: &BakePlan,
    strip: &Band<'_, T>,
    row: usize,
) -> impl Iterator<Item = [T::Sum; 2]> {
    let [mut gx, mut gy] = [vec![T::Sum::default(); strip.width], vec![T::Sum::default(); strip.width]];
    sums_of_columns(plan, strip, row, 0, [&mut gx, &mut gy]);
    gx.into_iter().zip(gy).map(|(gx, gy)| [gx, gy])
}

/// Sums over a texel, of which the codes of a level are made.
pub(crate) trait LevelSum: Copy + Send + Sync {
    /// The codes of some texels: `sums` holds Gx, Gy and the relief of each, times weights that add up to `weight`.
    fn codes(plan: &BakePlan, weight: u64, sums: &[&[Self]], maps: Vec<CodesMut<'_>>);
}

impl LevelSum for i64 {
    fn codes(plan: &BakePlan, weight: u64, sums: &[&[i64]], maps: Vec<CodesMut<'_>>) {
        let Slope::Integer(slope) = plan.slope else { unreachable!("the plan was made for floats") };
        let greatest = plan.height_type.greatest_code().expect("heights are integers");
        let level = LevelSlope { slope, weight, estimate: Estimate::new(slope, weight, greatest), greatest };
        let mut outputs: Vec<Box<dyn Output<f64, Wide> + '_>> =
            plan.outputs().zip(maps).map(|(format, codes)| f64::proved(format, codes)).collect();
        let mut normal = [[0.0; BLOCK]; 3];
        let mut parallax = [0.0; BLOCK];
        for first in (0..sums[0].len()).step_by(BLOCK) {
            let block = first..sums[0].len().min(first + BLOCK);
            let sums: Vec<&[i64]> = sums.iter().map(|plane| &plane[block.clone()]).collect();
            let mut outputs = outputs.iter_mut();
            estimate_normals(&level.estimate, [sums[0], sums[1]], &mut normal);
            if plan.normal.is_some() {
                let [x, y, z] = &normal;
                let output = outputs.next().expect("room for the normal map");
                output.store(&[x, y, z], block.len(), &|at| level.normal([sums[0][at], sums[1][at]]));
            }
            if plan.parallax.is_some() {
                estimate_parallaxes(&level.estimate, &normal[2], sums[2], &mut parallax);
                let output = outputs.next().expect("room for the parallax map");
                let exact = |at: usize| level.parallax([sums[0][at], sums[1][at]], sums[2][at]);
                output.store(&[&parallax], block.len(), &exact);
            }
        }
    }
}

/// From sums over the texels of a level to fractions.
struct LevelSlope {
    slope: IntegerSlope,
    weight: u64,
    /// M.
    greatest: u32,
    estimate: Estimate,
}

impl LevelSlope {
    /// (px A, py B, Z W), where A and B are sums of Gx and Gy with weights that add up to W.
    ///
    /// |Gx| is below 2^21 and W below 2^42, so X and Y are below 2^87, and so is Z W: it fits [`Wide`].
    fn normal(&self, sums: [i64; 2]) -> Fraction<Wide> {
        let IntegerSlope { px, py, z } = self.slope;
        let [x, y] = [i128::from(px) * i128::from(sums[0]), i128::from(py) * i128::from(sums[1])];
        let normal = [x, y, i128::from(z) * i128::from(self.weight)];
        (normal, Wide::square(x) + Wide::square(y) + Wide::square(normal[2]))
    }

    /// n_z times the mean of 2h - 1: Z W (R / (W M)) with R the sum of 2H - M.
    fn parallax(&self, sums: [i64; 2], relief: i64) -> Fraction<Wide> {
        let (_, s) = self.normal(sums);
        let a = i128::from(self.slope.z / i64::from(self.greatest)) * i128::from(relief);
        ([a, 0, 0], s)
    }
}

/// The components of a level in f64.
///
/// In units of e and to first order (see [`super::real`]): a sum is off by e of its value and its factor by 2e, the one of
/// a product and the one of a quotient, so x is off by 4e, x^2 by 9e, S by 11e, its root by 6.5e, one over it by 7.5e:
/// z is off by 7.5e, and x and y by 12.5e of their value. The mean of 2h - 1 is off by 4e as x is, the parallax by 12.5e.
struct Estimate {
    kx: f64,
    ky: f64,
    /// 1 / (W M).
    over_relief: f64,
}

impl Estimate {
    fn new(slope: IntegerSlope, weight: u64, greatest: u32) -> Self {
        let over_z = |part: i32| f64::from(part) / (slope.z as f64 * weight as f64);
        Self { kx: over_z(slope.px), ky: over_z(slope.py), over_relief: 1.0 / (weight as f64 * f64::from(greatest)) }
    }
}

vectorised! {
    fn estimate_normals(level: &Estimate, [gx, gy]: [&[i64]; 2], [x, y, z]: &mut [Plane<f64>; 3]) {
        let count = gx.len().min(BLOCK);
        let gy = &gy[..count];
        for i in 0..count {
            let [dx, dy] = [gx[i] as f64 * level.kx, gy[i] as f64 * level.ky];
            let inverse = 1.0 / ((dx * dx + dy * dy) + 1.0).sqrt();
            [x[i], y[i], z[i]] = [without_sign(dx * inverse), without_sign(dy * inverse), inverse];
        }
    }
}

vectorised! {
    fn estimate_parallaxes(level: &Estimate, z: &Plane<f64>, relief: &[i64], parallax: &mut Plane<f64>) {
        for ((parallax, z), relief) in parallax.iter_mut().zip(z).zip(relief) {
            *parallax = z * (*relief as f64 * level.over_relief);
        }
    }
}

/// The mean is divided in f64 and rounded to f32 once; from there a texel is one of level 0.
impl LevelSum for f64 {
    fn codes(plan: &BakePlan, weight: u64, sums: &[&[f64]], maps: Vec<CodesMut<'_>>) {
        let Slope::Float(slope) = plan.slope else { unreachable!("the plan was made for integers") };
        let mut outputs: Vec<Box<dyn Output<f32> + '_>> =
            plan.outputs().zip(maps).map(|(format, codes)| written(format, codes)).collect();
        let mut means = [[0.0; BLOCK]; 3];
        let mut normal = [[0.0; BLOCK]; 3];
        let mut parallax = [0.0; BLOCK];
        for first in (0..sums[0].len()).step_by(BLOCK) {
            let count = BLOCK.min(sums[0].len() - first);
            for (means, sums) in means.iter_mut().zip(sums) {
                mean(weight, &sums[first..][..count], means);
            }
            let [gx, gy, relief] = means;
            normals::<f32, FloatSlope>(&slope, &[gx, gy], &mut normal, padded(count));
            let mut outputs = outputs.iter_mut();
            let certain = |_| unreachable!("written floats have no doubts");
            if plan.normal.is_some() {
                let [x, y, z] = &normal;
                outputs.next().expect("room for the normal map").store(&[x, y, z], count, &certain);
            }
            if plan.parallax.is_some() {
                parallaxes::<f32, FloatSlope>(&slope, &normal[2], &relief[..count], &mut parallax);
                outputs.next().expect("room for the parallax map").store(&[&parallax], count, &certain);
            }
        }
    }
}

vectorised! {
    fn mean(weight: u64, sums: &[f64], means: &mut Plane<f32>) {
        let weight = weight as f64;
        for (mean, sum) in means.iter_mut().zip(sums) {
            *mean = (sum / weight) as f32;
        }
    }
}
