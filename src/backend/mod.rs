//! Where an operation runs.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;

use crate::error::Result;
use crate::map::{CodesMut, TexelFormat};
use crate::ops::bake::BakePlan;
use crate::ops::blend::BlendPlan;
use crate::ops::parallax::ParallaxPlan;
use crate::ops::tangents::TangentPlan;
use crate::stream::{CodeSink, HeightBands, LayerBands};

/// Runs operations. One required method for each: a missing twin is a compile error.
pub(crate) trait Backend: Send + Sync {
    /// `cpu` or `gpu`.
    fn kind(&self) -> &'static str;

    /// What runs there: `2 threads, avx512`, or the adapter.
    fn device(&self) -> String;

    /// Devices of one such name give the same bytes in [`Precision::Fast`](crate::Precision::Fast).
    #[cfg(feature = "cli")]
    fn fast_device(&self) -> String {
        name(self.kind(), &self.device())
    }

    /// Threads for what an operation does on the host; `None`: those that all of the process share.
    fn host_threads(&self) -> Option<&rayon::ThreadPool> {
        None
    }

    /// Rows of a band that suit this backend when rows are read and written meanwhile.
    fn band_rows(&self, row: RowBytes) -> usize;

    /// Rows of a band that suit this backend when the maps lie in memory.
    fn map_band_rows(&self, row: RowBytes) -> usize {
        self.band_rows(row)
    }

    /// Bytes that a job's bands hold at most on this backend, besides the rows that come and go.
    fn held_bytes(&self, row: RowBytes) -> u64 {
        let _ = row;
        0
    }

    /// Bakes all bands of a height map into the rows of the plan's maps, one sink for each.
    ///
    /// # Errors
    /// What the bands or the sinks report, or [`crate::Error::Device`].
    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()>;

    /// Blends all bands of two normal maps and, perhaps, a mask into the rows of a normal map.
    ///
    /// # Errors
    /// As [`Backend::bake`].
    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()>;

    /// Bakes all bands of a height map and a normal map into the rows of a parallax map.
    ///
    /// # Errors
    /// As [`Backend::bake`].
    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()>;

    /// The tangent of each fan of a mesh, and its handedness as to growing v; zero where no direction is left.
    ///
    /// `tangents` has one element for each fan.
    ///
    /// # Errors
    /// [`crate::Error::Device`].
    fn tangents(&self, plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) -> Result<()>;

    /// The GPU that it is, to compile other kernels for.
    #[cfg(feature = "gpu")]
    fn gpu(&self) -> Option<&gpu::Untested> {
        None
    }
}

/// Bytes of one row on its way through an operation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowBytes {
    /// Of all inputs.
    pub read: usize,
    /// Of all outputs.
    pub written: usize,
}

impl RowBytes {
    /// Of a bake.
    pub fn of_bake(plan: &BakePlan) -> Self {
        let (width, formats) = (plan.size.width(), plan.formats());
        let texel_bytes: usize = formats.iter().map(TexelFormat::bytes).sum();
        Self { read: width * plan.height_type.bytes(), written: width * texel_bytes }
    }

    /// Of a blend.
    pub fn of_blend(plan: &BlendPlan) -> Self {
        let inputs: usize = plan.inputs.iter().map(|input| input.texel().bytes()).sum();
        let mask = plan.mask.map_or(0, |mask| mask.height_type.bytes());
        let width = plan.size.width();
        Self { read: width * (inputs + mask), written: width * plan.format.texel().bytes() }
    }

    /// Of a parallax map from heights and normals.
    pub fn of_parallax(plan: &ParallaxPlan) -> Self {
        let width = plan.size.width();
        let read = plan.height_type.bytes() + plan.input.texel().bytes();
        Self { read: width * read, written: width * plan.format.texel().bytes() }
    }
}

/// Fills the next `rows` rows of several maps at once.
///
/// # Errors
/// What the sinks report.
pub(crate) fn fill_rows(
    sinks: &mut [&mut dyn CodeSink],
    rows: usize,
    fill: impl FnOnce(&mut [CodesMut<'_>]),
) -> Result<()> {
    let mut maps: Vec<CodesMut<'_>> = sinks.iter_mut().map(|sink| sink.room(rows)).collect::<Result<_>>()?;
    fill(&mut maps);
    drop(maps);
    sinks.iter_mut().try_for_each(|sink| sink.filled())
}

/// A backend and its device in one piece: `cpu, 2 threads, avx512`.
pub(crate) fn name(kind: &str, device: &str) -> String {
    format!("{kind}, {device}")
}
