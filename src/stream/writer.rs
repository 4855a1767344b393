//! Rows of codes that leave for a file, on a thread of its own.

use super::channel::{Filling, recycling};
use super::order::RowOrder;
use super::thread;
use crate::error::{Error, Result};
use crate::map::{Codes, CodesMut, CodesRef, Depth, Size, TexelFormat};
use std::thread::{Builder, JoinHandle};

/// Takes the codes of a map from a backend, from the top: room first, then the word that it is filled.
pub(crate) trait CodeSink {
    /// Room for the codes of the next `rows` rows.
    ///
    /// # Errors
    /// What an earlier row met on its way out.
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>>;

    /// Hands on the rows for which there was room.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    fn filled(&mut self) -> Result<()>;
}

/// A map that is written row by row.
///
/// Rows come from the top, each once; row 0 may come last if the sink lets it.
pub trait RowSink: Send {
    /// Whether row 0 may come after all others: then a map that wraps from bottom to top is read once.
    fn takes_first_row_last(&self) -> bool {
        false
    }

    /// Writes rows from row `first` on.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn write(&mut self, first: usize, rows: CodesRef<'_>) -> Result<()>;

    /// Bytes that the sink holds at most while it writes, besides the rows that it is given, `rows` of them at once.
    fn held_bytes(&self, rows: usize) -> u64;

    /// What takes the rows of the smaller mip levels, while those of the largest come here; `None` if the file has one
    /// level. It must be dropped before [`RowSink::complete`].
    fn levels(&mut self) -> Option<Box<dyn LevelSink>> {
        None
    }

    /// Writes what follows the last row. Of files that belong together, all are complete before any gets its name.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn complete(&mut self) -> Result<()> {
        Ok(())
    }

    /// Completes the file, if that was not done, and gives it its final name. Without this call there is no file.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// The mip levels of a map below its largest.
///
/// Level k has max(1, floor(w / 2^k)) x max(1, floor(h / 2^k)) texels, and the last one has a single texel.
pub trait LevelSink: Send {
    /// Writes rows of `level`, which is at least 1, from row `first` on. Each row of each level comes once; of one level
    /// they come from the top, but that row 0 may come last.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn write(&mut self, level: usize, first: usize, rows: CodesRef<'_>) -> Result<()>;
}

/// Writes to a [`RowSink`] on a thread while the backend computes the next rows.
pub(crate) struct CodeWriter {
    depth: Depth,
    row_codes: usize,
    filling: Option<Filling<Codes>>,
    /// The rows that are being filled.
    current: Option<Codes>,
    thread: Option<JoinHandle<Result<Box<dyn RowSink>>>>,
}

impl CodeWriter {
    /// Writes the rows of a map, which come in this order, to `sink`.
    ///
    /// # Errors
    /// [`Error::Threads`].
    pub fn new(mut sink: Box<dyn RowSink>, size: Size, format: TexelFormat, order: RowOrder) -> Result<Self> {
        let row_codes = format.row_codes(size.width());
        let (full, filling) = recycling::<Codes>();
        let write_all = move || {
            let mut travelled = 0;
            while let Some(codes) = full.receive() {
                sink.write(order.row(travelled, size.height()), codes.as_ref())?;
                travelled += codes.as_ref().len() / row_codes;
                full.give_back(codes);
            }
            Ok(sink)
        };
        let thread = Some(thread::start(Builder::new().name("texbake write".into()), write_all)?);
        Ok(Self { depth: format.depth, row_codes, filling: Some(filling), current: None, thread })
    }

    /// Waits for the last rows and completes the file, which then lacks its name only.
    ///
    /// # Errors
    /// What any row or the completion met.
    pub fn complete(mut self) -> Result<Box<dyn RowSink>> {
        let mut sink = self.join()?;
        sink.complete()?;
        Ok(sink)
    }

    fn join(&mut self) -> Result<Box<dyn RowSink>> {
        self.filling = None;
        let thread = self.thread.take().ok_or(Error::Cancelled)?;
        thread::join(thread)
    }
}

impl Drop for CodeWriter {
    /// A sink that was not finished removes its file: that is waited for, since the process may end right after.
    fn drop(&mut self) {
        self.filling = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl CodeSink for CodeWriter {
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>> {
        let count = rows * self.row_codes;
        let Some(filling) = &mut self.filling else { return Err(Error::Cancelled) };
        // Room that was not filled is still there.
        let Some(buffer) = self.current.take().map(Some).or_else(|| filling.take()) else {
            // The writing thread has ended early: its error is the reason.
            return Err(self.join().err().unwrap_or(Error::Cancelled));
        };
        let codes = buffer.filter(|codes| codes.as_ref().len() == count);
        Ok(self.current.insert(codes.unwrap_or_else(|| Codes::zeroed(self.depth, count))).as_mut())
    }

    fn filled(&mut self) -> Result<()> {
        let (Some(filling), Some(codes)) = (&mut self.filling, self.current.take()) else {
            return Err(Error::Cancelled);
        };
        filling.send(codes);
        Ok(())
    }
}
