//! Height maps into normal and parallax maps.

use super::memory::{beside_bytes, job_bytes};
use super::write::{as_dyn, whole_sink, write_watched};
use super::{Baker, Ran};
use crate::backend::RowBytes;
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{
    CodesMut, Edge, HeightMap, HeightType, Maps, NormalMap, ParallaxMap, RoughnessMap, Size, TexelFormat,
};
use crate::mips::{Beside, LevelsOut, RoughnessOut, bake_with_levels};
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions, ParallaxOptions};
use crate::stream::{
    BandReader, CodeSink, HeightBands, HeightRows, MapBands, MapSink, Monitor, RowOrder, RowSource, RowsOut,
    read_map_watched,
};

/// How a bake ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Baked {
    /// Where it ran.
    pub ran: Ran,
    /// Size of the maps.
    pub size: Size,
    /// How the heights are stored.
    pub height_type: HeightType,
    /// The scale that was used, and whether it is the one that was asked for.
    pub scale: AxisScale,
}

/// The maps of a bake in memory.
pub type BakedMaps = Maps<NormalMap, ParallaxMap, RoughnessMap>;

/// Maps up to this many bytes are held in memory if their last row is needed first and far; larger ones are read twice.
const HELD_BYTES: usize = 64 << 20;

impl Baker {
    /// Bakes a height map into a normal map.
    ///
    /// [`Baker::normal_into`] also tells how it ran: a GPU of [`Baker::auto`] that fails leaves the job to the CPU.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an option is out of range; [`crate::Error::Device`] if a GPU without a
    /// fallback fails.
    pub fn normal(&self, heights: &HeightMap, options: &NormalOptions) -> Result<NormalMap> {
        let mut map = NormalMap::zeroed(heights.size(), options.format);
        self.normal_into(heights, options, map.codes_mut())?;
        Ok(map)
    }

    /// Bakes a height map into the caller's memory: codes texel by texel, in rows from the top. Tells how it ran.
    ///
    /// # Errors
    /// As [`Baker::normal`], and [`crate::Error::Parameter`] if `codes` is not of the format's depth and the map's
    /// size.
    pub fn normal_into(&self, heights: &HeightMap, options: &NormalOptions, codes: CodesMut<'_>) -> Result<Baked> {
        self.bake_into(heights, &(*options).into(), Maps { normal: Some(codes), ..Maps::default() })
    }

    /// Bakes a height map into a parallax map, n_z (2h - 1), with the normals of the heights themselves.
    ///
    /// Float heights beyond 0 and 1 count as 0 and 1 in (2h - 1), and as they are in n_z.
    ///
    /// # Errors
    /// As [`Baker::normal`].
    pub fn parallax(&self, heights: &HeightMap, options: &ParallaxOptions) -> Result<ParallaxMap> {
        let mut map = ParallaxMap::zeroed(heights.size(), options.format);
        self.bake_into(heights, &(*options).into(), Maps { parallax: Some(map.codes_mut()), ..Maps::default() })?;
        Ok(map)
    }

    /// Bakes a height map into the maps that the options ask for, in one pass: the same bytes as one after the other.
    ///
    /// A roughness map is flat here, since nothing has been filtered: [`Baker::bake_levels`] has the others.
    ///
    /// ```
    /// use texbake::{BakeOptions, Baker, Grid, HeightMap, NormalFormat, ParallaxFormat, Scale};
    ///
    /// let heights = HeightMap::from(Grid::from_fn(64, 64, |x, y| (x ^ y) as u8)?);
    /// let (normal, parallax) = (Some(NormalFormat::default()), Some(ParallaxFormat::default()));
    /// let options = BakeOptions { scale: Scale::texels(24), normal, parallax, ..Default::default() };
    /// let maps = Baker::cpu().bake(&heights, &options)?;
    /// assert!(maps.normal.is_some() && maps.parallax.is_some());
    /// # Ok::<(), texbake::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Baker::normal`], and [`crate::Error::Parameter`] if no map is asked for.
    pub fn bake(&self, heights: &HeightMap, options: &BakeOptions) -> Result<BakedMaps> {
        let mut normal = options.normal.map(|format| NormalMap::zeroed(heights.size(), format));
        let mut parallax = options.parallax.map(|format| ParallaxMap::zeroed(heights.size(), format));
        let mut roughness = options.roughness.map(|options| RoughnessMap::zeroed(heights.size(), options.format));
        let codes = Maps {
            normal: normal.as_mut().map(NormalMap::codes_mut),
            parallax: parallax.as_mut().map(ParallaxMap::codes_mut),
            roughness: roughness.as_mut().map(RoughnessMap::codes_mut),
        };
        self.bake_into(heights, options, codes)?;
        Ok(Maps { normal, parallax, roughness })
    }

