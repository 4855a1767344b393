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

/// The levels of a texture from the largest, as [`Size::levels`], or the largest alone; all without an offset as yet.
pub fn levels(size: Size, mips: bool, format: &TextureFormat) -> Vec<Level> {
    let level = |size: Size| {
        let (width, height) = (size.width(), size.height());
        let row_bytes = width.div_ceil(format.side()) * format.bytes;
        let bytes = row_bytes as u64 * height.div_ceil(format.side()) as u64;
        Level { width, height, row_bytes, bytes, offset: 0 }
    };
    let levels = size.levels();
    let count = if mips { levels.len() } else { 1 };
    levels.take(count).map(level).collect()
}
