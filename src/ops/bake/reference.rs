//! The specification: one texel after the other, in plain code.

use super::{BakePlan, FloatSlope, IntegerSlope, Slope, Stencil};
use crate::map::CodesMut;
use crate::ops::store::{store_floats, store_fractions};
use crate::stream::{Band, HeightBand};

/// The codes of all texels of a band, for each map of the plan.
pub(crate) fn codes_of_band(plan: &BakePlan, band: &HeightBand<'_>, maps: &mut [CodesMut<'_>]) {
    let width = plan.size.width();
    for texel in 0..band.rows() * width {
        codes_of_texel(plan, band, texel % width, texel / width, maps);
    }
}

/// The codes of the texel in column `x`, row `row` of a band.
fn codes_of_texel(plan: &BakePlan, band: &HeightBand<'_>, x: usize, row: usize, maps: &mut [CodesMut<'_>]) {
    let index = row * plan.size.width() + x;
    match (band, plan.slope) {
        (HeightBand::U8(band), Slope::Integer(slope)) => integer_texel(plan, slope, band, [x, row], maps, index),
        (HeightBand::U16(band), Slope::Integer(slope)) => integer_texel(plan, slope, band, [x, row], maps, index),
        (HeightBand::F32(band), Slope::Float(slope)) => {
            let around = band.neighbours(plan.edges.x, x, row);
            let normal = slope.normal(float_sums(plan.stencil, around));
            let mut maps = maps.iter_mut();
            if let Some(format) = plan.normal {
                store_floats(format.texel(), &normal, maps.next().expect("room for the normal map"), index);
            }
            if let Some(format) = plan.parallax {
                let parallax = float_parallax(normal[2], around[1][1]);
                store_floats(format.texel(), &[parallax], maps.next().expect("room for the parallax map"), index);
            }
        }
        _ => unreachable!("the plan was made for heights of another type"),
    }
}

fn integer_texel<T: Copy + Into<i32>>(
    plan: &BakePlan,
    slope: IntegerSlope,
    band: &Band<'_, T>,
    [x, row]: [usize; 2],
    maps: &mut [CodesMut<'_>],
    index: usize,
) {
    let around = band.neighbours(plan.edges.x, x, row);
    let (normal, s) = slope.normal(integer_sums(plan.stencil, around));
    let mut maps = maps.iter_mut();
    if let Some(format) = plan.normal {
        store_fractions(format.texel(), &normal, s, maps.next().expect("room for the normal map"), index);
    }
    if let Some(format) = plan.parallax {
        let greatest = plan.height_type.greatest_code().expect("heights are integers") as i32;
        let parallax = slope.parallax(around[1][1].into(), greatest);
        store_fractions(format.texel(), &[parallax], s, maps.next().expect("room for the parallax map"), index);
    }
}

/// Gx, Gy of integer codes, from the 3 x 3 heights around a texel.
#[inline(always)]
pub(crate) fn integer_sums<T: Copy + Into<i32>>(stencil: Stencil, around: [[T; 3]; 3]) -> [i32; 2] {
    let Stencil { centre, outer } = stencil;
    let [[nw, n, ne], [w, _, e], [sw, s, se]] = around;
    let rise = |from: T, to: T| to.into() - from.into();
    [
        outer * (rise(nw, ne) + rise(sw, se)) + centre * rise(w, e),
        outer * (rise(nw, sw) + rise(ne, se)) + centre * rise(n, s),
    ]
}

/// Gx / 64, Gy / 64 of floats, from the 3 x 3 heights around a texel.
#[inline(always)]
pub(crate) fn float_sums(stencil: Stencil, around: [[f32; 3]; 3]) -> [f32; 2] {
    let [centre, outer] = [stencil.centre as f32, stencil.outer as f32];
    let [[nw, n, ne], [w, _, e], [sw, s, se]] = around;
    let rise = |from: f32, to: f32| over_64(to) - over_64(from);
    [
        outer * (rise(nw, ne) + rise(sw, se)) + centre * rise(w, e),
        outer * (rise(nw, sw) + rise(ne, se)) + centre * rise(n, s),
    ]
}

/// A height over 64; below 2^-90 it counts as zero, so that no difference that matters is subnormal.
#[inline(always)]
fn over_64(height: f32) -> f32 {
    zero_below(2f32.powi(-90), height) * 2f32.powi(-6)
}

/// `value`, or zero if its magnitude is below `least`.
#[inline(always)]
pub(crate) fn zero_below(least: f32, value: f32) -> f32 {
    if value.abs() < least { 0.0 } else { value }
}

impl IntegerSlope {
    /// X, Y, Z and S.
    pub(crate) fn normal(&self, [gx, gy]: [i32; 2]) -> ([i64; 3], u128) {
        let normal = [i64::from(self.px) * i64::from(gx), i64::from(self.py) * i64::from(gy), self.z];
        let square = normal.iter().map(|part| u128::from(part.unsigned_abs()).pow(2)).sum();
        (normal, square)
    }

    /// n_z (2h - 1) times sqrt(S): Z (2H - M) / M, which is an integer where a parallax map is baked (DESIGN 3.1).
    #[inline(always)]
    pub(crate) fn parallax(&self, height: i32, greatest: i32) -> i64 {
        debug_assert!(self.z % i64::from(greatest) == 0, "the plan has a parallax map");
        self.z / i64::from(greatest) * i64::from(2 * height - greatest)
    }
}

/// n_z (2h - 1) in f32, in this order of operations; heights beyond 0 and 1 count as 0 and 1.
#[inline(always)]
pub(crate) fn float_parallax(z: f32, height: f32) -> f32 {
    zero_below(2f32.powi(-100), z * (2.0 * height.clamp(0.0, 1.0) - 1.0))
}

/// (x, y, z) over its length, in f32, in this order of operations; components below 2^-100 count as zero.
#[inline(always)]
pub(crate) fn unit([x, y, z]: [f32; 3]) -> [f32; 3] {
    let inverse = 1.0 / ((x * x + y * y) + z * z).sqrt();
    let component = |part: f32| zero_below(2f32.powi(-100), part * inverse);
    [component(x), component(y), component(z)]
}

impl FloatSlope {
    /// The unit normal, in f32, in this order of operations.
    #[inline(always)]
    pub(crate) fn normal(&self, [gx, gy]: [f32; 2]) -> [f32; 3] {
        // Slopes over 2^64. Below 2^-25 they count as zero, so that a flat map is flat on every device.
        let snapped = |slope| zero_below(2f32.powi(-25 - 64), slope);
        let [x, y] = [snapped(gx * self.kx), snapped(gy * self.ky)];
        // From 2^60 on, squares would overflow: then all three components are smaller by 2^94.
        let steep = x.abs().max(y.abs()) >= 2f32.powi(60 - 64);
        let (factor, z) = if steep { (2f32.powi(-30), 2f32.powi(-94)) } else { (2f32.powi(64), 1.0) };
        // Beside a slope of 2^60 and more, a component may be too small for a normal float.
        unit([x * factor, y * factor, z])
    }
}