    /// Bakes a height map into the caller's memory: codes texel by texel, in rows from the top. Tells how it ran.
    ///
    /// # Errors
    /// As [`Baker::bake`], and [`crate::Error::Parameter`] if the maps are others than the options ask for, or one is
    /// not of its format's depth and the height map's size.
    pub fn bake_into(&self, heights: &HeightMap, options: &BakeOptions, maps: Maps<CodesMut<'_>>) -> Result<Baked> {
        let plan = BakePlan::new(options, heights.size(), heights.height_type())?;
        check_maps(options, &maps)?;
        let mut maps = maps.into_vec();
        let formats = formats(&plan, options);
        for (codes, format) in maps.iter().zip(&formats) {
            format.check_codes(plan.size, codes.len(), codes.depth())?;
        }
        let (ran, ()) = self.run(|backend| {
            let mut bands = MapBands::new(heights, plan.edges.y, backend.map_band_rows(RowBytes::of_bake(&plan)));
            let whole = maps.iter_mut().zip(&formats).map(|(codes, format)| whole_sink(codes, *format, plan.size));
            let mut sinks: Vec<MapSink<'_>> = whole.collect();
            let mut sinks = as_dyn(&mut sinks);
            let (sinks, beside) = beside(options, &mut sinks, Vec::new());
            bake_with_levels(backend, &plan, RowOrder::FromTop, &mut bands, sinks, beside)
        })?;
        Ok(Baked { ran, size: plan.size, height_type: plan.height_type, scale: plan.scale })
    }

    /// Bakes rows from `open` into rows of a normal map for `create` while they are read and written: as
    /// [`Baker::bake_rows`] with this one map.
    ///
    /// # Errors
    /// As [`Baker::bake_rows`].
    pub fn normal_rows(
        &self,
        open: &dyn Fn() -> Result<HeightRows>,
        create: &dyn Fn(Size) -> Result<RowsOut>,
        options: &NormalOptions,
        monitor: &Monitor,
    ) -> Result<Baked> {
        let create = |size| Ok(Maps { normal: Some(create(size)?), ..Maps::default() });
        self.bake_rows(open, &create, &(*options).into(), monitor)
    }

