//! The mip levels of a texture, and how many bytes they take.

use super::format::TextureFormat;
use crate::map::Size;

/// One level in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Texels in a row.
    pub width: usize,
    /// Rows of texels.
    pub height: usize,
    /// Bytes of a row of texels, or of a row of blocks.
    pub row_bytes: usize,
    /// Bytes of all rows.
    pub bytes: u64,
    /// Where they begin in the file.
    pub offset: u64,
}

/// The levels of a texture from the largest, level k of max(1, floor(w / 2^k)) x max(1, floor(h / 2^k)) texels down to
/// a single one, or the largest alone; all without an offset as yet.
pub fn levels(size: Size, mips: bool, format: &TextureFormat) -> Vec<Level> {
    let count = if mips { 1 + size.width().max(size.height()).ilog2() } else { 1 };
    let level = |level: u32| {
        let [width, height] = [size.width(), size.height()].map(|side| (side >> level).max(1));
        let row_bytes = width.div_ceil(format.side()) * format.bytes;
        let bytes = row_bytes as u64 * height.div_ceil(format.side()) as u64;
        Level { width, height, row_bytes, bytes, offset: 0 }
    };
    (0..count).map(level).collect()
}
