//! The front door: a backend, chosen once, that bakes and blends maps.

use crate::backend::cpu::{Cpu, Reference};
use crate::backend::{Backend, RowBytes};
use crate::error::{Error, Result};
use crate::exact::{AxisScale, Weights};
use crate::map::ParallaxFormat;
use crate::map::{CodesMut, Edge, HeightMap, HeightType, NormalMap, ParallaxMap, Size, TexelFormat};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, BakePlan, NormalOptions, ParallaxOptions};
use crate::ops::blend::{BlendInputs, BlendMethod, BlendOptions, BlendPlan};
use crate::ops::parallax::ParallaxPlan;
use crate::stream::{
    BandReader, CodeSink, CodeWriter, HeightLayer, HeightRows, LayerReader, LayerSource, MapBands, MapLayers, MapSink,
    MaskLayer, Monitor, NormalLayer, NormalRows, RowOrder, RowsOut, Tiled, check_components, height_codes, mask_codes,
    read_map_watched, read_normals,
};
use std::sync::Arc;

/// Bakes maps on one backend.
///
/// ```
/// use texbake::{Baker, CodesRef, Grid, HeightMap, NormalOptions, Scale};
///
/// let ramp = HeightMap::from(Grid::from_fn(4, 1, |x, _| 51 * x as u8)?);
/// let options = NormalOptions { scale: Scale::texels(5), ..Default::default() };
/// let map = Baker::cpu().normal(&ramp, &options)?;
/// // Inside the ramp the slope is 1: the normal is (-1, 0, 1) / sqrt(2).
/// let CodesRef::U8(codes) = map.codes() else { unreachable!() };
/// assert_eq!(codes[3..6], [37, 128, 218]);
/// # Ok::<(), texbake::Error>(())
/// ```
pub struct Baker {
    backend: Arc<dyn Backend>,
    /// Takes over when the backend's device fails; without it, the failure is the result.
    fallback: Option<Arc<dyn Backend>>,
    reason: String,
}

/// How a job ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Ran {
    /// What ran it: `cpu` or `gpu`.
    pub backend: &'static str,
    /// Its device: threads and instruction set, or the adapter.
    pub device: String,
    /// Why another backend failed before, if one did.
    pub fallback: Option<String>,
    /// Size of the maps.
    pub size: Size,
}

/// How a bake ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Baked {
    /// Where it ran.
    pub ran: Ran,
    /// How the heights are stored.
    pub height_type: HeightType,
    /// The scale that was used, and whether it is the one that was asked for.
    pub scale: AxisScale,
}

/// How a blend ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Blended {
    /// Where it ran.
    pub ran: Ran,
    /// The weights that were used, and whether they are those that were asked for; `None` for methods without weights.
    pub weights: Option<Weights>,
}

/// What a bake makes of a height map: a normal map, a parallax map, or both.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Maps<N, P = N> {
    /// The normal map, if it was asked for.
    pub normal: Option<N>,
    /// The parallax map, if it was asked for.
    pub parallax: Option<P>,
}

impl<T> Maps<T> {
    /// The maps that there are: normal, then parallax.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        self.normal.iter().chain(&self.parallax)
    }

    /// As [`Maps::iter`].
    pub fn into_vec(self) -> Vec<T> {
        self.normal.into_iter().chain(self.parallax).collect()
    }
}

impl Ran {
    /// What ran it, as [`Baker::name`].
    pub fn name(&self) -> String {
        crate::backend::name(self.backend, &self.device)
    }
}

/// Maps up to this many bytes are held in memory if their last row is needed first and far; larger ones are read twice.
const HELD_BYTES: usize = 64 << 20;

impl Baker {
    /// A real GPU if there is one that passes its self-test, else the CPU. When a GPU fails during a job, the job
    /// runs again on the CPU.
    pub fn auto() -> Self {
        #[cfg(feature = "gpu")]
        let reason = match crate::backend::gpu::Gpu::open_real() {
            Ok(gpu) => {
                let reason = "the first real GPU that passes its self-test".into();
                return Self { backend: Arc::new(gpu), fallback: Some(Self::cpu().backend), reason };
            }
            Err(reason) => reason,
        };
        #[cfg(not(feature = "gpu"))]
        let reason = "this build has no gpu feature".into();
        Self { reason, ..Self::cpu() }
    }

