//! The filtered rows of a PNG, inflated on a thread of their own: two thirds of a decoder's time.

use super::read::{READ_BYTES, reason};
use crate::error::{Error, Result};
use crate::io::damage::{damaged, truncated};
use crate::io::input;
use crate::stream::{BUFFERS, Filling, ReadAhead};
use png::chunk::IEND;
use png::{Decoded, StreamingDecoder, UnfilterRegion};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// Inflated bytes that inflating may refer to.
const WINDOW_BYTES: usize = 32 << 10;

/// Bytes of rows in a buffer, about.
const BUFFER_BYTES: usize = 64 << 10;

/// Some rows, each behind the number of its filter.
pub(super) struct FilteredRows {
    /// The window before them, then the rows.
    bytes: Vec<u8>,
    row_bytes: usize,
}

/// A file that is inflated into rows.
struct Inflater {
    path: PathBuf,
    file: BufReader<File>,
    decoder: StreamingDecoder,
    /// What was inflated last.
    window: Vec<u8>,
    /// Whether all image data came.
    ended: bool,
}

/// Inflates `height` rows of the file, of `row_bytes` bytes with their filter's, ahead of their use; then reads it to
/// its end.
pub(super) fn inflate_ahead(path: &Path, row_bytes: usize, height: usize) -> Result<ReadAhead<FilteredRows>> {
    let mut inflater = Inflater::open(path)?;
    ReadAhead::new(move |mut filling: Filling<FilteredRows>| {
        let most = buffer_rows(row_bytes, height);
        for first in (0..height).step_by(most) {
            let Some(buffer) = filling.take() else { return Ok(()) };
            let mut rows = buffer.unwrap_or(FilteredRows { bytes: Vec::new(), row_bytes });
            inflater.fill(&mut rows, most.min(height - first))?;
            filling.send(rows);
        }
        inflater.finish()
    })
}

/// Rows of a buffer.
fn buffer_rows(row_bytes: usize, height: usize) -> usize {
    (BUFFER_BYTES / row_bytes).clamp(1, height)
}

/// Bytes that are held at most while `height` rows of `row_bytes` are inflated.
pub(super) fn held_bytes(row_bytes: usize, height: usize) -> u64 {
    let buffer = WINDOW_BYTES + buffer_rows(row_bytes, height) * row_bytes;
    (BUFFERS * buffer + WINDOW_BYTES + READ_BYTES) as u64
}

impl FilteredRows {
    /// Number of rows.
    pub fn count(&self) -> usize {
        (self.bytes.len() - WINDOW_BYTES) / self.row_bytes
    }

    /// The number of a row's filter, and its bytes.
    pub fn row(&self, index: usize) -> (u8, &[u8]) {
        let row = &self.bytes[WINDOW_BYTES + index * self.row_bytes..][..self.row_bytes];
        (row[0], &row[1..])
    }
}

impl Inflater {
    fn open(path: &Path) -> Result<Self> {
        let file = BufReader::with_capacity(READ_BYTES, input::open(path)?);
        let mut decoder = StreamingDecoder::new();
        decoder.set_ignore_text_chunk(true);
        Ok(Self { path: path.into(), file, decoder, window: Vec::new(), ended: false })
    }

    /// Inflates the next `count` rows.
    fn fill(&mut self, rows: &mut FilteredRows, count: usize) -> Result<()> {
        let length = WINDOW_BYTES + count * rows.row_bytes;
        rows.bytes.resize(length, 0);
        let mut region = UnfilterRegion { available: WINDOW_BYTES, filled: WINDOW_BYTES };
        if !self.window.is_empty() {
            rows.bytes[..WINDOW_BYTES].copy_from_slice(&self.window);
            region.available = 0;
        }
        while region.filled < length {
            if self.ended {
                return Err(damaged(&self.path, "it holds too few rows"));
            }
            self.step(Some((&mut region, &mut rows.bytes)))?;
        }
        self.window.clear();
        self.window.extend_from_slice(&rows.bytes[length - WINDOW_BYTES..]);
        Ok(())
    }

    /// Reads what follows the last row: the checksum of the rows stands behind them.
    fn finish(mut self) -> Result<()> {
        while !matches!(self.step(None)?, Decoded::ChunkComplete(IEND)) {}
        Ok(())
    }

    /// Reads a little further.
    fn step(&mut self, image: Option<(&mut UnfilterRegion, &mut Vec<u8>)>) -> Result<Decoded> {
        let bytes = self.file.fill_buf().map_err(Error::io(&self.path))?;
        if bytes.is_empty() {
            return Err(truncated(&self.path));
        }
        let updated = match image {
            Some((region, room)) => self.decoder.update(bytes, Some(&mut region.as_buf(room))),
            None => self.decoder.update(bytes, None),
        };
        let (used, decoded) = updated.map_err(reason(&self.path))?;
        self.file.consume(used);
        self.ended |= matches!(decoded, Decoded::ImageDataFlushed | Decoded::ChunkComplete(IEND));
        Ok(decoded)
    }
}
