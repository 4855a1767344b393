//! How one map lies in a kernel's inputs, and what its codes mean.

use super::operation::Rows;
use crate::map::{Depth, Encoding, HeightType, TexelFormat};
use crate::ops::LayerReading;
use bytemuck::{Pod, Zeroable};

/// `Input` of kernels/shared/read_codes.wgsl; the words mean what they say there.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Input {
    pub place: u32,
    pub row_words: u32,
    pub flip: u32,
    pub factor: i32,
    pub centre: i32,
    pub greatest: i32,
    pub over_greatest: u32,
    pub green: i32,
}

impl Input {
    /// A normal map in these rows.
    pub fn normals(reading: &LayerReading, rows: Rows) -> Self {
        let greatest = reading.codes.map(|codes| codes.greatest as u32);
        let mut input = Self { green: reading.green, ..Self::heights(greatest, rows) };
        if let Some(codes) = reading.codes {
            (input.flip, input.factor, input.centre) = (codes.flip, codes.factor, codes.centre);
        }
        input
    }

    /// Heights or a mask in these rows; `None` for floats.
    pub fn heights(greatest: Option<u32>, rows: Rows) -> Self {
        let mut input = Self { place: rows.place, row_words: rows.words, ..Self::default() };
        if let Some(greatest) = greatest {
            (input.greatest, input.over_greatest) = (greatest as i32, (1.0 / greatest as f32).to_bits());
        }
        input
    }
}

/// Bits of a code as it arrives, for a kernel's constants: half floats arrive as floats.
pub(super) fn input_bits(depth: Depth) -> u32 {
    match depth {
        Depth::Float16 => 32,
        _ => 8 * depth.bytes() as u32,
    }
}

/// Heights or a mask as a layer.
pub(super) fn one_channel(height_type: HeightType) -> TexelFormat {
    let (encoding, depth) = match height_type {
        HeightType::U8 => (Encoding::Unorm, Depth::Bits8),
        HeightType::U16 => (Encoding::Unorm, Depth::Bits16),
        HeightType::F32 => (Encoding::Float, Depth::Float32),
    };
    TexelFormat { encoding, depth, channels: 1 }
}