    /// All cores, vectorised.
    pub fn cpu() -> Self {
        Self::only(Cpu::shared())
    }

    /// This many threads of its own, vectorised.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if `threads` is 0; [`crate::Error::Threads`] if the system refuses them.
    pub fn cpu_threads(threads: usize) -> Result<Self> {
        Ok(Self::only(Cpu::with_threads(threads)?))
    }

    /// One GPU and nothing else: the adapter whose description contains `adapter`, or the best one.
    /// `vulkan:llvmpipe` names the API too.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if there is none, or it fails its self-test; later, if it fails during a job.
    pub fn gpu(adapter: Option<&str>) -> Result<Self> {
        #[cfg(feature = "gpu")]
        return Ok(Self::only(crate::backend::gpu::Gpu::open(adapter)?));
        #[cfg(not(feature = "gpu"))]
        Err(Error::device(adapter.unwrap_or("gpu"), "this build has no gpu feature; use --backend cpu"))
    }

    /// The specification: plain scalar code on one thread, to compare with.
    pub fn reference() -> Self {
        Self::only(Reference)
    }

    fn only(backend: impl Backend + 'static) -> Self {
        Self { backend: Arc::new(backend), fallback: None, reason: "asked for".into() }
    }

    /// What runs: the backend and its device.
    pub fn name(&self) -> String {
        crate::backend::name(self.backend.kind(), &self.backend.device())
    }

