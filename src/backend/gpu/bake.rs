//! The bake kernel's host side: which text, which constants, which parameters.

use super::device::Device;
use super::kernel::{BAKE_FAST, BAKE_FLOAT_HEIGHTS, BAKE_FLOATS, BAKE_INTEGERS, Kernel};
use super::operation::{Doubt, Layer, Operation, Places, row_bytes};
use super::output::{Output, bits};
use super::transfer::Transfer;
use crate::error::Result;
use crate::exact::CodeRounding;
use crate::map::{CodesRef, Depth, TexelFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, FloatSlope, IntegerSlope, Slope};
use crate::stream::{Band, CodeSink, HeightBand, HeightBands};
use bytemuck::{Pod, Zeroable};

/// `Params` of kernels/bake.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Params {
    pub width: u32,
    pub rows: u32,
    pub above: u32,
    pub body: u32,
    pub below: u32,
    pub row_words: u32,
    pub west_of_first: u32,
    pub east_of_last: u32,
    pub marks: u32,
    pub nonce: u32,
    pub px: i32,
    pub py: i32,
    pub z_low: u32,
    pub z_high: u32,
    pub z_over_m: u32,
    pub kx: u32,
    pub ky: u32,
    pub doubt: u32,
    pub reserved: u32,
    pub alpha: u32,
    pub normal: Output,
    pub parallax: Output,
}

impl Operation for BakePlan {
    fn kernel(&self) -> Kernel {
        kernel(self, self.normal.map_or(0, |format| format.channels.count()), true)
    }

    fn width(&self) -> usize {
        self.size.width()
    }

    /// The row above, the band, the row below.
    fn inputs(&self) -> Vec<usize> {
        vec![row_bytes(self.size.width(), self.height_type.bytes()); 3]
    }

    fn outputs(&self) -> Vec<TexelFormat> {
        BakePlan::outputs(self).collect()
    }

    fn params(&self, places: &Places) -> Vec<u8> {
        bytemuck::bytes_of(&params(self, places)).to_vec()
    }
}

/// Bakes all bands on a device, untested.
pub(super) fn run(
    device: &Device,
    plan: &BakePlan,
    doubt: Doubt,
    bands: &mut dyn HeightBands,
    sinks: &mut [&mut dyn CodeSink],
) -> Result<()> {
    let mut transfer = Transfer::new(device, plan, doubt)?;
    while let Some(band) = bands.next()? {
        transfer.send(band.rows(), |rows| layers(&band.part(rows.start, rows.len())), sinks)?;
    }
    transfer.finish(sinks)
}

/// The row above, the rows and the row below of a band.
pub(super) fn layers<'a>(band: &HeightBand<'a>) -> Vec<Layer<'a>> {
    fn cut<'a, T>(band: &Band<'a, T>, codes: impl Fn(&'a [T]) -> CodesRef<'a>) -> Vec<Layer<'a>> {
        let layer = |rows, heights| Layer { rows, codes: codes(heights) };
        vec![layer(1, band.above), layer(band.body.len() / band.width, band.body), layer(1, band.below)]
    }
    match band {
        HeightBand::U8(band) => cut(band, CodesRef::U8),
        HeightBand::U16(band) => cut(band, CodesRef::U16),
        HeightBand::F32(band) => cut(band, CodesRef::F32),
    }
}

/// The kernel for a plan that stores `normal_codes` codes for a normal and, if `marked`, a mark for each row.
pub(super) fn kernel(plan: &BakePlan, normal_codes: usize, marked: bool) -> Kernel {
    let source = match (plan.precision, plan.slope) {
        (Precision::Fast, _) => BAKE_FAST,
        (Precision::Exact, Slope::Float(_)) => BAKE_FLOAT_HEIGHTS,
        (Precision::Exact, Slope::Integer(_)) if plan.outputs().any(|format| format.depth.is_float()) => BAKE_FLOATS,
        (Precision::Exact, Slope::Integer(_)) => BAKE_INTEGERS,
    };
    let normal_depth = plan.normal.unwrap_or_default().depth;
    let parallax_depth = plan.parallax.map(|format| format.depth);
    let mut constants = vec![
        ("HEIGHT_BITS", 8 * plan.height_type.bytes() as u32),
        ("NORMAL_CODES", normal_codes as u32),
        ("NORMAL_BITS", bits(normal_depth)),
        ("NORMAL_IS_FLOAT", normal_depth.is_float().into()),
        ("PARALLAX_BITS", parallax_depth.map_or(0, bits)),
        ("PARALLAX_IS_FLOAT", parallax_depth.is_some_and(Depth::is_float).into()),
        ("CENTRE", plan.stencil.centre as u32),
        ("OUTER", plan.stencil.outer as u32),
        ("MARKED", marked.into()),
    ];
    if source != BAKE_FAST {
        constants.push(("ESTIMATED", can_be_estimated(plan).into()));
    }
    if [BAKE_INTEGERS, BAKE_FLOATS].contains(&source) {
        constants.push(("NARROW", fits_64_bits(plan).into()));
    }
    Kernel { source, constants }
}

