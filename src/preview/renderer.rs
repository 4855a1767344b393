//! What takes a shot.

#[cfg(feature = "gpu")]
use super::gpu;
use super::shot::{Samples, Shot};
#[cfg(feature = "gpu")]
use crate::backend::gpu::Gpu;
use crate::error::{Error, Result};
use crate::stream::Monitor;
use std::sync::{Mutex, PoisonError};

/// What takes shots: the CPU, or a GPU by `kernels/preview.wgsl`.
///
/// Both do the same in plain f32, so that colours agree within a step or two of 8 bits, but for single samples at the edge
/// of what hides something.
pub struct Renderer {
    #[cfg(feature = "gpu")]
    gpu: Option<Gpu>,
    /// Whether the CPU takes over what the GPU cannot.
    #[cfg(feature = "gpu")]
    falls_back: bool,
    reason: String,
    /// Why the CPU took over, once it did.
    fallback: Mutex<Option<String>>,
    #[cfg(feature = "gpu")]
    wgsl: String,
}

impl Renderer {
    /// All cores.
    pub fn cpu() -> Self {
        Self {
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            falls_back: false,
            reason: "asked for".into(),
            fallback: Mutex::default(),
            #[cfg(feature = "gpu")]
            wgsl: gpu::WGSL.into(),
        }
    }

    /// A real GPU if there is one that passes its self-test, else the CPU, which also takes over if the GPU fails.
    pub fn auto() -> Self {
        #[cfg(feature = "gpu")]
        return match Gpu::open_real() {
            Ok(gpu) => {
                let reason = "the first real GPU that passes its self-test".into();
                Self { gpu: Some(gpu), falls_back: true, reason, ..Self::cpu() }
            }
            Err(reason) => Self { reason, ..Self::cpu() },
        };
        #[cfg(not(feature = "gpu"))]
        Self { reason: "this build has no gpu feature".into(), ..Self::cpu() }
    }

    /// One GPU and nothing else: the adapter whose description contains `adapter`, or the best one, as
    /// [`crate::Baker::gpu`].
    ///
    /// # Errors
    /// [`Error::Device`] if there is none, or it fails its self-test.
    pub fn gpu(adapter: Option<&str>) -> Result<Self> {
        #[cfg(feature = "gpu")]
        return Ok(Self { gpu: Some(Gpu::open(adapter)?), ..Self::cpu() });
        #[cfg(not(feature = "gpu"))]
        Err(Error::device(adapter.unwrap_or("gpu"), "this build has no gpu feature; use --backend cpu"))
    }

    /// The same with another text of the kernel: to see that a wrong one is noticed.
    #[cfg(feature = "gpu")]
    #[must_use]
    pub fn with_kernel(mut self, change: impl Fn(&str) -> String) -> Self {
        self.wgsl = change(&self.wgsl);
        self
    }

    /// What it is: `cpu`, or the adapter's name.
    pub fn name(&self) -> String {
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            use crate::backend::Backend;
            return crate::backend::name(gpu.kind(), &gpu.device());
        }
        crate::Baker::cpu().name()
    }

    /// Why this one was chosen.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// Why the CPU took a shot in place of the GPU, if it did.
    pub fn fallback(&self) -> Option<String> {
        self.fallback.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes a shot.
    ///
    /// # Errors
    /// [`Error::Parameter`] as [`Shot::on_cpu`]; [`Error::Device`] if a GPU fails for which the CPU does not take over, or maps that mirror are
    /// not of one size: [`Error::Cancelled`] if `monitor` says so.
    pub fn take(&self, shot: &Shot<'_>, monitor: &Monitor) -> Result<Samples> {
        shot.check()?;
        #[cfg(feature = "gpu")]
        if let Some(gpu) = &self.gpu {
            let taken = match gpu::can_take(shot) {
                true => gpu::take(gpu, shot, &self.wgsl, monitor),
                false => {
                    let reason = "it renders maps that mirror if all are of one size; use --backend cpu for these";
                    Err(Error::device(self.name(), reason))
                }
            };
            match taken {
                Err(error @ Error::Device { .. }) if self.falls_back => {
                    *self.fallback.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
                }
                taken => return taken,
            }
        }
        shot.on_cpu(monitor)
    }
}
