//! The blend kernel's host side: which text, which constants, which parameters.

use super::input::{Input, input_bits, one_channel};
use super::kernel::{BLEND_FAST, BLEND_FLOATS, BLEND_INTEGERS, Kernel};
use super::layers::{LayerOperation, input_row_bytes};
use super::operation::{Operation, Places};
use super::output::{Output, bits};
use crate::backend::Backend;
use crate::backend::cpu::Reference;
use crate::error::Result;
use crate::exact::CodeRounding;
use crate::map::{Depth, Size, TexelFormat};
use crate::ops::Precision;
use crate::ops::blend::{BlendMethod, BlendPlan};
use crate::stream::{CodeSink, LayerBands};
use bytemuck::{Pod, Zeroable};

/// `Params` of kernels/blend.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Params {
    pub width: u32,
    pub rows: u32,
    pub marks: u32,
    pub nonce: u32,
    pub a: i32,
    pub b: i32,
    pub q: i32,
    pub doubt: u32,
    pub base: Input,
    pub detail: Input,
    pub mask: Input,
    pub normal: Output,
}

impl Operation for BlendPlan {
    fn kernel(&self) -> Kernel {
        let source = match (self.precision, self.integer_scales()) {
            (Precision::Fast, _) => BLEND_FAST,
            (Precision::Exact, None) => BLEND_FLOATS,
            (Precision::Exact, Some(_)) => BLEND_INTEGERS,
        };
        let [base, detail] = self.inputs;
        let mut constants = vec![
            ("METHOD", number(self.method)),
            ("BASE_CODES", base.channels.count() as u32),
            ("BASE_BITS", input_bits(base.depth)),
            ("DETAIL_CODES", detail.channels.count() as u32),
            ("DETAIL_BITS", input_bits(detail.depth)),
            ("MASK_BITS", self.mask.map_or(0, |mask| 8 * mask.height_type.bytes() as u32)),
            ("NORMAL_CODES", self.format.channels.count() as u32),
            ("NORMAL_BITS", bits(self.format.depth)),
            ("NORMAL_IS_FLOAT", self.format.depth.is_float().into()),
            ("MARKED", 1),
        ];
        if source == BLEND_INTEGERS {
            constants.push(("ESTIMATED", can_be_estimated(self).into()));
            constants.push(("S_BITS", s_bits(self)));
        }
        Kernel { source, constants }
    }

    fn width(&self) -> usize {
        self.size.width()
    }

    fn inputs(&self) -> Vec<usize> {
        input_row_bytes(self)
    }

    fn outputs(&self) -> Vec<TexelFormat> {
        vec![self.format.texel()]
    }

    fn params(&self, places: &Places) -> Vec<u8> {
        let mask_rows = places.inputs.get(2).copied().unwrap_or_default();
        let params = Params {
            width: self.size.width() as u32,
            rows: places.rows,
            marks: places.marks,
            nonce: places.nonce,
            a: self.weights.base,
            b: self.weights.detail,
            q: self.weights.q as i32,
            doubt: places.doubt.factor().to_bits(),
            base: Input::normals(&self.layers[0], places.inputs[0]),
            detail: Input::normals(&self.layers[1], places.inputs[1]),
            mask: Input::heights(self.mask.map(|mask| mask.greatest), mask_rows),
            normal: Output::new(self.format.texel(), places.outputs[0]),
        };
        bytemuck::bytes_of(&params).to_vec()
    }
}

impl LayerOperation for BlendPlan {
    /// The base, the detail and, perhaps, the mask.
    fn layers(&self) -> Vec<TexelFormat> {
        let maps = self.inputs.iter().map(|format| format.texel());
        maps.chain(self.mask.map(|mask| one_channel(mask.height_type))).collect()
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn of_size(&self, size: Size) -> Self {
        Self { size, ..*self }
    }

    fn reference(&self, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        Reference.blend(self, bands, sink)
    }
}

/// `METHOD` of kernels/blend.wgsl.
fn number(method: BlendMethod) -> u32 {
    match method {
        BlendMethod::Weighted { .. } | BlendMethod::Masked => 0,
        BlendMethod::Linear => 1,
        BlendMethod::Overlay => 2,
        BlendMethod::Udn => 3,
        BlendMethod::Whiteout => 4,
        BlendMethod::Rnm => 5,
    }
}

/// `ESTIMATED` of kernels/blend/integers.wgsl: whether floats and 32 bits do for every texel.
fn can_be_estimated(plan: &BlendPlan) -> bool {
    let Some(scales) = plan.integer_scales() else { return false };
    let [leaning, z] = plan.greatest_parts(scales);
    let is_short = 2 * leaning.pow(2) + z.pow(2) < 1 << 49;
    leaning.max(z) < 1 << 31 && (plan.format.depth == Depth::Bits8 || is_short)
}

/// `S_BITS` of kernels/blend/integers.wgsl: the fewest that are enough for every texel.
pub(super) fn s_bits(plan: &BlendPlan) -> u32 {
    let (Some(scales), Some(rounding)) = (plan.integer_scales(), CodeRounding::new(plan.format.texel())) else {
        return 128;
    };
    let [leaning, z] = plan.greatest_parts(scales);
    let s = 2 * leaning.pow(2) + z.pow(2);
    // The reoriented sum is always one of 64-bit numbers.
    let is_narrow = plan.method != BlendMethod::Rnm && (rounding.m as u128).pow(2) * s < 1 << 64;
    match s {
        _ if is_narrow => 64,
        ..0x1_0000_0000_0000_0000_0000_0000 => 96,
        _ => 128,
    }
}