    /// Bakes rows from `open` into rows for `create` while they are read and written.
    ///
    /// A few bands are in memory at a time, however high the map. The exception is a map whose edge wraps from top to
    /// bottom and whose source cannot seek ([`last_row_is_near`](crate::stream::RowSource::last_row_is_near): PNG), for
    /// a sink that cannot take row 0 last
    /// ([`takes_first_row_last`](crate::stream::RowSink::takes_first_row_last): EXR): its heights are held if they are
    /// no more than 64 MiB, else decoded twice. What the source itself holds comes on top:
    /// [`crate::io::open_heights`] decodes some formats whole.
    ///
    /// Where a sink has [`levels`](crate::stream::RowSink::levels), the smaller mip levels of its map are baked too, as
    /// [`Baker::bake_levels`] does.
    ///
    /// `create` makes a sink for each map that the options ask for. Both may be called again if a GPU fails and the
    /// job moves to the CPU; no row of the failed try is kept.
    ///
    /// # Errors
    /// What opening, reading, creating and writing report; [`crate::Error::Cancelled`] when `monitor` says so;
    /// [`crate::Error::Parameter`] if `create` makes other sinks than the options ask for.
    pub fn bake_rows(
        &self,
        open: &dyn Fn() -> Result<HeightRows>,
        create: &dyn Fn(Size) -> Result<Maps<RowsOut>>,
        options: &BakeOptions,
        monitor: &Monitor,
    ) -> Result<Baked> {
        let (ran, plan) = self.run(|backend| {
            let turn = monitor.turn();
            let source = open()?;
            let plan = BakePlan::new(options, source.size(), source.height_type())?;
            let sinks = create(plan.size)?;
            check_maps(options, &sinks)?;
            let mut sinks = sinks.into_vec();
            let all_take_it_last = sinks.iter().all(|sink| sink.takes_first_row_last());
            let order = match (plan.edges.y, plan.size.height()) {
                (Edge::Wrap, height) if height > 1 && all_take_it_last => RowOrder::FirstRowLast,
                _ => RowOrder::FromTop,
            };
            let levels: Vec<LevelsOut<'_>> = sinks.iter_mut().map(|sink| sink.levels().map(|it| it as _)).collect();
            if options.roughness.is_some() && levels.last().is_none_or(Option::is_none) {
                let range = "a .ktx2 or .dds file with mips";
                return Err(Error::parameter("roughness", "a map without mip levels", range));
            }
            let held_map = if is_held(&plan, source.as_ref(), order) { plan.map_bytes() } else { 0 };
            let passing = job_bytes(backend, RowBytes::of_bake(&plan), plan.size.height(), &sinks);
            let beside_maps = beside_bytes(backend, &plan, options, &levels);
            let _memory = turn.take(source.held_bytes() + held_map as u64 + passing + beside_maps, monitor)?;
            write_watched(sinks, &formats(&plan, options), plan.size, order, monitor, |sinks| {
                let (sinks, beside) = beside(options, sinks, levels);
                let bake = |bands: &mut dyn HeightBands| bake_with_levels(backend, &plan, order, bands, sinks, beside);
                stream(source, &plan, order, backend.band_rows(RowBytes::of_bake(&plan)), monitor, bake)
            })?;
            Ok(plan)
        })?;
        Ok(Baked { ran, size: plan.size, height_type: plan.height_type, scale: plan.scale })
    }
}

/// Fails unless there is something for each map that is asked for, and for no other.
fn check_maps<T>(options: &BakeOptions, maps: &Maps<T>) -> Result<()> {
    let given = [maps.normal.is_some(), maps.parallax.is_some(), maps.roughness.is_some()];
    if given == [options.normal.is_some(), options.parallax.is_some(), options.roughness.is_some()] {
        return Ok(());
    }
    Err(Error::parameter("maps", "others", "those that the options ask for"))
}

/// The formats of all maps: the plan's and that of the roughness map.
fn formats(plan: &BakePlan, options: &BakeOptions) -> Vec<TexelFormat> {
    plan.outputs().chain(options.roughness.map(|options| options.format.texel())).collect()
}

/// The sinks of the plan's maps, and what is made beside them: the roughness map, whose sink is the last, and levels.
pub(super) fn beside<'s, 'c>(
    options: &'s BakeOptions,
    sinks: &'s mut [&'c mut dyn CodeSink],
    mut levels: Vec<LevelsOut<'s>>,
) -> (&'s mut [&'c mut dyn CodeSink], Beside<'s>) {
    let Some(options) = &options.roughness else { return (sinks, Beside { levels, roughness: None }) };
    let (largest, maps) = sinks.split_last_mut().expect("a sink for each map");
    let roughness = RoughnessOut { options, largest: &mut **largest, levels: levels.pop().flatten() };
    (maps, Beside { levels, roughness: Some(roughness) })
}

/// Whether the heights are held in memory, since their last row is needed first, and far.
fn is_held(plan: &BakePlan, source: &dyn RowSource, order: RowOrder) -> bool {
    let needs_last_row_first = plan.edges.y == Edge::Wrap && order == RowOrder::FromTop;
    needs_last_row_first && !source.last_row_is_near() && plan.map_bytes() <= HELD_BYTES
}

/// Bakes the rows of a source, cut into bands.
fn stream(
    mut source: HeightRows,
    plan: &BakePlan,
    order: RowOrder,
    band_rows: usize,
    monitor: &Monitor,
    bake: impl FnOnce(&mut dyn HeightBands) -> Result<()>,
) -> Result<()> {
    if is_held(plan, source.as_ref(), order) {
        let map = read_map_watched(source.as_mut(), monitor)?;
        return bake(&mut MapBands::new(&map, plan.edges.y, band_rows));
    }
    bake(&mut BandReader::new(source, plan.edges.y, order, band_rows, monitor.stop())?)
}
