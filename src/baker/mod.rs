//! The front door: a backend, chosen once, that bakes and blends maps.

mod bake;
mod blend;
mod levels;
mod memory;
mod parallax;
mod tangents;
mod write;

pub use bake::{Baked, BakedMaps};
pub use blend::Blended;
pub use levels::LevelMaps;

use crate::backend::Backend;
use crate::backend::cpu::{Cpu, Reference};
use crate::error::{Error, Result};
use crate::map::Size;
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
}

impl Ran {
    /// What ran it, as [`Baker::name`].
    pub fn name(&self) -> String {
        crate::backend::name(self.backend, &self.device)
    }
}

impl Baker {
    /// A real GPU if there is one that passes its self-test, else the CPU; [`Baker::reason`] tells why. On Linux no GPU is
    /// looked for where none has a driver in `/dev`, unless `VK_DRIVER_FILES` names drivers.
    ///
    /// The CPU takes over a job from its first row when the GPU
    /// - is lost, or has not answered for a minute;
    /// - has no memory for a single row, or no room for one: memory that is short, and buffers that are small, only
    ///   mean fewer rows at a time;
    /// - returns a row or a tangent that it did not compute: zeros, or what an earlier one left;
    /// - computes wrong bytes when the job's kernel is compared with the CPU, before its first use.
    ///
    /// The result is the same, and [`Ran::fallback`] has the reason. A GPU that was lost is not asked again.
    ///
    /// A dispatch that takes 50 ms or more is followed by smaller ones, down to one row: drivers reset a GPU that is
    /// busy for two seconds.
    pub fn auto() -> Self {
        #[cfg(feature = "gpu")]
        return Self::or_cpu(crate::backend::gpu::Gpu::open_real());
        #[cfg(not(feature = "gpu"))]
        Self { reason: "this build has no gpu feature".into(), ..Self::cpu() }
    }

    /// A GPU with the CPU to take over, or why there is only the CPU.
    #[cfg(feature = "gpu")]
    pub(crate) fn or_cpu(gpu: Result<crate::backend::gpu::Gpu, String>) -> Self {
        let Self { backend: cpu, .. } = Self::cpu();
        match gpu {
            Ok(gpu) => {
                let reason = "the first real GPU that passes its self-test".into();
                Self { backend: Arc::new(gpu), fallback: Some(cpu), reason }
            }
            Err(reason) => Self { backend: cpu, fallback: None, reason },
        }
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
    /// [`crate::Error::Device`] if there is none, or it fails its self-test; later, if it fails during a job, by any
    /// of what makes [`Baker::auto`] turn to the CPU.
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

    /// A backend that a test has prepared, with the CPU to take over or without.
    #[cfg(all(test, feature = "gpu"))]
    pub(crate) fn prepared(backend: Arc<dyn Backend>, falls_back: bool) -> Self {
        let fallback = falls_back.then(|| Self::cpu().backend);
        Self { backend, fallback, reason: "prepared".into() }
    }

    fn only(backend: impl Backend + 'static) -> Self {
        Self::on(Arc::new(backend))
    }

    /// This backend and nothing else.
    pub(crate) fn on(backend: Arc<dyn Backend>) -> Self {
        Self { backend, fallback: None, reason: "asked for".into() }
    }

    /// The GPU, if it is one, to compile other kernels for.
    #[cfg(feature = "gpu")]
    pub(crate) fn gpu_device(&self) -> Option<&crate::backend::gpu::Untested> {
        self.backend.gpu()
    }

    /// What runs: the backend and its device.
    pub fn name(&self) -> String {
        crate::backend::name(self.backend.kind(), &self.backend.device())
    }

    /// What decides over the bytes of [`Precision::Fast`](crate::Precision::Fast): where a job ran, or else would run.
    #[cfg(feature = "cli")]
    pub(crate) fn fast_device(&self, ran: Option<&Ran>) -> String {
        let fell_back = ran.is_some_and(|ran| ran.fallback.is_some());
        let fallback = self.fallback.as_ref().filter(|_| fell_back);
        fallback.unwrap_or(&self.backend).fast_device()
    }

    /// Why this backend was chosen.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// Runs a job, and runs it again on the fallback if the backend's device fails; then it says why.
    fn run<T>(&self, mut job: impl FnMut(&dyn Backend) -> Result<T>) -> Result<(Ran, T)> {
        let mut run_on = |backend: &dyn Backend, fallback| {
            let result = job(backend)?;
            Ok((Ran { backend: backend.kind(), device: backend.device(), fallback }, result))
        };
        match (run_on(self.backend.as_ref(), None), &self.fallback) {
            (Err(Error::Device { adapter, reason }), Some(fallback)) => {
                run_on(fallback.as_ref(), Some(format!("{adapter}: {reason}")))
            }
            (result, _) => result,
        }
    }
}

/// Fails unless a map has the size of the first.
fn check_same_size(parameter: &'static str, size: Size, wanted: Size) -> Result<()> {
    if size == wanted {
        Ok(())
    } else {
        Err(Error::parameter(parameter, size, format!("{wanted}, as the first map's")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backend::{RowBytes, fill_rows};
    use crate::map::{CodesMut, Grid, HeightMap};
    use crate::ops::bake::{BakePlan, NormalOptions};
    use crate::ops::blend::BlendPlan;
    use crate::ops::parallax::ParallaxPlan;
    use crate::ops::tangents::TangentPlan;
    use crate::stream::{CodeSink, HeightBands, LayerBands};

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

        fn tangents(&self, _: &TangentPlan<'_>, _: &mut [[f32; 4]]) -> Result<()> {
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