    /// Why this backend was chosen.
    pub fn reason(&self) -> &str {
        &self.reason
    }

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
        options.format.texel().check()?;
        options.format.texel().check_codes(heights.size(), codes.len(), codes.depth())?;
        self.bake_into(heights, &(*options).into(), vec![codes])
    }

    /// Bakes a height map into a parallax map, n_z (2h - 1), with the normals of the heights themselves.
    ///
    /// Float heights beyond 0 and 1 count as 0 and 1 in (2h - 1), and as they are in n_z.
    ///
    /// # Errors
    /// As [`Baker::normal`].
    pub fn parallax(&self, heights: &HeightMap, options: &ParallaxOptions) -> Result<ParallaxMap> {
        options.format.texel().check()?;
        let mut map = ParallaxMap::zeroed(heights.size(), options.format);
        self.bake_into(heights, &(*options).into(), vec![map.codes_mut()])?;
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
        BakePlan::new(options, heights.size(), heights.height_type())?;
        let mut normal = options.normal.map(|format| NormalMap::zeroed(heights.size(), format));
        let mut parallax = options.parallax.map(|format| ParallaxMap::zeroed(heights.size(), format));
        let normal_codes = normal.as_mut().map(NormalMap::codes_mut);
        let codes = normal_codes.into_iter().chain(parallax.as_mut().map(ParallaxMap::codes_mut)).collect();
        self.bake_into(heights, options, codes)?;
        Ok(Maps { normal, parallax })
    }

    /// Bakes into the codes of the plan's maps, one after the other.
    fn bake_into(&self, heights: &HeightMap, options: &BakeOptions, mut maps: Vec<CodesMut<'_>>) -> Result<Baked> {
        let plan = BakePlan::new(options, heights.size(), heights.height_type())?;
        let (ran, ()) = self.run(|backend| {
            let mut bands = MapBands::new(heights, plan.edges.y, backend.map_band_rows(RowBytes::of_bake(&plan)));
            let whole = maps.iter_mut().zip(plan.outputs()).map(|(codes, format)| whole_sink(codes, format, plan.size));
            let mut sinks: Vec<MapSink<'_>> = whole.collect();
            backend.bake(&plan, &mut bands, &mut as_dyn(&mut sinks))?;
            Ok((plan.size, ()))
        })?;
        Ok(Baked { ran, height_type: plan.height_type, scale: plan.scale })
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
    /// bottom and whose source cannot seek ([`RowSource::last_row_is_near`]: PNG), for a sink that cannot take row 0
    /// last ([`RowSink::takes_first_row_last`]: EXR): its heights are held if they are no more than 64 MiB, else
    /// decoded twice. What the source itself holds comes on top: [`crate::io::open_heights`] decodes some formats
    /// whole.
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
        let (ran, (height_type, scale)) = self.run(|backend| {
            let source = open()?;
            let plan = BakePlan::new(options, source.size(), source.height_type())?;
            let sinks = create(plan.size)?;
            if sinks.normal.is_some() != plan.normal.is_some() || sinks.parallax.is_some() != plan.parallax.is_some() {
                return Err(Error::parameter("maps", "other sinks", "a sink for each map that the options ask for"));
            }
            let sinks = sinks.into_vec();
            let all_take_it_last = sinks.iter().all(|sink| sink.takes_first_row_last());
            let order = match (plan.edges.y, plan.size.height()) {
                (Edge::Wrap, height) if height > 1 && all_take_it_last => RowOrder::FirstRowLast,
                _ => RowOrder::FromTop,
            };
            let formats: Vec<TexelFormat> = plan.outputs().collect();
            write_watched(sinks, &formats, plan.size, order, monitor, |sinks| {
                stream(backend, &plan, source, order, monitor, sinks)
            })?;
            Ok((plan.size, (plan.height_type, plan.scale)))
        })?;
        Ok(Baked { ran, height_type, scale })
    }

    /// Bakes a parallax map from heights and the normals of a map that is there already.
    ///
    /// # Errors
    /// As [`Baker::normal`]; [`crate::Error::Parameter`] if the maps differ in size; [`crate::Error::NoDirection`] for
    /// a float normal that is none.
    pub fn parallax_with_normals(
        &self,
        heights: &HeightMap,
        normals: &NormalMap,
        format: ParallaxFormat,
        precision: Precision,
    ) -> Result<ParallaxMap> {
        let plan = ParallaxPlan::new(heights.size(), heights.height_type(), normals.format(), format, precision)?;
        check_same_size("size of the normal map", normals.size(), plan.size)?;
        check_components(normals.codes(), normals.format(), plan.size.width(), 0)?;
        let mut map = ParallaxMap::zeroed(plan.size, format);
        self.run(|backend| {
            let band_rows = backend.map_band_rows(RowBytes::of_parallax(&plan));
            let layers = vec![height_codes(heights.heights()), normals.codes()];
            let mut bands = MapLayers::new(layers, plan.size.height(), band_rows);
            backend.parallax(&plan, &mut bands, &mut whole_sink(&mut map.codes_mut(), format.texel(), plan.size))?;
            Ok((plan.size, ()))
        })?;
        Ok(map)
    }

    /// The same from rows to rows, in memory that does not grow with the maps.
    ///
    /// # Errors
    /// As [`Baker::bake_rows`] and [`Baker::parallax_with_normals`].
    pub fn parallax_with_normals_rows(
        &self,
        open: &dyn Fn() -> Result<(HeightRows, NormalRows)>,
        create: &dyn Fn(Size) -> Result<RowsOut>,
        (format, precision): (ParallaxFormat, Precision),
        monitor: &Monitor,
    ) -> Result<Ran> {
        let (ran, ()) = self.run(|backend| {
            let (heights, normals) = open()?;
            let plan = ParallaxPlan::new(heights.size(), heights.height_type(), normals.format(), format, precision)?;
            check_same_size("size of the normal map", normals.size(), plan.size)?;
            let sinks = vec![create(plan.size)?];
            let band_rows = backend.band_rows(RowBytes::of_parallax(&plan));
            let layers: Vec<Box<dyn LayerSource>> =
                vec![Box::new(HeightLayer(heights)), Box::new(NormalLayer::new(normals))];
            write_watched(sinks, &[format.texel()], plan.size, RowOrder::FromTop, monitor, |sinks| {
                backend.parallax(&plan, &mut LayerReader::new(layers, plan.size.height(), band_rows)?, sinks[0])
            })?;
            Ok((plan.size, ()))
        })?;
        Ok(ran)
    }

    /// Blends two normal maps.
    ///
    /// A z at or below zero counts as the least above zero that the encoding has, so that every texel has a slope; a
    /// sum of vectors that is zero becomes (0, 0, 1).
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if an option is out of range, the sizes differ without [`BlendOptions::tile`], or
    /// a mask is missing or not wanted; [`crate::Error::NoDirection`] for a float normal that is none;
    /// [`crate::Error::Device`] if a GPU without a fallback fails.
    pub fn blend(&self, inputs: &BlendInputs<&NormalMap, &HeightMap>, options: &BlendOptions) -> Result<NormalMap> {
        let BlendInputs { base, detail, mask } = *inputs;
        let size = base.size();
        let formats = [base.format(), detail.format()];
        let plan = BlendPlan::new(options, size, formats, mask.map(HeightMap::height_type))?;
        for map in [base, detail] {
            check_components(map.codes(), map.format(), map.size().width(), 0)?;
        }
        check_layer_sizes(size, detail.size(), mask.map(HeightMap::size), options)?;
        let tiled = if detail.size() == size { None } else { Some(tiled(detail.clone(), size)?) };
        let mask = mask.map(mask_codes);
        let mut layers = vec![base.codes(), tiled.as_ref().unwrap_or(detail).codes()];
        layers.extend(mask.as_ref().map(|mask| mask.as_ref()));
        let mut map = NormalMap::zeroed(size, options.format);
        self.run(|backend| {
            let band_rows = backend.map_band_rows(RowBytes::of_blend(&plan));
            let mut bands = MapLayers::new(layers.clone(), size.height(), band_rows);
            backend.blend(&plan, &mut bands, &mut whole_sink(&mut map.codes_mut(), plan.format.texel(), size))?;
            Ok((size, ()))
        })?;
        Ok(map)
    }

    /// Blends rows from `open` into rows for `create` while they are read and written; a map that tiles is held.
    ///
    /// # Errors
    /// As [`Baker::blend`]; what opening, reading, creating and writing report; [`crate::Error::Cancelled`].
    pub fn blend_rows(
        &self,
        open: &dyn Fn() -> Result<BlendInputs<NormalRows, HeightRows>>,
        create: &dyn Fn(Size) -> Result<RowsOut>,
        options: &BlendOptions,
        monitor: &Monitor,
    ) -> Result<Blended> {
        let (ran, weights) = self.run(|backend| {
            let BlendInputs { base, mut detail, mask } = open()?;
            let size = base.size();
            let mask_type = mask.as_ref().map(|mask| mask.height_type());
            let plan = BlendPlan::new(options, size, [base.format(), detail.format()], mask_type)?;
            check_layer_sizes(size, detail.size(), mask.as_ref().map(|mask| mask.size()), options)?;
            if detail.size() != size {
                detail = Box::new(Tiled::new(read_normals(detail.as_mut())?, size));
            }
            let sinks = vec![create(size)?];
            let mut layers: Vec<Box<dyn LayerSource>> =
                vec![Box::new(NormalLayer::new(base)), Box::new(NormalLayer::new(detail))];
            if let Some(mask) = mask {
                layers.push(Box::new(MaskLayer::new(mask)));
            }
            let band_rows = backend.band_rows(RowBytes::of_blend(&plan));
            write_watched(sinks, &[plan.format.texel()], size, RowOrder::FromTop, monitor, |sinks| {
                backend.blend(&plan, &mut LayerReader::new(layers, size.height(), band_rows)?, sinks[0])
            })?;
            let is_weighted = matches!(plan.method, BlendMethod::Weighted { .. });
            Ok((size, is_weighted.then_some(plan.weights)))
        })?;
        Ok(Blended { ran, weights })
    }

    /// Runs a job, and runs it again on the fallback if the backend's device fails; then it says why.
    fn run<T>(&self, mut job: impl FnMut(&dyn Backend) -> Result<(Size, T)>) -> Result<(Ran, T)> {
        let mut run_on = |backend: &dyn Backend, fallback| {
            let (size, result) = job(backend)?;
            Ok((Ran { backend: backend.kind(), device: backend.device(), fallback, size }, result))
        };
        match (run_on(self.backend.as_ref(), None), &self.fallback) {
            (Err(Error::Device { adapter, reason }), Some(fallback)) => {
                run_on(fallback.as_ref(), Some(format!("{adapter}: {reason}")))
            }
            (result, _) => result,
        }
    }
}

