//! A map without its border: of a tile that was baked with its halo, the tile is written.

use crate::error::Result;
use crate::map::{Codes, CodesRef, Size, TexelFormat};
use crate::stream::{RowSink, RowsOut};

/// Takes rows of a map and writes all but the first and the last one, each without its first and last texel.
pub(crate) struct Cropped {
    sink: RowsOut,
    /// Of the map without its border.
    size: Size,
    format: TexelFormat,
}

impl Cropped {
    /// For `sink`, which takes a map of `size`.
    pub fn new(sink: RowsOut, size: Size, format: TexelFormat) -> Self {
        Self { sink, size, format }
    }
}

impl RowSink for Cropped {
    /// What the sink holds, and the rows without their border.
    fn held_bytes(&self, rows: usize) -> u64 {
        let cropped = rows * self.size.width() * self.format.bytes();
        self.sink.held_bytes(rows) + cropped as u64
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let Self { size, format, .. } = *self;
        let (width, texel_bytes) = (size.width(), format.bytes());
        let wide_bytes = (width + 2) * texel_bytes;
        let end = first + rows.bytes().len() / wide_bytes;
        let kept = first.max(1)..end.min(1 + size.height());
        if kept.is_empty() {
            return Ok(());
        }
        let mut codes = Codes::zeroed(format.depth, kept.len() * format.row_codes(width));
        let wide_rows = rows.bytes().chunks_exact(wide_bytes).skip(kept.start - first);
        let mut all = codes.as_mut();
        for (row, wide) in all.bytes_mut().chunks_exact_mut(width * texel_bytes).zip(wide_rows) {
            row.copy_from_slice(&wide[texel_bytes..][..row.len()]);
        }
        self.sink.write(kept.start - 1, codes.as_ref())
    }

    fn complete(&mut self) -> Result<()> {
        self.sink.complete()
    }

    fn finish(self: Box<Self>) -> Result<()> {
        self.sink.finish()
    }
}