/// The parameters of a bake of rows that lie there: the row above, the band, the row below.
pub(super) fn params(plan: &BakePlan, places: &Places) -> Params {
    let width = plan.size.width();
    let [above, body, below] = [0, 1, 2].map(|layer| places.inputs[layer]);
    let mut outputs = places.outputs.iter();
    let mut output = |format: Option<TexelFormat>| {
        let format_and_rows = format.map(|format| (format, outputs.next().copied().unwrap_or_default()));
        format_and_rows.map_or(Output::default(), |(format, rows)| Output::new(format, rows))
    };
    let mut params = Params {
        width: width as u32,
        rows: places.rows,
        above: above.place,
        body: body.place,
        below: below.place,
        row_words: body.words,
        west_of_first: plan.edges.x.resolve(-1, width) as u32,
        east_of_last: plan.edges.x.resolve(width as isize, width) as u32,
        marks: places.marks,
        nonce: places.nonce,
        doubt: places.doubt.factor().to_bits(),
        alpha: plan.normal.map_or(0, |format| code_of_one(format.texel())),
        normal: output(plan.normal.map(|format| format.texel())),
        parallax: output(plan.parallax.map(|format| format.texel())),
        ..Params::zeroed()
    };
    if let Slope::Integer(IntegerSlope { px, py, z }) = plan.slope {
        (params.px, params.py) = (px, py);
        (params.z_low, params.z_high) = (z as u32, (z >> 32) as u32);
    }
    if let (Slope::Integer(slope), Some(greatest), true) =
        (plan.slope, plan.height_type.greatest_code(), plan.parallax.is_some())
    {
        // Of a plan with a parallax map it is an integer, q D at most: below 2^29.
        params.z_over_m = (slope.z / i64::from(greatest)) as u32;
    }
    let FloatSlope { kx, ky } = plan.float_slope();
    (params.kx, params.ky) = (kx.to_bits(), ky.to_bits());
    params
}

/// The code of 1, for the alpha channel of an opaque texture.
fn code_of_one(format: TexelFormat) -> u32 {
    match (format.depth, CodeRounding::new(format)) {
        (_, Some(rounding)) => rounding.stored(rounding.greatest),
        (Depth::Float16, None) => half::f16::ONE.to_bits().into(),
        (_, None) => 1f32.to_bits(),
    }
}

/// Whether kernels/shared/estimate.wgsl does for all codes: of 8 bits, or of a short S. Differences of float heights that
/// a stencil adds up can cancel.
fn can_be_estimated(plan: &BakePlan) -> bool {
    let has_bytes = plan.outputs().all(|format| format.depth == Depth::Bits8);
    match plan.slope {
        Slope::Integer(_) => has_bytes || greatest_s(plan).is_some_and(|s| s < 1 << 49),
        Slope::Float(_) => has_bytes && plan.stencil.outer == 0,
    }
}

/// The greatest S = X^2 + Y^2 + Z^2; floats have none.
fn greatest_s(plan: &BakePlan) -> Option<u128> {
    let Slope::Integer(IntegerSlope { px, py, z }) = plan.slope else { return None };
    let greatest_sum = u128::from(plan.height_type.greatest_code()?) * (plan.stencil.divisor() as u128 / 2);
    let squares = [px, py].map(|p| (u128::from(p.unsigned_abs()) * greatest_sum).pow(2));
    Some(squares[0] + squares[1] + (z as u128).pow(2))
}

/// Whether all codes are integers, and m A, m^2 S and all that a comparison multiplies stay within 32 and 64 bits.
fn fits_64_bits(plan: &BakePlan) -> bool {
    let Some(s) = greatest_s(plan) else { return false };
    let fits =
        |rounding: CodeRounding| s.checked_mul((rounding.m as u128).pow(2)).is_some_and(|product| product < 1 << 64);
    plan.outputs().all(|format| CodeRounding::new(format).is_some_and(fits))
}