/// All rows of a map in memory, to fill.
fn whole_sink<'a>(codes: &'a mut CodesMut<'_>, format: TexelFormat, size: Size) -> MapSink<'a> {
    let all = 0..codes.len();
    MapSink::new(codes.slice(all), format.row_codes(size.width()))
}

fn as_dyn<S: CodeSink>(sinks: &mut [S]) -> Vec<&mut dyn CodeSink> {
    sinks.iter_mut().map(|sink| sink as &mut dyn CodeSink).collect()
}

/// A normal map repeated, or cut, to `size`.
fn tiled(map: NormalMap, size: Size) -> Result<NormalMap> {
    read_normals(&mut Tiled::new(map, size))
}

fn check_layer_sizes(base: Size, detail: Size, mask: Option<Size>, options: &BlendOptions) -> Result<()> {
    if detail != base && !options.tile {
        let range = format!("{base}, as the first map's; to repeat a smaller one over the first, tile it (--tile)");
        return Err(Error::parameter("size of the second map", detail, range));
    }
    mask.map_or(Ok(()), |mask| check_same_size("size of the mask", mask, base))
}

fn check_same_size(parameter: &'static str, size: Size, wanted: Size) -> Result<()> {
    if size == wanted {
        Ok(())
    } else {
        Err(Error::parameter(parameter, size, format!("{wanted}, as the first map's")))
    }
}

