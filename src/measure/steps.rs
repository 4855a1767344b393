//! How far measuring has come, and its end on request.

use crate::error::Result;
use crate::stream::Monitor;

/// How far measuring has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress<'a> {
    /// Steps that are done.
    pub done: usize,
    /// Steps in all.
    pub of: usize,
    /// What comes next, in words.
    pub step: &'a str,
}

/// Steps that are counted, watched, and not begun any more after a cancellation.
pub(super) struct Steps<'a> {
    pub done: usize,
    pub of: usize,
    pub monitor: &'a Monitor,
    pub watch: &'a mut dyn FnMut(Progress<'_>),
}

impl Steps<'_> {
    /// Begins the next step.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn next(&mut self, step: &str) -> Result<()> {
        self.monitor.check()?;
        (self.watch)(Progress { done: self.done, of: self.of, step });
        self.done += 1;
        Ok(())
    }
}
