//! A file of codes that is written row by row.

use super::replace::Replacement;
use crate::error::{Error, Result};
use crate::map::{CodesRef, Depth, Size, TexelFormat};
use crate::stream::RowSink;
use std::io::{self, Read};
use std::path::Path;

/// Writes one file format.
pub(super) trait RowEncoder: Send {
    /// Whether row 0 may come after all others.
    fn takes_first_row_last(&self) -> bool;

    /// Bytes that are held at most while `rows` rows at once are written.
    fn held_bytes(&self, rows: usize) -> u64;

    /// Writes whole rows from row `first` on, all of the depth that the file was created with.
    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()>;

    /// Writes what follows the last row.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// Reads a file once it is complete and before it has its name, so that nobody else has written to it.
pub(crate) type Witness = Box<dyn FnOnce(&mut dyn Read) -> io::Result<()> + Send>;

/// An encoder, the file that it fills, and the rows that are still to come.
pub(crate) struct FileSink {
    /// `None` once the file is complete.
    encoder: Option<Box<dyn RowEncoder>>,
    replacement: Replacement,
    expected: ExpectedRows,
    /// `None` if nobody asks, or once it was told.
    pub(super) witness: Option<Witness>,
}

/// The rows of a map, or of a mip level, that are still to come: from the top, but that row 0 may come last.
pub(super) struct ExpectedRows {
    depth: Depth,
    row_codes: usize,
    height: usize,
    /// The row that comes next; `None` after the last.
    next_row: Option<usize>,
    /// Row 0 was left for the end.
    first_row_left: bool,
}

impl FileSink {
    /// A file whose rows go through `encoder` into `replacement`.
    pub fn boxed(
        encoder: impl RowEncoder + 'static,
        replacement: Replacement,
        size: Size,
        format: TexelFormat,
    ) -> Box<Self> {
        let expected = ExpectedRows::new(size.width(), size.height(), format);
        let encoder: Option<Box<dyn RowEncoder>> = Some(Box::new(encoder));
        Box::new(Self { encoder, replacement, expected, witness: None })
    }
}

impl ExpectedRows {
    /// `height` rows of `width` texels.
    pub fn new(width: usize, height: usize, format: TexelFormat) -> Self {
        let row_codes = format.row_codes(width);
        Self { depth: format.depth, row_codes, height, next_row: Some(0), first_row_left: false }
    }

    /// How many rows these are.
    ///
    /// # Errors
    /// [`Error::Parameter`] unless they are whole rows of the depth, and come next.
    pub fn check(&mut self, first: usize, rows: CodesRef<'_>, takes_first_row_last: bool) -> Result<usize> {
        let (count, depth) = (rows.len() / self.row_codes, rows.depth());
        let starts_late = self.next_row == Some(0) && first == 1 && takes_first_row_last;
        if starts_late {
            (self.next_row, self.first_row_left) = (Some(1), true);
        }
        let end = if first == 0 && self.first_row_left { 1 } else { self.height };
        let whole = count > 0 && rows.len().is_multiple_of(self.row_codes);
        if depth != self.depth || !whole || self.next_row != Some(first) || first + count > end {
            let given = format!("{} codes of depth {depth} from row {first} on", rows.len());
            let next = self.next_row.map_or("no more".into(), |row| format!("up to {} from row {row} on", end - row));
            let range = format!("whole rows of {} codes of depth {}, {next}", self.row_codes, self.depth);
            return Err(Error::parameter("rows", given, range));
        }
        Ok(count)
    }

    /// Expects what follows these rows, which are written.
    pub fn advance(&mut self, first: usize, count: usize) {
        let end = if first == 0 && self.first_row_left { 1 } else { self.height };
        self.next_row = match first + count {
            next if next < end => Some(next),
            _ if self.first_row_left && first > 0 => Some(0),
            _ => None,
        };
    }
}

impl RowSink for FileSink {
    fn held_bytes(&self, rows: usize) -> u64 {
        self.encoder.as_ref().map_or(0, |encoder| encoder.held_bytes(rows))
    }

    fn takes_first_row_last(&self) -> bool {
        self.encoder.as_ref().is_some_and(|encoder| encoder.takes_first_row_last())
    }

    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()> {
        let takes_first_row_last = self.takes_first_row_last();
        let count = self.expected.check(first, rows, takes_first_row_last)?;
        let written = self.encoder.as_mut().map_or(Ok(()), |encoder| encoder.write(first, rows));
        self.replacement.check()?;
        written?;
        self.expected.advance(first, count);
        Ok(())
    }

    fn complete(&mut self) -> Result<()> {
        if let Some(row) = self.expected.next_row {
            return Err(Error::parameter("rows", format_args!("without row {row}"), "complete"));
        }
        let finished = self.encoder.take().map_or(Ok(()), |encoder| encoder.finish());
        self.replacement.check()?;
        finished?;
        self.witness.take().map_or(Ok(()), |witness| self.replacement.show(witness))?;
        self.replacement.sync()
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        if self.encoder.is_some() {
            self.complete()?;
        }
        self.replacement.commit()
    }
}

/// A file format that cannot hold what was asked for.
pub(super) fn cannot_hold(path: &Path, format: TexelFormat, remedy: &str) -> Error {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let value = format!("{} with {} bits, for {name}", format.encoding, format.depth);
    Error::parameter("encoding", value, remedy)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::io::replace::Output;
    use crate::map::NormalFormat;
    use std::io::{ErrorKind, Write};

    /// Writes to a full disk and says nothing, as deflate on its way to the file.
    struct Deaf {
        output: Output,
        waits: bool,
    }

    impl RowEncoder for Deaf {
        fn takes_first_row_last(&self) -> bool {
            false
        }

        fn held_bytes(&self, _: usize) -> u64 {
            0
        }

        fn write(&mut self, _: usize, rows: CodesRef<'_>) -> Result<()> {
            if !self.waits {
                let _ = self.output.write_all(rows.bytes());
            }
            Ok(())
        }

        fn finish(mut self: Box<Self>) -> Result<()> {
            let _ = self.output.write_all(&[0]);
            Err(Error::file("n.png", "the encoder's own words", "of no help"))
        }
    }

    fn sink(folder: &Path, waits: bool) -> Box<FileSink> {
        let replacement = Replacement::create(&folder.join("n.png")).unwrap();
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let encoder = Deaf { output: replacement.output_into(full), waits };
        FileSink::boxed(encoder, replacement, Size::new(2, 1).unwrap(), NormalFormat::default().texel())
    }

    fn assert_says_full(result: Result<()>) {
        let error = result.unwrap_err();
        assert!(matches!(&error, Error::Io { source, .. } if source.kind() == ErrorKind::StorageFull), "{error}");
        assert!(error.to_string().ends_with("make room, or choose another disk"), "{error}");
    }

    #[test]
    fn a_full_disk_is_noticed_with_the_rows_that_it_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert_says_full(sink(folder.path(), false).write(0, CodesRef::U8(&[0; 6])));
    }

    #[test]
    fn a_full_disk_goes_before_the_encoders_words() {
        let folder = tempfile::tempdir().unwrap();
        let mut sink = sink(folder.path(), true);
        sink.write(0, CodesRef::U8(&[0; 6])).unwrap();
        assert_says_full(sink.finish());
    }
}
