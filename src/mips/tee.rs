//! A tee: the bands of a height map on their way to a backend, from which others draw too.

use crate::error::Result;
use crate::map::Size;
use crate::stream::{HeightBand, HeightBands, RowOrder};
use rayon::ThreadPool;

/// Texels whose sums are made at a time: they stay in the second cache.
const STRIP_TEXELS: usize = 1 << 17;

/// Whole rows of about [`STRIP_TEXELS`] texels.
pub(super) fn strip_rows(width: usize) -> usize {
    (STRIP_TEXELS / width).max(1)
}

/// What is made of the bands that pass.
pub(super) trait Tap: Send {
    /// Takes a strip of a band, whose first row is row `row` of the map, and writes what it completes.
    fn add(&mut self, row: usize, strip: &HeightBand<'_>) -> Result<()>;

    /// Writes what is left once the last strip was taken.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// Bands, of which each is seen by all taps before the backend has it.
pub(super) struct Tee<'a> {
    bands: &'a mut dyn HeightBands,
    size: Size,
    order: RowOrder,
    /// Rows that have passed.
    travelled: usize,
    taps: Vec<Box<dyn Tap + 'a>>,
    /// `None`: those that all of the process share.
    threads: Option<&'a ThreadPool>,
}

impl<'a> Tee<'a> {
    /// The bands of a map of `size`, whose rows come in this order, for taps that run on `threads`.
    pub fn new(
        bands: &'a mut dyn HeightBands,
        size: Size,
        order: RowOrder,
        taps: Vec<Box<dyn Tap + 'a>>,
        threads: Option<&'a ThreadPool>,
    ) -> Self {
        Self { bands, size, order, travelled: 0, taps, threads }
    }

    /// Completes what the taps make once the last band has passed.
    pub fn finish(self) -> Result<()> {
        let Self { taps, threads, .. } = self;
        on(threads, || taps.into_iter().try_for_each(Tap::finish))
    }
}

impl HeightBands for Tee<'_> {
    fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
        let Self { bands, size, order, travelled, taps, threads } = self;
        let Some(band) = bands.next()? else { return Ok(None) };
        let strip_rows = strip_rows(size.width());
        on(*threads, || {
            for first in (0..band.rows()).step_by(strip_rows) {
                let strip = band.part(first, strip_rows.min(band.rows() - first));
                let row = order.row(*travelled, size.height());
                taps.iter_mut().try_for_each(|tap| tap.add(row, &strip))?;
                *travelled += strip.rows();
            }
            Ok(())
        })?;
        Ok(Some(band))
    }
}

/// Runs `job` on `threads`, or where it is.
fn on<T: Send>(threads: Option<&ThreadPool>, job: impl FnOnce() -> T + Send) -> T {
    match threads {
        Some(threads) => threads.install(job),
        None => job(),
    }
}
