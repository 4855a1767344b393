//! A normal map file that is written row by row.

use super::replace::Replacement;
use crate::error::{Error, Result};
use crate::map::{CodesRef, Depth, NormalFormat, Size};
use crate::stream::RowSink;
use std::path::Path;

/// Writes one file format.
pub(super) trait RowEncoder: Send {
    /// Writes whole rows, all of the depth that the file was created with.
    fn write(&mut self, rows: CodesRef<'_>) -> Result<()>;

    /// Writes what follows the last row.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// An encoder, the file that it fills, and the rows that are still to come.
pub(super) struct FileSink {
    encoder: Box<dyn RowEncoder>,
    replacement: Replacement,
    depth: Depth,
    row_codes: usize,
    rows_left: usize,
}

impl FileSink {
    /// A file whose rows go through `encoder` into `replacement`.
    pub fn boxed(
        encoder: impl RowEncoder + 'static,
        replacement: Replacement,
        size: Size,
        format: NormalFormat,
    ) -> Box<dyn RowSink> {
        let row_codes = size.width() * format.channels.count();
        let (depth, rows_left) = (format.depth, size.height());
        Box::new(Self { encoder: Box::new(encoder), replacement, depth, row_codes, rows_left })
    }
}

impl RowSink for FileSink {
    fn write(&mut self, rows: CodesRef<'_>) -> Result<()> {
        let (count, depth) = (rows.len(), depth_of(rows));
        let whole = count % self.row_codes == 0 && count / self.row_codes <= self.rows_left;
        if depth != self.depth || !whole {
            let (row, left) = (self.row_codes, self.rows_left);
            let range = format!("whole rows of {row} codes of depth {}, at most {left}", self.depth);
            return Err(Error::parameter("rows", format_args!("{count} codes of depth {depth}"), range));
        }
        self.rows_left -= count / self.row_codes;
        self.encoder.write(rows)
    }

    fn finish(self: Box<Self>) -> Result<()> {
        if self.rows_left > 0 {
            return Err(Error::parameter("rows", format_args!("{} too few", self.rows_left), "complete"));
        }
        self.encoder.finish()?;
        self.replacement.commit()
    }
}

fn depth_of(codes: CodesRef<'_>) -> Depth {
    match codes {
        CodesRef::U8(_) => Depth::Bits8,
        CodesRef::U16(_) => Depth::Bits16,
        CodesRef::F16(_) => Depth::Float16,
        CodesRef::F32(_) => Depth::Float32,
    }
}

/// A file format that cannot hold what was asked for.
pub(super) fn cannot_hold(path: &Path, format: NormalFormat, remedy: &str) -> Error {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let value = format!("{} with {} bits, for {name}", format.encoding, format.depth);
    Error::parameter("encoding", value, remedy)
}
