//! The levels of the maps of a bake, made beside it.

use super::pyramid::{Pyramid, Rows};
use super::sample::Sample;
use crate::backend::Backend;
use crate::backend::cpu::levels::{LevelHeight, LevelSum, planes, samples};
use crate::error::{Error, Result};
use crate::map::{Codes, HeightType, TexelFormat};
use crate::ops::bake::BakePlan;
use crate::stream::{Band, CodeSink, HeightBand, HeightBands, LevelSink, RowOrder};
use rayon::prelude::*;

/// Texels whose sums are made at a time: they stay in the second cache.
const STRIP_TEXELS: usize = 1 << 17;

/// Most texels of a map, so that sums of 16-bit heights with any filter fit 63 bits.
const GREATEST_TEXELS: usize = 1 << 42;

/// What takes the levels of a map; `None` if none are wanted.
pub(crate) type LevelsOut<'a> = Option<Box<dyn LevelSink + 'a>>;

/// The bands of a height map on their way to a backend, and the levels of its maps.
///
/// The backend bakes level 0 as if there were no others; they are the same whichever it is.
struct MipBands<'a> {
    bands: &'a mut dyn HeightBands,
    plan: &'a BakePlan,
    order: RowOrder,
    travelled: usize,
    sums: Sums,
    /// For each map of the plan.
    sinks: Vec<LevelsOut<'a>>,
    threads: Option<&'a rayon::ThreadPool>,
}

enum Sums {
    Integers(Pyramid<i32>),
    Floats(Pyramid<f32>),
}

impl<'a> MipBands<'a> {
    /// The levels of each map of the plan go to `sinks`; `threads` make them, or those of the process.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a map of more than 2^42 texels.
    pub fn new(
        bands: &'a mut dyn HeightBands,
        plan: &'a BakePlan,
        order: RowOrder,
        sinks: Vec<LevelsOut<'a>>,
        threads: Option<&'a rayon::ThreadPool>,
    ) -> Result<Self> {
        if plan.size.texels() > GREATEST_TEXELS {
            return Err(Error::parameter("mips", plan.size, "left out for maps of more than 2^42 texels"));
        }
        let sums = match plan.height_type {
            HeightType::U8 | HeightType::U16 => Sums::Integers(Pyramid::new(plan.size, planes(plan))),
            HeightType::F32 => Sums::Floats(Pyramid::new(plan.size, planes(plan))),
        };
        Ok(Self { bands, plan, order, travelled: 0, sums, sinks, threads })
    }

    /// Completes the levels once the last band has passed.
    ///
    /// # Errors
    /// What the sinks report.
    pub fn finish(self) -> Result<()> {
        let Self { plan, sums, mut sinks, threads, .. } = self;
        on(threads, || match sums {
            Sums::Integers(pyramid) => write(plan, pyramid.finish(), &mut sinks),
            Sums::Floats(pyramid) => write(plan, pyramid.finish(), &mut sinks),
        })
    }
}

impl HeightBands for MipBands<'_> {
    fn next(&mut self) -> Result<Option<HeightBand<'_>>> {
        let Self { bands, plan, order, travelled, sums, sinks, threads } = self;
        let Some(band) = bands.next()? else { return Ok(None) };
        let strip_rows = (STRIP_TEXELS / plan.size.width()).max(1);
        on(*threads, || {
            for first in (0..band.rows()).step_by(strip_rows) {
                let strip = band.part(first, strip_rows.min(band.rows() - first));
                let row = order.row(*travelled, plan.size.height());
                match (&strip, &mut *sums) {
                    (HeightBand::U8(strip), Sums::Integers(pyramid)) => add(plan, pyramid, row, strip, sinks),
                    (HeightBand::U16(strip), Sums::Integers(pyramid)) => add(plan, pyramid, row, strip, sinks),
                    (HeightBand::F32(strip), Sums::Floats(pyramid)) => add(plan, pyramid, row, strip, sinks),
                    _ => unreachable!("the plan was made for heights of another type"),
                }?;
                *travelled += strip.rows();
            }
            Ok(())
        })?;
        Ok(Some(band))
    }
}

/// Bakes all bands of a height map into the rows of the plan's maps, and their levels into `levels`, if they are wanted.
///
/// # Errors
/// What the bands or the sinks report, [`Error::Device`], and [`Error::Parameter`] for a map too large for levels.
pub(crate) fn bake_with_levels(
    backend: &dyn Backend,
    plan: &BakePlan,
    order: RowOrder,
    bands: &mut dyn HeightBands,
    sinks: &mut [&mut dyn CodeSink],
    levels: Vec<LevelsOut<'_>>,
) -> Result<()> {
    if levels.iter().all(Option::is_none) {
        return backend.bake(plan, bands, sinks);
    }
    let mut bands = MipBands::new(bands, plan, order, levels, backend.host_threads())?;
    backend.bake(plan, &mut bands, sinks)?;
    bands.finish()
}

/// Runs `job` on `threads`, or those of the process.
fn on<T: Send>(threads: Option<&rayon::ThreadPool>, job: impl FnOnce() -> T + Send) -> T {
    match threads {
        Some(threads) => threads.install(job),
        None => job(),
    }
}

/// Adds a strip whose first row is row `row` of the map, and writes what it completes.
fn add<T: LevelHeight>(
    plan: &BakePlan,
    pyramid: &mut Pyramid<T::Sum>,
    row: usize,
    strip: &Band<'_, T>,
    sinks: &mut [LevelsOut<'_>],
) -> Result<()>
where
    T::Sum: Sample<Sum: LevelSum>,
{
    let row_samples = planes(plan) * strip.width;
    let mut strip_samples = vec![T::Sum::default(); strip.rows() * row_samples];
    let rows = strip_samples.par_chunks_mut(row_samples).enumerate();
    rows.for_each(|(row, row_samples)| samples(plan, strip, row, row_samples));
    write(plan, pyramid.add(row, &strip_samples), sinks)
}

/// Writes complete rows of sums as rows of codes.
fn write<S: Sample + LevelSum>(plan: &BakePlan, complete: Vec<Rows<S>>, sinks: &mut [LevelsOut<'_>]) -> Result<()> {
    let formats: Vec<TexelFormat> = plan.outputs().collect();
    for Rows { level, weight, width, rows, sums } in complete {
        if rows.is_empty() {
            continue;
        }
        let row_codes = |format: &TexelFormat| format.row_codes(width);
        let mut maps: Vec<Codes> =
            formats.iter().map(|format| Codes::zeroed(format.depth, rows.len() * row_codes(format))).collect();
        let mut by_row: Vec<Vec<_>> = rows.clone().map(|_| Vec::new()).collect();
        for (codes, format) in maps.iter_mut().zip(&formats) {
            let rows = codes.as_mut().into_chunks(row_codes(format));
            by_row.iter_mut().zip(rows).for_each(|(maps, codes)| maps.push(codes));
        }
        by_row.into_par_iter().zip(sums.par_chunks(planes(plan) * width)).for_each(|(maps, sums)| {
            let planes: Vec<&[S]> = sums.chunks(width).collect();
            S::codes(plan, weight, &planes, maps);
        });
        for (sink, codes) in sinks.iter_mut().zip(&maps) {
            if let Some(sink) = sink {
                sink.write(level, rows.start, codes.as_ref())?;
            }
        }
    }
    Ok(())
}
