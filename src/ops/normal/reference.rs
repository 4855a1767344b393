//! The specification: one texel after the other, in plain code.

use super::{FloatSlope, IntegerSlope, NormalPlan, Slope, Stencil};
use crate::exact::{CodeRounding, nearest_f16, nearest_f32};
use crate::map::{CodesMut, NormalFormat};
use crate::stream::HeightBand;
use half::f16;

/// The codes of all texels of a band.
pub(crate) fn codes_of_band(plan: &NormalPlan, band: &HeightBand<'_>, codes: &mut CodesMut<'_>) {
    let width = plan.size.width();
    for texel in 0..band.rows() * width {
        codes_of_texel(plan, band, texel % width, texel / width, codes);
    }
}

/// The codes of the texel in column `x`, row `row` of a band.
pub(crate) fn codes_of_texel(plan: &NormalPlan, band: &HeightBand<'_>, x: usize, row: usize, codes: &mut CodesMut<'_>) {
    let index = row * plan.size.width() + x;
    match (band, plan.slope) {
        (HeightBand::U8(band), Slope::Integer(slope)) => {
            let sums = integer_sums(plan.stencil, band.neighbours(plan.edges.x, x, row));
            store_fraction(plan.format, slope.normal(sums), codes, index);
        }
        (HeightBand::U16(band), Slope::Integer(slope)) => {
            let sums = integer_sums(plan.stencil, band.neighbours(plan.edges.x, x, row));
            store_fraction(plan.format, slope.normal(sums), codes, index);
        }
        (HeightBand::F32(band), Slope::Float(slope)) => {
            let sums = float_sums(plan.stencil, band.neighbours(plan.edges.x, x, row));
            store_float(plan.format, slope.normal(sums), codes, index);
        }
        _ => unreachable!("the plan was made for heights of another type"),
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
fn zero_below(least: f32, value: f32) -> f32 {
    if value.abs() < least { 0.0 } else { value }
}

impl IntegerSlope {
    /// X, Y, Z and S.
    pub(crate) fn normal(&self, [gx, gy]: [i32; 2]) -> ([i64; 3], u128) {
        let normal = [i64::from(self.px) * i64::from(gx), i64::from(self.py) * i64::from(gy), self.z];
        let square = normal.iter().map(|part| u128::from(part.unsigned_abs()).pow(2)).sum();
        (normal, square)
    }
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
        let (unit, z) = if steep { (2f32.powi(-30), 2f32.powi(-94)) } else { (2f32.powi(64), 1.0) };
        let [x, y] = [x * unit, y * unit];
        let inverse = 1.0 / ((x * x + y * y) + z * z).sqrt();
        // Beside a slope of 2^60 and more, a component may be too small for a normal float.
        let component = |part: f32| zero_below(2f32.powi(-100), part * inverse);
        [component(x), component(y), component(z)]
    }
}

/// Stores the components of (X, Y, Z) / sqrt(S), correctly rounded.
fn store_fraction(format: NormalFormat, (normal, s): ([i64; 3], u128), codes: &mut CodesMut<'_>, index: usize) {
    let rounding = || CodeRounding::new(format.encoding, format.depth).expect("checked with the options");
    let channels = format.channels.count();
    for (channel, &component) in normal[..channels].iter().enumerate() {
        let at = index * channels + channel;
        match codes {
            CodesMut::U8(codes) => codes[at] = rounding().code(component, s) as u8,
            CodesMut::U16(codes) => codes[at] = rounding().code(component, s) as u16,
            CodesMut::F16(codes) => codes[at] = nearest_f16(component, s),
            CodesMut::F32(codes) => codes[at] = nearest_f32(component, s),
        }
    }
}

/// Stores the components of a float normal: rounded half up in f32 for integer codes, half to even for f16.
fn store_float(format: NormalFormat, normal: [f32; 3], codes: &mut CodesMut<'_>, index: usize) {
    let rounding = || CodeRounding::new(format.encoding, format.depth).expect("checked with the options");
    let channels = format.channels.count();
    for (channel, &component) in normal[..channels].iter().enumerate() {
        let at = index * channels + channel;
        match codes {
            CodesMut::U8(codes) => codes[at] = code_of_float(rounding(), component) as u8,
            CodesMut::U16(codes) => codes[at] = code_of_float(rounding(), component) as u16,
            CodesMut::F16(codes) => codes[at] = f16::from_f32(component),
            CodesMut::F32(codes) => codes[at] = component,
        }
    }
}

/// floor((m v + c + 1) / 2) in f32, in this order: v (m/2) + (c + 1)/2. Each constant is exact.
fn code_of_float(rounding: CodeRounding, component: f32) -> u32 {
    let code = component * (rounding.m as f32 * 0.5) + (rounding.c as f32 + 1.0) * 0.5;
    rounding.stored(code.floor() as i32)
}
