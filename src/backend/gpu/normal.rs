//! The normal kernel's host side: which text, which constants, which parameters.

use super::kernel::{KernelSource, NORMAL_FAST, NORMAL_FLOAT_HEIGHTS, NORMAL_INTEGER_CODES, NORMAL_INTEGER_FLOATS};
use crate::exact::CodeRounding;
use crate::map::{Depth, Encoding, HeightType, NormalFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, FloatSlope, IntegerSlope, Slope, Stencil};
use bytemuck::{Pod, Zeroable};

/// Texels that one invocation computes: rows of codes are padded to a multiple.
pub(super) const TEXELS_PER_INVOCATION: usize = 4;
/// Invocations of a workgroup, all in one row.
pub(super) const WORKGROUP: usize = 64;

/// `Params` of kernels/normal.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct Params {
    pub width: u32,
    pub rows: u32,
    pub above: u32,
    pub body: u32,
    pub below: u32,
    pub row_words: u32,
    pub west_of_first: u32,
    pub east_of_last: u32,
    pub codes: u32,
    pub codes_row_words: u32,
    pub marks: u32,
    pub nonce: u32,
    pub px: i32,
    pub py: i32,
    pub z_low: u32,
    pub z_high: u32,
    pub kx: u32,
    pub ky: u32,
    pub centre: i32,
    pub outer: i32,
    pub alpha: u32,
    pub code_m: i32,
    pub code_c: i32,
    pub code_least: i32,
    pub code_greatest: i32,
    pub code_offset: i32,
    pub code_mask: u32,
    pub reserved: u32,
}

/// A compiled kernel: its text and the constants that choose among its branches.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct NormalKernel {
    pub source: KernelSource,
    height_bits: u32,
    code_bits: u32,
    code_is_float: bool,
    codes_per_texel: usize,
    marked: bool,
    narrow: bool,
}

impl NormalKernel {
    /// The kernel for a plan that stores `codes_per_texel` codes for a texel and, if `marked`, a mark for each row.
    pub fn new(plan: &BakePlan, codes_per_texel: usize, marked: bool) -> Self {
        let rounding = CodeRounding::new(format(plan).texel());
        let source = match (plan.precision, plan.slope) {
            (Precision::Fast, _) => NORMAL_FAST,
            (Precision::Exact, Slope::Float(_)) => NORMAL_FLOAT_HEIGHTS,
            (Precision::Exact, Slope::Integer(_)) if rounding.is_none() => NORMAL_INTEGER_FLOATS,
            (Precision::Exact, Slope::Integer(_)) => NORMAL_INTEGER_CODES,
        };
        let narrow = match (plan.slope, rounding) {
            (Slope::Integer(slope), Some(rounding)) => fits_64_bits(slope, plan.stencil, plan.height_type, rounding),
            _ => false,
        };
        Self {
            source,
            height_bits: 8 * plan.height_type.bytes() as u32,
            code_bits: 8 * format(plan).depth.bytes() as u32,
            code_is_float: rounding.is_none(),
            codes_per_texel,
            marked,
            narrow,
        }
    }

    /// The values of the kernel's overrides.
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        let mut constants = vec![
            ("MARKED", f64::from(u8::from(self.marked))),
            ("HEIGHT_BITS", f64::from(self.height_bits)),
            ("CODE_BITS", f64::from(self.code_bits)),
            ("CODE_IS_FLOAT", f64::from(u8::from(self.code_is_float))),
            ("CODES_PER_TEXEL", self.codes_per_texel as f64),
        ];
        if self.source == NORMAL_INTEGER_CODES {
            constants.push(("NARROW", f64::from(u8::from(self.narrow))));
        }
        constants
    }

    /// Bytes of a row of codes of `width` texels as the kernel stores it.
    pub fn codes_row_bytes(&self, width: usize) -> usize {
        width.next_multiple_of(TEXELS_PER_INVOCATION) * self.codes_per_texel * self.code_bits as usize / 8
    }
}

/// Bytes of a row of heights as the kernel reads it.
pub(super) fn heights_row_bytes(width: usize, height_type: HeightType) -> usize {
    width.next_multiple_of(TEXELS_PER_INVOCATION) * height_type.bytes()
}

/// What `Params` takes from the plan; places and sizes are for the caller.
pub(super) fn params(plan: &BakePlan) -> Params {
    let width = plan.size.width();
    let mut params = Params {
        width: width as u32,
        west_of_first: plan.edges.x.resolve(-1, width) as u32,
        east_of_last: plan.edges.x.resolve(width as isize, width) as u32,
        centre: plan.stencil.centre,
        outer: plan.stencil.outer,
        alpha: code_of_one(format(plan)),
        ..Params::zeroed()
    };
    if let Some(rounding) = CodeRounding::new(format(plan).texel()) {
        (params.code_m, params.code_c) = (rounding.m, rounding.c);
        (params.code_least, params.code_greatest) = (rounding.least, rounding.greatest);
        (params.code_offset, params.code_mask) = (rounding.offset, rounding.mask);
    }
    if let Slope::Integer(IntegerSlope { px, py, z }) = plan.slope {
        (params.px, params.py) = (px, py);
        (params.z_low, params.z_high) = (z as u32, (z >> 32) as u32);
    }
    let FloatSlope { kx, ky } = plan.float_slope();
    (params.kx, params.ky) = (kx.to_bits(), ky.to_bits());
    params
}

/// The code of 1, for the alpha channel of an opaque texture.
fn code_of_one(format: NormalFormat) -> u32 {
    match (format.depth, CodeRounding::new(format.texel())) {
        (_, Some(_)) if format.encoding == Encoding::Biased => (1 << (8 * format.depth.bytes())) - 1,
        (_, Some(rounding)) => rounding.stored(rounding.greatest),
        (Depth::Float16, None) => half::f16::ONE.to_bits().into(),
        (_, None) => 1f32.to_bits(),
    }
}

/// Whether m X, m^2 S and all that the comparison multiplies stay within 32 and 64 bits.
fn fits_64_bits(slope: IntegerSlope, stencil: Stencil, height_type: HeightType, rounding: CodeRounding) -> bool {
    let greatest_sum = u128::from(height_type.greatest_code().unwrap_or(0)) * (stencil.divisor() as u128 / 2);
    let squares = [slope.px.unsigned_abs(), slope.py.unsigned_abs()].map(|p| (u128::from(p) * greatest_sum).pow(2));
    let s = squares[0] + squares[1] + (slope.z as u128).pow(2);
    s.checked_mul((rounding.m as u128).pow(2)).is_some_and(|product| product < 1 << 64)
}

/// The format of the normal map.
pub(super) fn format(plan: &BakePlan) -> NormalFormat {
    plan.normal.unwrap_or_default()
}
