//! The CPU: the plain reference, and the vectorised, threaded implementation that gives the same bytes.
//!
//! A band is cut into strips of rows, one for a thread at a time; a strip is baked in blocks of a row that stay in
//! the first cache, in three passes over planar arrays: stencil sums, codes, interleaved texels. The passes are plain
//! loops, compiled for several instruction sets.

#[macro_use]
mod vectorised;
mod block;
mod f16_bits;
mod reference;
mod round;
mod rule;
mod strip;
#[cfg(test)]
mod tests;

pub(crate) use reference::Reference;

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::map::CodesMut;
use crate::ops::normal::NormalPlan;
use crate::stream::{CodeSink, HeightBand, HeightBands};
use rayon::ThreadPool;
use rayon::prelude::*;

/// Vectorised code on several threads.
#[derive(Debug)]
pub(crate) struct Cpu {
    /// `None`: the threads that all of the process share.
    own_threads: Option<ThreadPool>,
}

/// Bytes of heights and codes in a band: enough work for many threads, little beside an image.
const BAND_BYTES: usize = 1 << 20;

/// Texels in a strip: milliseconds would leave threads idle at the end of a band, microseconds would be overhead.
///
/// Strips are whole rows, so fewer rows than threads leave some idle. A map so wide and so low is no texture, and
/// columns would cut each row of codes, which interleaves them.
const STRIP_TEXELS: usize = 1 << 16;

impl Cpu {
    /// Bakes on the threads that all of the process share.
    pub fn shared() -> Self {
        Self { own_threads: None }
    }

    /// Bakes on `threads` threads of its own.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are none; [`Error::Threads`] if the system refuses them.
    pub fn with_threads(threads: usize) -> Result<Self> {
        if threads == 0 {
            return Err(Error::parameter("threads", threads, "at least 1"));
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Error::threads)?;
        Ok(Self { own_threads: Some(pool) })
    }

    fn threads(&self) -> usize {
        self.own_threads.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads)
    }

    fn bake(&self, plan: &NormalPlan, band: &HeightBand<'_>, codes: &mut CodesMut<'_>) {
        let rows = (STRIP_TEXELS / plan.size.width()).max(1);
        let strips = codes.chunks(rows * plan.row_codes());
        let bake = || {
            strips.into_par_iter().enumerate().for_each(|(strip, codes)| {
                let first = strip * rows;
                strip::bake(plan, &band.part(first, rows.min(band.rows() - first)), codes);
            });
        };
        match &self.own_threads {
            Some(threads) => threads.install(bake),
            None => bake(),
        }
    }
}

impl Backend for Cpu {
    fn kind(&self) -> &'static str {
        "cpu"
    }

    fn device(&self) -> String {
        let threads = self.threads();
        let plural = if threads == 1 { "" } else { "s" };
        format!("{threads} thread{plural}, {}", vectorised::instruction_set())
    }

    fn band_rows(&self, plan: &NormalPlan) -> usize {
        let codes = plan.row_codes() * plan.format.depth.bytes();
        let row_bytes = plan.size.width() * plan.height_type.bytes() + codes;
        (BAND_BYTES / row_bytes).max(4 * self.threads()).min(plan.size.height())
    }

    fn map_band_rows(&self, plan: &NormalPlan) -> usize {
        plan.size.height()
    }

    fn normal(&self, plan: &NormalPlan, bands: &mut dyn HeightBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            sink.write(band.rows(), &mut |codes| {
                self.bake(plan, &band, codes);
                Ok(())
            })?;
        }
        Ok(())
    }
}
