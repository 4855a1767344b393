//! Height maps into normal and parallax maps.

use super::memory::bake_bytes;
use super::write::{WatchedRows, finish, whole_sink};
use super::{Baker, Ran};
use crate::backend::RowBytes;
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{CodesMut, Edge, HeightMap, HeightType, Maps, NormalMap, ParallaxMap, RoughnessMap, Size};
use crate::mips::{Bake, MapSinks};
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions, ParallaxOptions};
use crate::stream::{
    BandReader, CodeWriter, HeightRows, MapBands, MapOut, Monitor, RowOrder, RowSource, read_map_watched,
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
        let mut maps = maps.pair(plan.formats())?;
        maps.iter().try_for_each(|(codes, format)| format.check_codes(plan.size, codes.len(), codes.depth()))?;
        let (ran, ()) = self.run(|backend| {
            let mut sinks = maps.as_mut().map(|(codes, format)| whole_sink(codes, *format, plan.size));
            let sinks = sinks.as_mut().map(|largest| MapSinks { largest, levels: None });
            let mut bands = MapBands::new(heights, plan.edges.y, backend.map_band_rows(RowBytes::of_bake(&plan)));
            Bake { backend, plan: &plan, order: RowOrder::FromTop }.run(&mut bands, sinks)
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
        create: &dyn Fn(Size) -> Result<MapOut>,
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
    /// Where there are [`levels`](MapOut::levels), the smaller mip levels of the map are baked too, as
    /// [`Baker::bake_levels`] does.
    ///
    /// `create` makes sinks for each map that the options ask for. Both may be called again if a GPU fails and the
    /// job moves to the CPU; no row of the failed try is kept.
    ///
    /// # Errors
    /// What opening, reading, creating and writing report; [`crate::Error::Cancelled`] when `monitor` says so;
    /// [`crate::Error::Parameter`] if `create` makes other sinks than the options ask for.
    pub fn bake_rows(
        &self,
        open: &dyn Fn() -> Result<HeightRows>,
        create: &dyn Fn(Size) -> Result<Maps<MapOut>>,
        options: &BakeOptions,
        monitor: &Monitor,
    ) -> Result<Baked> {
        let (ran, plan) = self.run(|backend| {
            let turn = monitor.turn();
            let mut source = open()?;
            let plan = BakePlan::new(options, source.size(), source.height_type())?;
            let maps = create(plan.size)?;
            if maps.roughness.as_ref().is_some_and(|map| map.levels.is_none()) {
                let range = "a .ktx2 or .dds file with mips";
                return Err(Error::parameter("roughness", "a map without mip levels", range));
            }
            let order = order_of_rows(&plan, &maps);
            let is_held = is_held(&plan, source.as_ref(), order);
            let held_map = if is_held { plan.map_bytes() as u64 } else { 0 };
            let _memory = turn.take(source.held_bytes() + held_map + bake_bytes(backend, &plan, &maps), monitor)?;

            // The texels of the first map are those of the others: they are counted once.
            let mut row_texels = plan.size.width();
            let mut maps = maps.pair(plan.formats())?.try_map(|(map, format)| {
                let writer = CodeWriter::new(map.rows, plan.size, format, order)?;
                Ok((WatchedRows::new(writer, std::mem::take(&mut row_texels), monitor), map.levels))
            })?;
            let sinks = maps.as_mut().map(|(largest, levels)| MapSinks { largest, levels: levels.take() });
            let bake = Bake { backend, plan: &plan, order };
            let band_rows = backend.band_rows(RowBytes::of_bake(&plan));
            if is_held {
                let map = read_map_watched(source.as_mut(), monitor)?;
                drop(source);
                bake.run(&mut MapBands::new(&map, plan.edges.y, band_rows), sinks)?;
            } else {
                bake.run(&mut BandReader::new(source, plan.edges.y, order, band_rows, monitor.stop())?, sinks)?;
            }
            finish(maps.into_iter().map(|(rows, _)| rows))?;
            Ok(plan)
        })?;
        Ok(Baked { ran, size: plan.size, height_type: plan.height_type, scale: plan.scale })
    }
}

/// The order that spares a source that wraps from bottom to top a second reading, if all sinks let it.
fn order_of_rows(plan: &BakePlan, maps: &Maps<MapOut>) -> RowOrder {
    let wraps = plan.edges.y == Edge::Wrap && plan.size.height() > 1;
    let first_row_last = wraps && maps.iter().all(|map| map.rows.takes_first_row_last());
    if first_row_last { RowOrder::FirstRowLast } else { RowOrder::FromTop }
}

/// Whether the heights are held in memory, since their last row is needed first, and far.
fn is_held(plan: &BakePlan, source: &dyn RowSource, order: RowOrder) -> bool {
    let needs_last_row_first = plan.edges.y == Edge::Wrap && order == RowOrder::FromTop;
    needs_last_row_first && !source.last_row_is_near() && plan.map_bytes() <= HELD_BYTES
}
