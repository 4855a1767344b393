//! Stripes: rows of an image that one thread filters and deflates by itself.

use super::deflate::{BitWriter, deflate};
use super::filter::Filter;

/// Bytes of rows in a stripe, about. Few would cost a block's codes too often, many would keep threads waiting.
const STRIPE_BYTES: usize = 512 << 10;

/// Rows in a stripe: a number that depends on nothing but their length, so that the file's bytes do so too.
pub(super) fn stripe_rows(row_bytes: usize) -> usize {
    (STRIPE_BYTES / row_bytes).max(1)
}

/// A stripe on its way from rows to a piece of a zlib stream; its buffers serve the next one.
#[derive(Default)]
pub(super) struct Stripe {
    /// The row above, then the stripe's rows, as PNG orders their bytes.
    rows: Vec<u8>,
    row_bytes: usize,
    texel_bytes: usize,
    /// Whether the row above is not known: the stripe's first row does not look up.
    is_first: bool,
    filtered: Vec<u8>,
    deflated: BitWriter,
    checksum: u32,
}

impl Stripe {
    /// Begins anew with rows of `row_bytes`, below the row `above` if that is known.
    pub fn begin(&mut self, row_bytes: usize, texel_bytes: usize, above: Option<&[u8]>) {
        (self.row_bytes, self.texel_bytes, self.is_first) = (row_bytes, texel_bytes, above.is_none());
        self.rows.clear();
        match above {
            Some(above) => self.rows.extend_from_slice(above),
            None => self.rows.resize(row_bytes, 0),
        }
    }

    /// Room for the next row.
    pub fn next_row(&mut self) -> &mut [u8] {
        let start = self.rows.len();
        self.rows.resize(start + self.row_bytes, 0);
        &mut self.rows[start..]
    }

    /// Rows so far.
    pub fn count(&self) -> usize {
        self.rows.len() / self.row_bytes - 1
    }

    /// The last row, or the one above.
    pub fn last_row(&self) -> &[u8] {
        &self.rows[self.rows.len() - self.row_bytes..]
    }

    /// Filters and deflates the rows.
    pub fn encode(&mut self) {
        self.filtered.clear();
        self.deflated.clear();
        let above = self.rows.chunks_exact(self.row_bytes);
        for (number, (row, above)) in above.clone().skip(1).zip(above).enumerate() {
            let filter = if number == 0 && self.is_first { Filter::Sub } else { Filter::Paeth };
            filter.apply(row, above, self.texel_bytes, &mut self.filtered);
        }
        self.checksum = simd_adler32::adler32(&self.filtered.as_slice());
        deflate(&self.filtered, &mut self.deflated);
    }

    /// The stripe's piece of the stream, once it is encoded.
    pub fn deflated(&self) -> &[u8] {
        self.deflated.bytes()
    }

    /// The Adler-32 of what was deflated, and its bytes.
    pub fn checksum(&self) -> (u32, u64) {
        (self.checksum, self.filtered.len() as u64)
    }
}
