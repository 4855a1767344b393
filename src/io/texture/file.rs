//! The file that all levels of a texture go to.

use super::format::TextureFormat;
use super::levels::Level;
use super::texels::{little_endian, with_alpha};
use crate::error::{Error, Result};
use crate::io::replace::Output;
use crate::map::{Codes, CodesRef, TexelFormat};
use std::io::{Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// A file whose rows may come from several threads, since each has its place.
pub struct TextureFile {
    pub path: PathBuf,
    pub output: Mutex<Output>,
    pub codes: TexelFormat,
    pub format: TextureFormat,
}

impl TextureFile {
    /// Bytes of texels that are converted at a time, about.
    pub const PIECE: usize = 1 << 20;

    pub fn write_at(&self, offset: u64, bytes: &[u8]) -> Result<()> {
        let mut output = self.output.lock().unwrap_or_else(PoisonError::into_inner);
        let written = output.seek(SeekFrom::Start(offset)).and_then(|_| output.write_all(bytes));
        written.map_err(Error::io(&self.path))
    }

    /// Writes whole rows of a level from row `first` on, texel by texel.
    pub fn write_texels(&self, level: &Level, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let row_codes = self.codes.row_codes(level.width);
        let piece_rows = (Self::PIECE / level.row_bytes).max(1);
        let count = rows.len() / row_codes;
        (0..count).step_by(piece_rows).try_for_each(|row| {
            let piece = rows.slice(row * row_codes..(row + piece_rows).min(count) * row_codes);
            let texels = with_alpha(piece, self.codes);
            let bytes = little_endian(texels.as_ref().map_or(piece, Codes::as_ref));
            self.write_at(level.offset + (first + row) as u64 * level.row_bytes as u64, &bytes)
        })
    }
}