/// Lets `produce` fill the rows of several maps, each written on a thread of its own, and completes them.
fn write_watched(
    sinks: Vec<RowsOut>,
    formats: &[TexelFormat],
    size: Size,
    order: RowOrder,
    monitor: &Monitor,
    produce: impl FnOnce(&mut [&mut dyn CodeSink]) -> Result<()>,
) -> Result<()> {
    let writer = |(sink, format): (_, &TexelFormat)| CodeWriter::new(sink, size, *format, order);
    let writers: Vec<CodeWriter> = sinks.into_iter().zip(formats).map(writer).collect::<Result<_>>()?;
    let monitored = |(index, sink)| {
        let row_texels = if index == 0 { size.width() } else { 0 };
        Monitored { sink, row_texels, room_texels: 0, texels: 0, monitor }
    };
    let mut sinks: Vec<Monitored<'_>> = writers.into_iter().enumerate().map(monitored).collect();
    let produced = produce(&mut as_dyn(&mut sinks));
    let texels = sinks[0].texels;
    // What a failed try has counted is baked again.
    let finish = || sinks.into_iter().try_for_each(|sink| sink.sink.finish());
    produced.and_then(|()| finish()).inspect_err(|_| monitor.take_back(texels))
}

/// Sends the rows of a source through a backend into sinks.
fn stream(
    backend: &dyn Backend,
    plan: &BakePlan,
    mut source: HeightRows,
    order: RowOrder,
    monitor: &Monitor,
    sinks: &mut [&mut dyn CodeSink],
) -> Result<()> {
    let band_rows = backend.band_rows(RowBytes::of_bake(plan));
    let needs_last_row_first = plan.edges.y == Edge::Wrap && order == RowOrder::FromTop;
    let is_far = needs_last_row_first && !source.last_row_is_near();
    if is_far && plan.size.texels() * plan.height_type.bytes() <= HELD_BYTES {
        let map = read_map_watched(source.as_mut(), monitor)?;
        return backend.bake(plan, &mut MapBands::new(&map, plan.edges.y, band_rows), sinks);
    }
    backend.bake(plan, &mut BandReader::new(source, plan.edges.y, order, band_rows)?, sinks)
}

