//! Height maps into normal and parallax maps.

use super::memory::job_bytes;
use super::write::{as_dyn, whole_sink, write_watched};
use super::{Baker, Ran};
use crate::backend::RowBytes;
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{CodesMut, Edge, HeightMap, HeightType, Maps, NormalMap, ParallaxMap, Size, TexelFormat};
use crate::mips::bake_with_levels;
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions, ParallaxOptions};
use crate::stream::{
    BandReader, HeightBands, HeightRows, MapBands, MapSink, Monitor, RowOrder, RowSource, RowsOut, read_map_watched,
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
        self.bake_into(heights, &(*options).into(), Maps { normal: Some(codes), parallax: None })
    }

    /// Bakes a height map into a parallax map, n_z (2h - 1), with the normals of the heights themselves.
    ///
    /// Float heights beyond 0 and 1 count as 0 and 1 in (2h - 1), and as they are in n_z.
    ///
    /// # Errors
    /// As [`Baker::normal`].
    pub fn parallax(&self, heights: &HeightMap, options: &ParallaxOptions) -> Result<ParallaxMap> {
        let mut map = ParallaxMap::zeroed(heights.size(), options.format);
        self.bake_into(heights, &(*options).into(), Maps { normal: None, parallax: Some(map.codes_mut()) })?;
        Ok(map)
    }

    /// Bakes a height map into the maps that the options ask for, in one pass: the same bytes as one after the other.
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
    pub fn bake(&self, heights: &HeightMap, options: &BakeOptions) -> Result<Maps<NormalMap, ParallaxMap>> {
        let mut normal = options.normal.map(|format| NormalMap::zeroed(heights.size(), format));
        let mut parallax = options.parallax.map(|format| ParallaxMap::zeroed(heights.size(), format));
        let codes = Maps {
            normal: normal.as_mut().map(NormalMap::codes_mut),
            parallax: parallax.as_mut().map(ParallaxMap::codes_mut),
        };
        self.bake_into(heights, options, codes)?;
        Ok(Maps { normal, parallax })
    }

    /// Bakes a height map into the caller's memory: codes texel by texel, in rows from the top. Tells how it ran.
    ///
    /// # Errors
    /// As [`Baker::bake`], and [`crate::Error::Parameter`] if the maps are others than the options ask for, or one is
    /// not of its format's depth and the height map's size.
    pub fn bake_into(&self, heights: &HeightMap, options: &BakeOptions, maps: Maps<CodesMut<'_>>) -> Result<Baked> {
        let plan = BakePlan::new(options, heights.size(), heights.height_type())?;
        check_maps(&plan, &maps)?;
        let mut maps = maps.into_vec();
        for (codes, format) in maps.iter().zip(plan.outputs()) {
            format.check_codes(plan.size, codes.len(), codes.depth())?;
        }
        let (ran, ()) = self.run(|backend| {
            let mut bands = MapBands::new(heights, plan.edges.y, backend.map_band_rows(RowBytes::of_bake(&plan)));
            let whole = maps.iter_mut().zip(plan.outputs()).map(|(codes, format)| whole_sink(codes, format, plan.size));
            let mut sinks: Vec<MapSink<'_>> = whole.collect();
            backend.bake(&plan, &mut bands, &mut as_dyn(&mut sinks))?;
            Ok(())
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
        let create = |size| Ok(Maps { normal: Some(create(size)?), parallax: None });
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
            check_maps(&plan, &sinks)?;
            let mut sinks = sinks.into_vec();
            let all_take_it_last = sinks.iter().all(|sink| sink.takes_first_row_last());
            let order = match (plan.edges.y, plan.size.height()) {
                (Edge::Wrap, height) if height > 1 && all_take_it_last => RowOrder::FirstRowLast,
                _ => RowOrder::FromTop,
            };
            let held_map = if is_held(&plan, source.as_ref(), order) { plan.map_bytes() } else { 0 };
            let passing = job_bytes(backend, RowBytes::of_bake(&plan), plan.size.height(), &sinks);
            let _memory = turn.take(source.held_bytes() + held_map as u64 + passing, monitor)?;
            let formats: Vec<TexelFormat> = plan.outputs().collect();
            let levels = sinks.iter_mut().map(|sink| sink.levels().map(|levels| levels as _)).collect();
            write_watched(sinks, &formats, plan.size, order, monitor, |sinks| {
                let bake = |bands: &mut dyn HeightBands| bake_with_levels(backend, &plan, order, bands, sinks, levels);
                stream(source, &plan, order, backend.band_rows(RowBytes::of_bake(&plan)), monitor, bake)
            })?;
            Ok(plan)
        })?;
        Ok(Baked { ran, size: plan.size, height_type: plan.height_type, scale: plan.scale })
    }
}

/// Fails unless there is something for each map of the plan, and for no other.
fn check_maps<T>(plan: &BakePlan, maps: &Maps<T>) -> Result<()> {
    let fits = |given: &Option<T>, asked: bool| given.is_some() == asked;
    if fits(&maps.normal, plan.normal.is_some()) && fits(&maps.parallax, plan.parallax.is_some()) {
        return Ok(());
    }
    Err(Error::parameter("maps", "others", "those that the options ask for"))
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
    bake(&mut BandReader::new(source, plan.edges.y, order, band_rows)?)
}
