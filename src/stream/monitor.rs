//! What another thread may see of a bake, and how it stops one.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Counts texels as they are baked, and stops a bake on request.
#[derive(Debug, Default)]
pub struct Monitor {
    texels: AtomicU64,
    cancelled: AtomicBool,
}

impl Monitor {
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
