//! The largest level of each map by a backend, and what is made beside it.

use super::flat::Flat;
use super::maps::MapLevels;
use super::roughness::Roughness;
use super::roughness_levels::RoughnessLevels;
use super::tee::{Tap, Tee, strip_rows};
use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::map::Maps;
use crate::ops::bake::BakePlan;
use crate::stream::{CodeSink, HeightBands, LevelSink, MapOut, RowOrder};

/// Most texels of a map, so that sums of 16-bit heights with any filter fit 63 bits.
const GREATEST_TEXELS: usize = 1 << 42;

/// What takes the levels of a map below its largest; `None` if none are wanted.
pub(crate) type LevelsOut<'a> = Option<Box<dyn LevelSink + 'a>>;

/// Where a map goes while it is baked.
pub(crate) struct MapSinks<'a> {
    pub largest: &'a mut dyn CodeSink,
    pub levels: LevelsOut<'a>,
}

/// A plan, where it runs, and in which order the rows of its maps come.
#[derive(Clone, Copy)]
pub(crate) struct Bake<'a> {
    pub backend: &'a dyn Backend,
    pub plan: &'a BakePlan,
    pub order: RowOrder,
}

impl Bake<'_> {
    /// Bakes all bands of a height map into the plan's maps.
    ///
    /// The backend bakes the largest level of normal and parallax maps as if there were nothing else. The CPU makes the
    /// others and roughness: they are the same whatever the backend, and cost it a fraction of level 0. Without levels a
    /// roughness map is flat.
    ///
    /// # Errors
    /// What the bands or the sinks report, [`Error::Device`], and [`Error::Parameter`] for a map too large for levels.
    pub fn run(self, bands: &mut dyn HeightBands, maps: Maps<MapSinks<'_>>) -> Result<()> {
        let Self { backend, plan, order } = self;
        let Maps { normal, parallax, roughness } = maps;
        let baked = [normal, parallax].into_iter().flatten().map(|map| (map.largest, map.levels));
        let (mut sinks, levels): (Vec<&mut dyn CodeSink>, Vec<LevelsOut<'_>>) = baked.unzip();

        let mut taps: Vec<Box<dyn Tap + '_>> = Vec::new();
        if levels.iter().any(Option::is_some) {
            taps.push(Box::new(MapLevels::new(plan, levels)));
        }
        if let Some((MapSinks { largest, levels }, options)) = roughness.zip(plan.roughness) {
            let roughness = Roughness::new(&options, plan);
            taps.push(Box::new(Flat::new(largest, roughness.base_code())));
            if let Some(sink) = levels {
                taps.push(Box::new(RoughnessLevels::new(plan, roughness, options.format, sink)));
            }
        }
        if taps.is_empty() {
            return backend.bake(plan, bands, &mut sinks);
        }
        if plan.size.texels() > GREATEST_TEXELS {
            return Err(Error::parameter("mips", plan.size, "left out for maps of more than 2^42 texels"));
        }
        let mut tee = Tee::new(bands, plan.size, order, taps, backend.host_threads());
        backend.bake(plan, &mut tee, &mut sinks)?;
        tee.finish()
    }
}

/// Bytes that the smaller levels of `maps` take at most on `threads` threads, besides bands and what the sinks hold.
pub(crate) fn held_bytes(plan: &BakePlan, maps: &Maps<MapOut>, threads: usize) -> u64 {
    let rows = strip_rows(plan.size.width()).min(plan.size.height());
    let has_levels = |map: &Option<MapOut>| map.as_ref().is_some_and(|map| map.levels.is_some());
    let mut bytes = 0;
    if has_levels(&maps.normal) || has_levels(&maps.parallax) {
        bytes += MapLevels::held_bytes(plan, rows);
    }
    if has_levels(&maps.roughness)
        && let Some(options) = plan.roughness
    {
        bytes += RoughnessLevels::held_bytes(plan, options.format, rows, threads);
    }
    bytes
}
