//! Where a bake runs.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;

use crate::error::Result;
use crate::ops::normal::NormalPlan;
use crate::stream::{CodeSink, HeightBands};

/// Runs operations. One required method for each: a missing twin is a compile error.
pub(crate) trait Backend: Send + Sync {
    /// `cpu` or `gpu`.
    fn kind(&self) -> &'static str;

    /// What runs there: `2 threads, avx512`, or the adapter.
    fn device(&self) -> String;

    /// Rows of a band that suit this backend when rows are read and written meanwhile.
    fn band_rows(&self, plan: &NormalPlan) -> usize;

    /// Rows of a band that suit this backend when the map lies in memory.
    fn map_band_rows(&self, plan: &NormalPlan) -> usize {
        self.band_rows(plan)
    }

    /// Bakes all bands of a height map into the rows of a normal map.
    ///
    /// # Errors
    /// What the bands or the sink report, or [`crate::Error::Device`].
    fn normal(&self, plan: &NormalPlan, bands: &mut dyn HeightBands, sink: &mut dyn CodeSink) -> Result<()>;
}

/// A backend and its device in one piece: `cpu, 2 threads, avx512`.
pub(crate) fn name(kind: &str, device: &str) -> String {
    format!("{kind}, {device}")
}
