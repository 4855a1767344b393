//! What another thread may see of a bake, how it stops one, and how much memory it leaves to it.

use super::budget::{Budget, Turn};
use crate::error::{Error, Result};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Counts texels as they are baked, stops a bake on request, and bounds the memory of bakes that run at the same time.
#[derive(Debug, Default)]
pub struct Monitor {
    texels: AtomicU64,
    cancelled: AtomicBool,
    memory: Option<Budget>,
}

impl Monitor {
    /// Bakes that this monitor watches share `bytes` of memory for their rows: for what a source holds of its file, the
    /// bands on their way, a backend's buffers, and what a sink gathers. One that finds too little left waits for the
    /// end of another; one that needs more than there is fails with [`Error::Parameter`] before it has any.
    pub fn with_memory(bytes: u64) -> Self {
        Self { memory: Some(Budget::new(bytes)), ..Self::default() }
    }

    /// Texels baked so far.
    pub fn texels(&self) -> u64 {
        self.texels.load(Relaxed)
    }

    /// Asks every bake that this monitor watches to end with [`Error::Cancelled`] at its next band.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// Whether [`Monitor::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// Waits until a bake may open its files, and take memory for them.
    pub(crate) fn turn(&self) -> Turn<'_> {
        self.memory.as_ref().map_or_else(Turn::unbounded, Budget::turn)
    }

    /// Counts texels that are done.
    pub(crate) fn add(&self, texels: u64) -> Result<()> {
        self.texels.fetch_add(texels, Relaxed);
        self.check()
    }

    /// Takes texels back that will be baked again, or never.
    pub(crate) fn take_back(&self, texels: u64) {
        self.texels.fetch_sub(texels, Relaxed);
    }

    /// Fails if the bake shall end.
    pub(crate) fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::Cancelled) } else { Ok(()) }
    }
}
