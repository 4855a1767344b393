//! What takes a shot.

use super::shot::{Samples, Shot};
use crate::error::Result;
use crate::stream::Monitor;

/// What takes shots.
#[derive(Debug, Default)]
pub enum Renderer {
    /// All cores.
    #[default]
    Cpu,
}

impl Renderer {
    /// What it is: `cpu`, or the adapter's name.
    pub fn name(&self) -> String {
        "cpu".into()
    }

    /// Takes a shot.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`] if `monitor` says so.
    pub fn take(&self, shot: &Shot<'_>, monitor: &Monitor) -> Result<Samples> {
        shot.on_cpu(monitor)
    }
}
