//! What another thread may see of a bake, how it stops one, and how much memory it leaves to it.

use super::budget::{Budget, Turn};
use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Counts texels as they are baked, stops a bake on request, and bounds the memory of bakes that run at the same time.
#[derive(Debug, Default)]
pub struct Monitor {
    texels: AtomicU64,
    stop: Stop,
    memory: Option<Budget>,
}

/// Whether bakes shall end, for threads that read ahead of them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Fails if they shall.
    pub fn check(&self) -> Result<()> {
        if self.0.load(Relaxed) { Err(Error::Cancelled) } else { Ok(()) }
    }
}

impl Monitor {
    /// Bakes that this monitor watches keep the process to `bytes` of memory, of which it has `taken` already: they share
    /// what is left, for what a source holds of its file, the bands on their way, a backend's buffers, and what a sink
    /// gathers. One that finds too little left waits for the end of another; one that needs more than there is fails with
    /// [`Error::Parameter`] before it has any. So does one on a thread of rayon, which waits for parts of its bake by
    /// beginning others.
    ///
    /// A file is opened before it is known what it needs, one at a time. What stands before its rows is not counted then:
    /// tables of strips, tiles and blocks, colour profiles and other metadata. Coded rows are not held by a file that
    /// waits, whatever its format.
    pub fn with_memory(bytes: u64, taken: u64) -> Self {
        Self { memory: Some(Budget::new(bytes, taken)), ..Self::default() }
    }

    /// Texels baked so far.
    pub fn texels(&self) -> u64 {
        self.texels.load(Relaxed)
    }

    /// Asks every bake that this monitor watches to end with [`Error::Cancelled`] at its next band, or
    /// piece of a map that is read before the first one.
    pub fn cancel(&self) {
        self.stop.0.store(true, Relaxed);
    }

    /// Whether [`Monitor::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.stop.check().is_err()
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
        self.stop.check()
    }

    /// The same for another thread.
    pub(crate) fn stop(&self) -> Stop {
        self.stop.clone()
    }
}
