//! The bands of a height map on their way to a backend, which leave behind what levels are made of.

use super::maps::MapLevels;
use super::roughness::{Roughness, RoughnessOptions};
use super::roughness_levels::RoughnessLevels;
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::map::CodesMut;
use crate::ops::bake::BakePlan;
use crate::stream::{CodeSink, HeightBand, HeightBands, LevelSink, RowOrder};
use rayon::ThreadPool;

/// Texels whose sums are made at a time: they stay in the second cache.
const STRIP_TEXELS: usize = 1 << 17;

/// Most texels of a map, so that sums of 16-bit heights with any filter fit 63 bits.
const GREATEST_TEXELS: usize = 1 << 42;

/// What takes the levels of a map below its largest; `None` if none are wanted.
pub(crate) type LevelsOut<'a> = Option<Box<dyn LevelSink + 'a>>;

/// What a bake makes of a height map beside the largest level of the plan's maps.
#[derive(Default)]
pub(crate) struct Beside<'a> {
    /// The smaller levels of each map of the plan.
    pub levels: Vec<LevelsOut<'a>>,
    /// The roughness map.
    pub roughness: Option<RoughnessOut<'a>>,
}

/// Where a roughness map goes.
pub(crate) struct RoughnessOut<'a> {
    pub options: &'a RoughnessOptions,
    pub largest: &'a mut dyn CodeSink,
    /// Without them it is flat.
    pub levels: LevelsOut<'a>,
}

/// Bakes all bands of a height map into the rows of the plan's maps, and what is wanted beside them.
///
/// The backend bakes the largest level as if there were no others. The CPU makes those: they are the same whatever the
/// backend, and cost it a fraction of level 0.
///
/// # Errors
/// What the bands or the sinks report, [`Error::Device`], and [`Error::Parameter`] for a map too large for levels or a
/// roughness out of range.
pub(crate) fn bake_with_levels(
    backend: &dyn Backend,
    plan: &BakePlan,
    order: RowOrder,
    bands: &mut dyn HeightBands,
    sinks: &mut [&mut dyn CodeSink],
    beside: Beside<'_>,
) -> Result<()> {
    if beside.levels.iter().all(Option::is_none) && beside.roughness.is_none() {
        return backend.bake(plan, bands, sinks);
    }
    if plan.size.texels() > GREATEST_TEXELS {
        return Err(Error::parameter("mips", plan.size, "left out for maps of more than 2^42 texels"));
    }
    let maps = beside.levels.iter().any(Option::is_some).then(|| MapLevels::new(plan, beside.levels));
    let (roughness, base) = match beside.roughness {
        None => (None, None),
        Some(RoughnessOut { options, largest, levels }) => {
            let roughness = Roughness::new(options, plan)?;
            let code = roughness.base_code();
            let levels = levels.map(|sink| RoughnessLevels::new(plan, roughness, options.format, sink));
            (levels, Some(Flat { sink: largest, code }))
        }
    };
    let threads = backend.host_threads();
    let mut bands = MipBands { bands, plan, order, travelled: 0, maps, roughness, base, threads };
    backend.bake(plan, &mut bands, sinks)?;
    bands.finish()
}

/// Bytes that a bake with such levels, the last those of the roughness map if there is one, holds at most on `threads`
/// threads, besides its bands and what the sinks hold.
pub(crate) fn held_bytes(
    plan: &BakePlan,
    levels: &[LevelsOut<'_>],
    roughness: Option<&RoughnessOptions>,
    threads: usize,
) -> u64 {
    let rows = strip_rows(plan.size.width()).min(plan.size.height());
    let of_maps = levels[..plan.outputs().count()].iter().any(Option::is_some);
    let maps = if of_maps { MapLevels::held_bytes(plan, rows, threads) } else { 0 };
    maps + roughness.map_or(0, |options| RoughnessLevels::held_bytes(plan, options.format, rows, threads))
}

/// Whole rows of about [`STRIP_TEXELS`] texels.
fn strip_rows(width: usize) -> usize {
    (STRIP_TEXELS / width).max(1)
}

struct MipBands<'a> {
    bands: &'a mut dyn HeightBands,
    plan: &'a BakePlan,
    order: RowOrder,
    /// Rows that have passed.
    travelled: usize,
    maps: Option<MapLevels<'a>>,
    roughness: Option<RoughnessLevels<'a>>,
    /// The largest level of the roughness map.
    base: Option<Flat<'a>>,
    /// `None`: those that all of the process share.
    threads: Option<&'a ThreadPool>,
}

impl HeightBands for MipBands<'_> {
    fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
        let Self { bands, plan, order, travelled, maps, roughness, base, threads } = self;
        let Some(band) = bands.next()? else { return Ok(None) };
        base.as_mut().map_or(Ok(()), |base| base.fill(band.rows()))?;
        let strip_rows = strip_rows(plan.size.width());
        on(*threads, || {
            for first in (0..band.rows()).step_by(strip_rows) {
                let strip = band.part(first, strip_rows.min(band.rows() - first));
                let row = order.row(*travelled, plan.size.height());
                maps.as_mut().map_or(Ok(()), |maps| maps.add(row, &strip))?;
                roughness.as_mut().map_or(Ok(()), |roughness| roughness.add(row, &strip))?;
                *travelled += strip.rows();
            }
            Ok(())
        })?;
        Ok(Some(band))
    }
}

impl MipBands<'_> {
    /// Completes the levels once the last band has passed.
    fn finish(self) -> Result<()> {
        let Self { maps, roughness, threads, .. } = self;
        on(threads, || {
            maps.map_or(Ok(()), MapLevels::finish)?;
            roughness.map_or(Ok(()), RoughnessLevels::finish)
        })
    }
}

/// A map of one code.
struct Flat<'a> {
    sink: &'a mut dyn CodeSink,
    code: u32,
}

impl Flat<'_> {
    fn fill(&mut self, rows: usize) -> Result<()> {
        match self.sink.room(rows)? {
            CodesMut::U8(codes) => codes.fill(self.code as u8),
            CodesMut::U16(codes) => codes.fill(self.code as u16),
            CodesMut::F16(_) | CodesMut::F32(_) => unreachable!("checked with the options"),
        }
        self.sink.filled()
    }
}

/// Runs `job` on `threads`, or where it is.
fn on<T: Send>(threads: Option<&ThreadPool>, job: impl FnOnce() -> T + Send) -> T {
    match threads {
        Some(threads) => threads.install(job),
        None => job(),
    }
}
