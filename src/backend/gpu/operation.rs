//! What a transfer needs to know of an operation.

use super::kernel::Kernel;
use crate::map::{CodesRef, TexelFormat};

/// Texels that one invocation computes: rows are padded to a multiple, up and down.
pub(super) const TEXELS_PER_INVOCATION: usize = 4;

/// Invocations of a workgroup, all in one row.
pub(super) const WORKGROUP: usize = 64;

/// Room for the parameters of any kernel.
pub(super) const PARAMS_BYTES: usize = 256;

/// One operation on one set of maps.
///
/// Every kernel reads `params`, `inputs` and writes `outputs`. The layers of a band lie one after the other in
/// `inputs`; the rows of each map, and then one mark for each row, in `outputs`.
pub(super) trait Operation {
    /// The kernel that runs it.
    fn kernel(&self) -> Kernel;

    /// Texels of a row.
    fn width(&self) -> usize;

    /// Bytes of a row of each layer, as [`row_bytes`] gives them.
    fn inputs(&self) -> Vec<usize>;

    /// How each map is stored.
    fn outputs(&self) -> Vec<TexelFormat>;

    /// The bytes of the kernel's `Params`, at most [`PARAMS_BYTES`].
    fn params(&self, places: &Places) -> Vec<u8>;
}

/// Some rows of a map on their way up. Half floats arrive as floats.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layer<'a> {
    pub rows: usize,
    /// The rows, one after the other, without padding.
    pub codes: CodesRef<'a>,
}

/// Where the rows of a map lie in a buffer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Rows {
    /// Word of the first row.
    pub place: u32,
    /// Words from one row to the next.
    pub words: u32,
}

/// Where everything of a dispatch lies.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Places {
    /// Rows that are computed.
    pub rows: u32,
    /// Each layer in `inputs`.
    pub inputs: Vec<Rows>,
    /// Each map in `outputs`.
    pub outputs: Vec<Rows>,
    /// Word of the first row's mark in `outputs`.
    pub marks: u32,
    /// What marks a row of this dispatch.
    pub nonce: u32,
    /// Which codes integers decide.
    pub doubt: Doubt,
}

/// Where a kernel's integers decide a code that its floats have estimated (kernels/shared/estimate.wgsl).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Doubt {
    /// Near a boundary, where the estimate could be wrong.
    #[default]
    Near,
    /// Wherever the estimate is not exact: a test of the integers, which have little to do otherwise.
    Everywhere,
}

impl Doubt {
    /// By what the least distance to a boundary is multiplied.
    pub fn factor(self) -> f32 {
        match self {
            Self::Near => 1.0,
            Self::Everywhere => 1e30,
        }
    }
}

/// Bytes of a row of `width` texels of `texel_bytes`, padded to what an invocation computes: whole words.
pub(super) fn row_bytes(width: usize, texel_bytes: usize) -> usize {
    width.next_multiple_of(TEXELS_PER_INVOCATION) * texel_bytes
}

/// Bytes of a row of each map.
pub(super) fn output_row_bytes(operation: &impl Operation) -> Vec<usize> {
    operation.outputs().iter().map(|format| row_bytes(operation.width(), format.bytes())).collect()
}

/// Bytes of a buffer for one row: of all layers, or of all maps and the row's mark.
pub(super) fn greatest_row_bytes(operation: &impl Operation) -> usize {
    let inputs: usize = operation.inputs().iter().sum();
    let outputs: usize = output_row_bytes(operation).iter().sum();
    inputs.max(outputs + 4)
}

/// Workgroups that compute a row.
pub(super) fn row_groups(width: usize) -> usize {
    width.div_ceil(TEXELS_PER_INVOCATION * WORKGROUP)
}
