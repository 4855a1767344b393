//! Buffers that a thread fills ahead of their use.

use super::channel::{Filling, Recycling, recycling};
use super::thread;
use crate::error::Result;
use std::thread::{Builder, JoinHandle};

/// What a reading thread has filled, in its order.
pub(crate) struct ReadAhead<T> {
    /// `None` once nothing more is wanted.
    filled: Option<Recycling<T>>,
    current: Option<T>,
    thread: Option<JoinHandle<Result<()>>>,
}

impl<T: Send + 'static> ReadAhead<T> {
    /// Runs `read_all` on a thread.
    ///
    /// # Errors
    /// [`crate::Error::Threads`].
    pub fn new(read_all: impl FnOnce(Filling<T>) -> Result<()> + Send + 'static) -> Result<Self> {
        let (filled, filling) = recycling();
        let thread = thread::start(Builder::new().name("texbake read".into()), || read_all(filling))?;
        Ok(Self { filled: Some(filled), current: None, thread: Some(thread) })
    }
}

impl<T> ReadAhead<T> {
    /// The next buffer; `None` after the last. The one before it is filled again.
    ///
    /// # Errors
    /// What `read_all` returned.
    pub fn next(&mut self) -> Result<Option<&T>> {
        let Some(filled) = &self.filled else { return Ok(None) };
        if let Some(used) = self.current.take() {
            filled.give_back(used);
        }
        self.current = filled.receive();
        if self.current.is_none()
            && let Some(thread) = self.thread.take()
        {
            thread::join(thread)?;
        }
        Ok(self.current.as_ref())
    }
}

impl<T> ReadAhead<T> {
    /// The buffer in use: the one that [`ReadAhead::next`] returned last.
    pub fn current(&self) -> Option<&T> {
        self.current.as_ref()
    }
}

impl<T> Drop for ReadAhead<T> {
    /// Once it is gone the source is closed: a thread that still reads is waited for.
    fn drop(&mut self) {
        self.filled = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
