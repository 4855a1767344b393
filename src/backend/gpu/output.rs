//! How one map lies in a kernel's outputs.

use super::operation::Rows;
use crate::exact::CodeRounding;
use crate::map::{Depth, TexelFormat};
use bytemuck::{Pod, Zeroable};

/// `Output` of kernels/shared/codes.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Output {
    pub place: u32,
    pub row_words: u32,
    pub code_m: i32,
    pub code_c: i32,
    pub code_least: i32,
    pub code_greatest: i32,
    pub code_offset: i32,
    pub code_mask: u32,
}

impl Output {
    /// A map of this format in these rows.
    pub fn new(format: TexelFormat, rows: Rows) -> Self {
        let mut output = Self { place: rows.place, row_words: rows.words, ..Self::default() };
        if let Some(CodeRounding { m, c, least, greatest, offset, mask }) = CodeRounding::new(format) {
            (output.code_m, output.code_c) = (m, c);
            (output.code_least, output.code_greatest) = (least, greatest);
            (output.code_offset, output.code_mask) = (offset, mask);
        }
        output
    }
}

/// Bits of a code, for a kernel's constants.
pub(super) fn bits(depth: Depth) -> u32 {
    8 * depth.bytes() as u32
}
