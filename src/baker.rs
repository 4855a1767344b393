//! The front door: a backend, chosen once, that bakes maps.

use crate::backend::Backend;
use crate::backend::cpu::{Cpu, Reference};
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{CodesMut, Edge, HeightMap, HeightType, NormalMap, Size};
use crate::ops::normal::{NormalOptions, NormalPlan};
use crate::stream::{
    BandReader, CodeSink, CodeWriter, MapBands, MapSink, Monitor, RowOrder, RowSink, RowSource, read_map_watched,
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

/// How a bake ran.
#[derive(Debug, Clone, PartialEq)]
pub struct Ran {
    /// What baked it: `cpu` or `gpu`.
    pub backend: &'static str,
    /// Its device: threads and instruction set, or the adapter.
    pub device: String,
    /// Why another backend failed before, if one did.
    pub fallback: Option<String>,
    /// Size of the map.
    pub size: Size,
    /// How its heights are stored.
    pub height_type: HeightType,
    /// The scale that was used, and whether it is the one that was asked for.
    pub scale: AxisScale,
}

impl Ran {
    fn on(backend: &dyn Backend, plan: &NormalPlan) -> Self {
        let (size, height_type, scale) = (plan.size, plan.height_type, plan.scale);
        Self { backend: backend.kind(), device: backend.device(), fallback: None, size, height_type, scale }
    }

    /// What baked it, as [`Baker::name`].
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
        let plan = NormalPlan::new(options, heights.size(), heights.height_type())?;
        let mut map = NormalMap::zeroed(plan.size, plan.format);
        self.normal_of_plan(heights, &plan, map.codes_mut())?;
        Ok(map)
    }

    /// Bakes a height map into the caller's memory: codes texel by texel, in rows from the top. Tells how it ran.
    ///
    /// # Errors
    /// As [`Baker::normal`], and [`crate::Error::Parameter`] if `codes` is not of the format's depth and the map's
    /// size.
    pub fn normal_into(&self, heights: &HeightMap, options: &NormalOptions, codes: CodesMut<'_>) -> Result<Ran> {
        let plan = NormalPlan::new(options, heights.size(), heights.height_type())?;
        plan.format.check_codes(plan.size, codes.len(), codes.depth())?;
        self.normal_of_plan(heights, &plan, codes)
    }

    fn normal_of_plan(&self, heights: &HeightMap, plan: &NormalPlan, mut codes: CodesMut<'_>) -> Result<Ran> {
        let all = 0..codes.len();
        self.run(|backend| {
            let mut bands = MapBands::new(heights, plan.edges.y, backend.map_band_rows(plan));
            backend.normal(plan, &mut bands, &mut MapSink::new(codes.slice(all.clone()), plan.row_codes()))?;
            Ok(Ran::on(backend, plan))
        })
    }

    /// Bakes rows from `open` into rows for `create` while they are read and written.
    ///
    /// A few bands are in memory at a time, however high the map. The exception is a map whose edge wraps from top to
    /// bottom and whose source cannot seek ([`RowSource::last_row_is_near`]: PNG), for a sink that cannot take row 0
    /// last ([`RowSink::takes_first_row_last`]: EXR): its heights are held if they are no more than 64 MiB, else
    /// decoded twice. What the source itself holds comes on top: [`crate::io::open_heights`] decodes some formats
    /// whole.
    ///
    /// Both may be called again if a GPU fails and the job moves to the CPU; no row of the failed try is kept.
    ///
    /// # Errors
    /// What opening, reading, creating and writing report; [`crate::Error::Cancelled`] when `monitor` says so.
    pub fn normal_rows(
        &self,
        open: &dyn Fn() -> Result<Box<dyn RowSource>>,
        create: &dyn Fn(Size) -> Result<Box<dyn RowSink>>,
        options: &NormalOptions,
        monitor: &Monitor,
    ) -> Result<Ran> {
        self.run(|backend| {
            let source = open()?;
            let plan = NormalPlan::new(options, source.size(), source.height_type())?;
            let sink = create(plan.size)?;
            let order = match (plan.edges.y, plan.size.height()) {
                (Edge::Wrap, height) if height > 1 && sink.takes_first_row_last() => RowOrder::FirstRowLast,
                _ => RowOrder::FromTop,
            };
            let writer = CodeWriter::new(sink, plan.size, plan.format, order)?;
            let mut sink = Monitored { sink: writer, width: plan.size.width(), texels: 0, monitor };
            // What a failed try has counted is baked again.
            let streamed = stream(backend, &plan, source, order, monitor, &mut sink);
            streamed.and_then(|()| sink.sink.finish()).inspect_err(|_| monitor.take_back(sink.texels))?;
            Ok(Ran::on(backend, &plan))
        })
    }

    /// Runs a job, and runs it again on the fallback if the backend's device fails; then it says why.
    fn run(&self, mut job: impl FnMut(&dyn Backend) -> Result<Ran>) -> Result<Ran> {
        match (job(self.backend.as_ref()), &self.fallback) {
            (Err(Error::Device { adapter, reason }), Some(fallback)) => {
                Ok(Ran { fallback: Some(format!("{adapter}: {reason}")), ..job(fallback.as_ref())? })
            }
            (result, _) => result,
        }
    }
}

/// Sends the rows of a source through a backend into a sink.
fn stream(
    backend: &dyn Backend,
    plan: &NormalPlan,
    mut source: Box<dyn RowSource>,
    order: RowOrder,
    monitor: &Monitor,
    sink: &mut dyn CodeSink,
) -> Result<()> {
    let band_rows = backend.band_rows(plan);
    let needs_last_row_first = plan.edges.y == Edge::Wrap && order == RowOrder::FromTop;
    let is_far = needs_last_row_first && !source.last_row_is_near();
    if is_far && plan.size.texels() * plan.height_type.bytes() <= HELD_BYTES {
        let map = read_map_watched(source.as_mut(), monitor)?;
        return backend.normal(plan, &mut MapBands::new(&map, plan.edges.y, band_rows), sink);
    }
    backend.normal(plan, &mut BandReader::new(source, plan.edges.y, order, band_rows)?, sink)
}

/// Counts what passes to a sink.
struct Monitored<'a> {
    sink: CodeWriter,
    width: usize,
    /// Counted so far.
    texels: u64,
    monitor: &'a Monitor,
}

impl CodeSink for Monitored<'_> {
    fn write(&mut self, rows: usize, fill: &mut dyn FnMut(&mut CodesMut<'_>) -> Result<()>) -> Result<()> {
        self.monitor.check()?;
        self.sink.write(rows, fill)?;
        let texels = (rows * self.width) as u64;
        self.texels += texels;
        self.monitor.add(texels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Grid;
    use crate::stream::HeightBands;

    /// A device that fails after it has written a wrong row.
    struct Failing;

    impl Backend for Failing {
        fn kind(&self) -> &'static str {
            "failing"
        }

        fn device(&self) -> String {
            "device".into()
        }

        fn band_rows(&self, _: &NormalPlan) -> usize {
            1
        }

        fn normal(&self, _: &NormalPlan, bands: &mut dyn HeightBands, sink: &mut dyn CodeSink) -> Result<()> {
            bands.next()?;
            sink.write(1, &mut |codes| {
                codes.bytes_mut().fill(77);
                Ok(())
            })?;
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
        let ran = baker.normal_into(&pyramid(), &options, CodesMut::U8(&mut codes)).unwrap();
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