/// Counts what passes to a sink.
struct Monitored<'a> {
    sink: CodeWriter,
    /// Texels of a row; zero for all but the first map of a bake, since its texels are the others' too.
    row_texels: usize,
    room_texels: usize,
    /// Counted so far.
    texels: u64,
    monitor: &'a Monitor,
}

impl CodeSink for Monitored<'_> {
    fn room(&mut self, rows: usize) -> Result<CodesMut<'_>> {
        self.monitor.check()?;
        self.room_texels = rows * self.row_texels;
        self.sink.room(rows)
    }

    fn filled(&mut self) -> Result<()> {
        self.sink.filled()?;
        let texels = std::mem::take(&mut self.room_texels) as u64;
        self.texels += texels;
        self.monitor.add(texels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::fill_rows;
    use crate::map::Grid;
    use crate::stream::{HeightBands, LayerBands};

    /// A device that fails after it has written a wrong row.
    struct Failing;

    impl Backend for Failing {
        fn kind(&self) -> &'static str {
            "failing"
        }

        fn device(&self) -> String {
            "device".into()
        }

        fn band_rows(&self, _: RowBytes) -> usize {
            1
        }

        fn bake(&self, _: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
            bands.next()?;
            fill_rows(sinks, 1, |maps| maps.iter_mut().for_each(|codes| codes.bytes_mut().fill(77)))?;
            Err(Error::device("failing", "out of memory"))
        }

        fn blend(&self, _: &BlendPlan, _: &mut dyn LayerBands, _: &mut dyn CodeSink) -> Result<()> {
            Err(Error::device("failing", "out of memory"))
        }

        fn parallax(&self, _: &ParallaxPlan, _: &mut dyn LayerBands, _: &mut dyn CodeSink) -> Result<()> {
            Err(Error::device("failing", "out of memory"))
        }
    }

    fn pyramid() -> HeightMap {
        Grid::from_fn(9, 7, |x, y| (x.min(8 - x) * y.min(6 - y) * 20) as u8).unwrap().into()
    }

    #[test]
    fn a_failed_device_leaves_the_job_to_the_fallback() {
        let baker = Baker { fallback: Some(Arc::new(Reference)), ..Baker::only(Failing) };
        let options = NormalOptions::default();
        assert_eq!(
            baker.normal(&pyramid(), &options).unwrap(),
            Baker::reference().normal(&pyramid(), &options).unwrap()
        );
        let mut codes = vec![0; 9 * 7 * 3];
        let Baked { ran, .. } = baker.normal_into(&pyramid(), &options, CodesMut::U8(&mut codes)).unwrap();
        assert_eq!((ran.name(), ran.fallback), (Baker::reference().name(), Some("failing: out of memory".into())));
    }

    #[test]
    fn threads_are_counted_from_one() {
        assert!(Baker::cpu_threads(1).unwrap().name().starts_with("cpu, 1 thread, "));
        let Err(error) = Baker::cpu_threads(0) else { panic!("a bake on no thread") };
        assert_eq!(error.to_string(), "threads is 0: it must be at least 1");
    }

    #[test]
    fn without_a_fallback_the_failure_is_the_result() {
        let error = Baker::only(Failing).normal(&pyramid(), &NormalOptions::default()).unwrap_err();
        assert_eq!(error.to_string(), "failing: out of memory");
    }

    #[test]
    fn the_callers_memory_must_fit() {
        let mut codes = vec![0; 9 * 7 * 3 - 1];
        let error = Baker::reference().normal_into(&pyramid(), &NormalOptions::default(), CodesMut::U8(&mut codes));
        assert_eq!(error.unwrap_err().to_string(), "codes is 188 codes of 8 bits: it must be 189 codes of 8 bits");
    }
}
