//! The CPU: the plain reference, and the vectorised, threaded implementation that gives the same bytes.
//!
//! A band is cut into strips of rows, one for a thread at a time, and a strip into blocks that stay in the first cache.
//! A block goes through stages over planar arrays, each a plain loop that is compiled for several instruction sets:
//!
//! ```text
//! heights -> sums -> components -> codes -> texels      bake: a normal map, a parallax map or both from the same sums
//! texels -> normals -> components -> codes -> texels    blend, and parallax with the normals of a map
//! ```
//!
//! Meshes have passes of their own: see [`tangents`].
//!
//! Components of integer maps are estimates whose error is bounded. Where that bound leaves a code in doubt, integers
//! decide.

mod bake;
mod blend;
mod f16_bits;
pub(crate) mod levels;
mod output;
mod parallax;
mod plane;
mod read;
mod real;
mod reference;
mod round;
mod slopes;
mod sums;
mod tangents;
#[cfg(test)]
mod tests;

pub(crate) use reference::Reference;

use crate::backend::{Backend, RowBytes, fill_rows};
use crate::error::{Error, Result};
use crate::map::{CodesMut, CodesRef};
use crate::ops::bake::BakePlan;
use crate::ops::blend::BlendPlan;
use crate::ops::parallax::ParallaxPlan;
use crate::ops::tangents::TangentPlan;
use crate::stream::{CodeSink, HeightBands, LayerBand, LayerBands};
use crate::vectorised;
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

    /// Cuts the rows of a band into strips of `rows` rows, one for a thread at a time.
    fn in_strips<'m>(
        &self,
        rows: usize,
        band_rows: usize,
        maps: &'m mut [CodesMut<'_>],
        fill: impl Fn(usize, usize, Vec<CodesMut<'m>>) + Sync,
    ) {
        let mut strips: Vec<Vec<CodesMut<'m>>> = Vec::new();
        for map in maps {
            let row_codes = map.len() / band_rows;
            for (strip, codes) in map.chunks(rows * row_codes).into_iter().enumerate() {
                match strips.get_mut(strip) {
                    Some(strip) => strip.push(codes),
                    None => strips.push(vec![codes]),
                }
            }
        }
        let run = || {
            strips.into_par_iter().enumerate().for_each(|(strip, maps)| {
                let first = strip * rows;
                fill(first, rows.min(band_rows - first), maps);
            });
        };
        match &self.own_threads {
            Some(threads) => threads.install(run),
            None => run(),
        }
    }
}

/// Whole rows of about [`STRIP_TEXELS`] texels.
fn strip_rows(width: usize) -> usize {
    (STRIP_TEXELS / width).max(1)
}

/// The rows `first..first + rows` of each layer.
fn part<'a>(band: &LayerBand<'a>, first: usize, rows: usize) -> Vec<CodesRef<'a>> {
    let slice = |layer: &CodesRef<'a>| {
        let row_codes = layer.len() / band.rows;
        layer.slice(first * row_codes..(first + rows) * row_codes)
    };
    band.layers.iter().map(slice).collect()
}

fn the_only(maps: Vec<CodesMut<'_>>) -> CodesMut<'_> {
    maps.into_iter().next().expect("a map to fill")
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

    /// Neither threads nor the instruction set change a byte: f32 operations that IEEE rounds, in their written order.
    #[cfg(feature = "cli")]
    fn fast_device(&self) -> String {
        self.kind().into()
    }

    fn host_threads(&self) -> Option<&ThreadPool> {
        self.own_threads.as_ref()
    }

    fn band_rows(&self, row: RowBytes) -> usize {
        (BAND_BYTES / (row.read + row.written)).max(4 * self.threads())
    }

    fn map_band_rows(&self, _: RowBytes) -> usize {
        usize::MAX
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        while let Some(band) = bands.next()? {
            fill_rows(sinks, band.rows(), |maps| {
                self.in_strips(strip_rows(plan.size.width()), band.rows(), maps, |first, rows, maps| {
                    bake::bake(plan, &band.part(first, rows), maps);
                });
            })?;
        }
        Ok(())
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            fill_rows(&mut [&mut *sink], band.rows, |maps| {
                self.in_strips(strip_rows(plan.size.width()), band.rows, maps, |first, rows, maps| {
                    blend::blend(plan, &part(&band, first, rows), the_only(maps));
                });
            })?;
        }
        Ok(())
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        while let Some(band) = bands.next()? {
            fill_rows(&mut [&mut *sink], band.rows, |maps| {
                self.in_strips(strip_rows(plan.size.width()), band.rows, maps, |first, rows, maps| {
                    parallax::parallax(plan, &part(&band, first, rows), the_only(maps));
                });
            })?;
        }
        Ok(())
    }

    fn tangents(&self, plan: &TangentPlan<'_>, out: &mut [[f32; 4]]) -> Result<()> {
        match &self.own_threads {
            Some(threads) if tangents::is_large(plan) => threads.install(|| tangents::tangents(plan, out)),
            _ => tangents::tangents(plan, out),
        }
        Ok(())
    }
}
