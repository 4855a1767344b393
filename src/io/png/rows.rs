//! The rows of a PNG that need no more than their filters undone: 8 or 16 bits, no palette, not interlaced.
//!
//! They are inflated on one thread and unfiltered on another, which takes a third off the time that a large map waits
//! for its heights.

use super::inflate::{self, FilteredRows, inflate_ahead};
use super::read::to_native_order;
use super::unfilter::unfilter;
use crate::error::Result;
use crate::io::damage::damaged;
use crate::io::samples::{Layout, SampleRows, bytes_mut, len};
use crate::map::HeightsMut;
use crate::stream::ReadAhead;
use std::path::PathBuf;

/// Rows from the top.
pub(super) struct PlainRows {
    path: PathBuf,
    layout: Layout,
    /// What is inflated, from the first row that is wanted on.
    inflated: Option<ReadAhead<FilteredRows>>,
    /// Rows of the current buffer that were used.
    used: usize,
    /// The row before the next one, as PNG orders its bytes.
    previous: Vec<u8>,
    next_row: usize,
}

impl PlainRows {
    /// The rows of a file whose header was read.
    pub fn new(path: PathBuf, layout: Layout) -> Self {
        Self { path, layout, inflated: None, used: 0, previous: vec![0; layout.row_bytes()], next_row: 0 }
    }

    /// Unfilters the next row, below `above`.
    fn next_row(&mut self, above: &[u8], row: &mut [u8]) -> Result<()> {
        let texel_bytes = self.layout.per_texel() * self.layout.depth.bytes();
        let inflated = match &mut self.inflated {
            Some(inflated) => inflated,
            none => none.insert(inflate_ahead(&self.path, 1 + row.len(), self.layout.size.height())?),
        };
        if inflated.current().is_none_or(|rows| self.used == rows.count()) {
            inflated.next()?;
            self.used = 0;
        }
        let rows = inflated.current().ok_or_else(|| damaged(&self.path, "it holds too few rows"))?;
        let (filter, filtered) = rows.row(self.used);
        if !unfilter(filter, filtered, above, texel_bytes, row) {
            return Err(damaged(&self.path, format!("Unknown filter method {filter}")));
        }
        self.used += 1;
        self.next_row += 1;
        if self.next_row == self.layout.size.height() {
            // What follows the last row must be sound too.
            inflated.next()?;
        }
        Ok(())
    }
}

impl SampleRows for PlainRows {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn read(&mut self, mut rows: HeightsMut<'_>) -> Result<()> {
        let row_bytes = self.layout.row_bytes();
        let count = len(&rows) / self.layout.per_row();
        let bytes = bytes_mut(&mut rows);
        let mut previous = std::mem::take(&mut self.previous);
        for row in 0..count {
            let (done, rest) = bytes.split_at_mut(row * row_bytes);
            let above = if row == 0 { &previous } else { &done[done.len() - row_bytes..] };
            self.next_row(above, &mut rest[..row_bytes])?;
        }
        if let Some(last) = bytes.rchunks_exact(row_bytes).next() {
            previous.copy_from_slice(last);
        }
        self.previous = previous;
        to_native_order(rows);
        Ok(())
    }

    /// Deflate has no entry points: to go back is to begin again, to go on is to decode.
    fn seek(&mut self, row: usize) -> Result<()> {
        if row < self.next_row {
            (self.inflated, self.used, self.next_row) = (None, 0, 0);
            self.previous.fill(0);
        }
        let mut skipped = self.previous.clone();
        while self.next_row < row {
            let previous = std::mem::take(&mut self.previous);
            self.next_row(&previous, &mut skipped)?;
            self.previous = std::mem::replace(&mut skipped, previous);
        }
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        false
    }

    fn held_bytes(&self) -> u64 {
        let row = self.layout.row_bytes();
        inflate::held_bytes(1 + row, self.layout.size.height()) + 2 * row as u64
    }
}
