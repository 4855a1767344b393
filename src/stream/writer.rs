//! Rows of codes that leave for a file, on a thread of its own.

use super::channel::{Filling, recycling};
use super::order::RowOrder;
use super::thread;
use crate::error::{Error, Result};
use crate::map::{Codes, CodesMut, CodesRef, Depth, NormalFormat, Size};
use std::thread::{Builder, JoinHandle};

/// Takes the codes of a map from a backend, from the top.
pub(crate) trait CodeSink {
    /// Lets `fill` write the codes of the next `rows` rows.
    ///
    /// # Errors
    /// What `fill` returns, or what an earlier row met on its way out.
    fn write(&mut self, rows: usize, fill: &mut dyn FnMut(&mut CodesMut<'_>) -> Result<()>) -> Result<()>;
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

    /// Completes the file under its final name. Without this call there is no file.
    ///
    /// # Errors
    /// The system's or the format's reason.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// Bands on their way out: one being filled, one waiting, one being written.
const BUFFERS: usize = 3;

/// Writes to a [`RowSink`] on a thread while the backend computes the next rows.
pub(crate) struct CodeWriter {
    depth: Depth,
    row_codes: usize,
    filling: Option<Filling<Codes>>,
    thread: Option<JoinHandle<Result<Box<dyn RowSink>>>>,
}

impl CodeWriter {
    /// Writes the rows of a map, which come in this order, to `sink`.
    ///
    /// # Errors
    /// [`Error::Threads`].
    pub fn new(mut sink: Box<dyn RowSink>, size: Size, format: NormalFormat, order: RowOrder) -> Result<Self> {
        let row_codes = size.width() * format.channels.count();
        let (full, filling) = recycling::<Codes>(BUFFERS);
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
        Ok(Self { depth: format.depth, row_codes, filling: Some(filling), thread })
    }

    /// Waits for the last rows and completes the file.
    ///
    /// # Errors
    /// What any row or the completion met.
    pub fn finish(mut self) -> Result<()> {
        self.join()?.finish()
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
    fn write(&mut self, rows: usize, fill: &mut dyn FnMut(&mut CodesMut<'_>) -> Result<()>) -> Result<()> {
        let count = rows * self.row_codes;
        let Some(filling) = &mut self.filling else { return Err(Error::Cancelled) };
        let Some(buffer) = filling.take() else {
            // The writing thread has ended early: its error is the reason.
            return self.join().and(Err(Error::Cancelled));
        };
        let mut codes =
            buffer.filter(|codes| codes.as_ref().len() == count).unwrap_or_else(|| Codes::zeroed(self.depth, count));
        let filled = fill(&mut codes.as_mut());
        match filled {
            Ok(()) => filling.send(codes),
            Err(_) => filling.put_back(codes),
        }
        filled
    }
}
