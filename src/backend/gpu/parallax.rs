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
use crate::map::{Size, TexelFormat};
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
            heights: Input::heights(self.height_type.greatest_code(), places.inputs[0]),
            normals: Input::normals(&self.normals, places.inputs[1]),
            parallax: Output::new(self.format.texel(), places.outputs[0]),
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

/// Whether the code is an integer, and m A, m^2 S and all that a comparison multiplies stay within 32 and 64 bits.
fn fits_64_bits(plan: &ParallaxPlan) -> bool {
    let rounding = CodeRounding::new(plan.format.texel());
    let (Some(m), Some(l), Some(rounding)) = (plan.height_type.greatest_code(), plan.normals.codes, rounding) else {
        return false;
    };
    let square = |number: u32| u128::from(number).pow(2);
    let s = square(m) * 3 * square(l.greatest as u32);
    s * square(rounding.m as u32) < 1 << 64
}
