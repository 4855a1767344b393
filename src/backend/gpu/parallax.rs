//! The parallax kernel's host side: which text, which constants, which parameters.

use super::input::{Input, input_bits, one_channel};
use super::kernel::{Kernel, PARALLAX_FAST, PARALLAX_FLOATS, PARALLAX_INTEGERS};
use super::layers::{LayerOperation, input_row_bytes};
use super::operation::{Operation, Places};
use super::output::{Output, bits};
use crate::backend::Backend;
use crate::backend::cpu::Reference;
use crate::error::Result;
use crate::exact::CodeRounding;
use crate::map::{Depth, Size, TexelFormat};
use crate::ops::Precision;
use crate::ops::parallax::ParallaxPlan;
use crate::stream::{CodeSink, LayerBands};
use bytemuck::{Pod, Zeroable};

/// `Params` of kernels/parallax.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Params {
    pub width: u32,
    pub rows: u32,
    pub marks: u32,
    pub nonce: u32,
    pub doubt: u32,
    pub reserved_1: u32,
    pub reserved_2: u32,
    pub reserved_3: u32,
    pub heights: Input,
    pub normals: Input,
    pub parallax: Output,
}

impl Operation for ParallaxPlan {
    fn kernel(&self) -> Kernel {
        let are_integers = self.height_type.greatest_code().is_some() && self.normals.codes.is_some();
        let source = match (self.precision, are_integers) {
            (Precision::Fast, _) => PARALLAX_FAST,
            (Precision::Exact, false) => PARALLAX_FLOATS,
            (Precision::Exact, true) => PARALLAX_INTEGERS,
        };
        let mut constants = vec![
            ("HEIGHT_BITS", 8 * self.height_type.bytes() as u32),
            ("NORMAL_CODES", self.input.channels.count() as u32),
            ("NORMAL_BITS", input_bits(self.input.depth)),
            ("PARALLAX_BITS", bits(self.format.depth)),
            ("PARALLAX_IS_FLOAT", self.format.depth.is_float().into()),
            ("MARKED", 1),
        ];
        if source == PARALLAX_INTEGERS {
            constants.push(("ESTIMATED", can_be_estimated(self).into()));
            constants.push(("NARROW", fits_64_bits(self).into()));
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
        let params = Params {
            width: self.size.width() as u32,
            rows: places.rows,
            marks: places.marks,
            nonce: places.nonce,
            doubt: places.doubt.factor().to_bits(),
            heights: Input::heights(self.height_type.greatest_code(), places.inputs[0]),
            normals: Input::normals(&self.normals, places.inputs[1]),
            parallax: Output::new(self.format.texel(), places.outputs[0]),
            ..Params::default()
        };
        bytemuck::bytes_of(&params).to_vec()
    }
}

impl LayerOperation for ParallaxPlan {
    /// The heights and the normals.
    fn layers(&self) -> Vec<TexelFormat> {
        vec![one_channel(self.height_type), self.input.texel()]
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn of_size(&self, size: Size) -> Self {
        Self { size, ..*self }
    }

    fn reference(&self, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        Reference.parallax(self, bands, sink)
    }
}

/// Whether kernels/shared/estimate.wgsl does: for a code of 8 bits, or any of a short S.
fn can_be_estimated(plan: &ParallaxPlan) -> bool {
    plan.format.depth == Depth::Bits8 || greatest_s(plan).is_some_and(|s| s < 1 << 49)
}

/// The greatest S = M^2 (x^2 + y^2 + z^2); floats have none.
fn greatest_s(plan: &ParallaxPlan) -> Option<u128> {
    let [m, l] = [plan.height_type.greatest_code()?, plan.normals.codes?.greatest as u32];
    Some(3 * u128::from(m).pow(2) * u128::from(l).pow(2))
}

/// Whether the code is an integer, and m A, m^2 S and all that a comparison multiplies stay within 32 and 64 bits.
fn fits_64_bits(plan: &ParallaxPlan) -> bool {
    let rounding = CodeRounding::new(plan.format.texel());
    let (Some(s), Some(rounding)) = (greatest_s(plan), rounding) else { return false };
    s * (rounding.m as u128).pow(2) < 1 << 64
}
