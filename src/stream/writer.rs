//! Rows of codes that leave for a file, on a thread of its own.

use super::channel::{Filling, recycling};
use super::order::RowOrder;
use super::{CodeSink, RowsOut, thread};
use crate::error::{Error, Result};
use crate::map::{Codes, CodesMut, Depth, Size, TexelFormat};
use std::thread::{Builder, JoinHandle};

/// Writes to a [`RowSink`] on a thread while the backend computes the next rows.
pub(crate) struct CodeWriter {
    depth: Depth,
    row_codes: usize,
    filling: Option<Filling<Codes>>,
    /// The rows that are being filled.
    current: Option<Codes>,
    thread: Option<JoinHandle<Result<RowsOut>>>,
}

impl CodeWriter {
    /// Writes the rows of a map, which come in this order, to `sink`.
    ///
    /// # Errors
    /// [`Error::Threads`].
    pub fn new(mut sink: RowsOut, size: Size, format: TexelFormat, order: RowOrder) -> Result<Self> {
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
    pub fn complete(mut self) -> Result<RowsOut> {
        let mut sink = self.join()?;
        sink.complete()?;
        Ok(sink)
    }

    fn join(&mut self) -> Result<RowsOut> {
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
