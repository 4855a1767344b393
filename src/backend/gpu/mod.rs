//! The GPU, through wgpu.

mod adapters;
mod bake;
mod blend;
mod device;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod fused;
mod hosted;
mod input;
mod kernel;
#[cfg(test)]
mod layer_tests;
mod layers;
mod lock;
mod mesh_parts;
mod operation;
mod output;
mod own_kernel;
mod pace;
mod parallax;
pub(crate) mod recording;
#[cfg(test)]
mod recording_tests;
#[cfg(test)]
mod reflection;
mod self_test;
mod slot;
#[cfg(test)]
mod soft_float_tests;
#[cfg(test)]
mod tangent_tests;
mod tangents;
mod tangents_self_test;
mod transfer;
mod variants;

use crate::backend::{Backend, RowBytes};
use crate::error::{Error, Result};
use crate::ops::bake::BakePlan;
use crate::ops::blend::BlendPlan;
use crate::ops::parallax::ParallaxPlan;
use crate::ops::tangents::TangentPlan;
use crate::stream::{CodeSink, HeightBands, LayerBands};
use device::Device;
pub use hosted::{CodeTarget, HeightSource, Hosted, NormalBake};
use layers::LayerOperation;
use operation::{Doubt, Operation, greatest_row_bytes, row_groups};
pub use own_kernel::Binding;
pub(crate) use own_kernel::OwnPipeline;
use std::panic::{AssertUnwindSafe, catch_unwind};
use tangents::Limits;
pub use variants::{KernelVariant, kernels};

/// A GPU that runs whatever it is given, and may compute wrong bytes.
pub(crate) struct Untested {
    device: Device,
}

/// A GPU that has passed its self-test, and tests each kernel before its first job.
pub(crate) struct Gpu {
    untested: Untested,
}

/// Codes of a band stay near this many bytes: enough to fill a GPU, little enough to stay far below a driver's
/// patience with one dispatch.
const BAND_BYTES: usize = 8 << 20;

impl Untested {
    /// Opens the adapter that `selector` means, or the best one.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if there is none, or it does not open.
    pub fn open(selector: Option<&str>) -> Result<Self> {
        Self::open_adapter(&adapters::select(selector)?)
    }

    /// Every adapter that `selector` means, or every one, the best first, or why it does not open.
    pub fn all(selector: Option<&str>) -> Vec<Result<Self>> {
        adapters::meant(selector).iter().map(Self::open_adapter).collect()
    }

    /// Compiles a kernel of somebody else's.
    ///
    /// # Errors
    /// [`crate::Error::Device`] with what the compiler says.
    pub fn compile(&self, wgsl: &str, entry_point: &str, constants: &[(&str, f64)]) -> Result<OwnPipeline<'_>> {
        OwnPipeline::new(&self.device, wgsl, entry_point, constants)
    }

    /// Whether a sampler of it filters textures of f32.
    #[cfg(feature = "cli")]
    pub fn filters_floats(&self) -> bool {
        self.device.device.features().contains(wgpu::Features::FLOAT32_FILTERABLE)
    }

    /// A device that somebody else has opened.
    pub fn hosted(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let name = adapters::describe(&device.adapter_info());
        Self { device: Device::new(name, device.clone(), queue.clone()) }
    }

    /// Drops what was compiled.
    pub fn forget_kernels(&self) {
        self.device.forget_kernels();
    }

    /// Runs other texts in place of the kernels' own.
    pub fn replace_kernels(&self, text: impl Fn(&str) -> String) {
        sources().iter().for_each(|source| self.device.substitute(*source, &text(&source.text())));
    }

    fn open_adapter(adapter: &wgpu::Adapter) -> Result<Self> {
        // A driver that panics is as good as none.
        let opened = catch_unwind(AssertUnwindSafe(|| Device::open(adapter))).unwrap_or_else(|panic| {
            let name = adapters::describe(&adapter.get_info());
            Err(Error::device(name, format_args!("wgpu failed: {}", device::panic_text(panic.as_ref()))))
        });
        Ok(Self { device: opened? })
    }

    /// Refuses rows that this device cannot take.
    fn check_width(&self, operation: &impl Operation) -> Result<()> {
        let width = operation.width();
        let (bytes, greatest_binding) = (greatest_row_bytes(operation), self.device.greatest_binding());
        if bytes > greatest_binding {
            return Err(self.device.error(format_args!(
                "rows of {width} texels are too wide for it: {bytes} bytes in a buffer of at most {greatest_binding}"
            )));
        }
        let (groups, greatest_dispatch) = (row_groups(width), self.device.greatest_dispatch());
        if groups > greatest_dispatch {
            return Err(self.device.error(format_args!(
                "rows of {width} texels are too wide for it: {groups} workgroups where {greatest_dispatch} are allowed"
            )));
        }
        Ok(())
    }

    fn run_layers(
        &self,
        plan: &impl LayerOperation,
        bands: &mut dyn LayerBands,
        sink: &mut dyn CodeSink,
    ) -> Result<()> {
        self.check_width(plan)?;
        layers::run(&self.device, plan, Doubt::Near, bands, &mut [sink])
    }
}

impl Backend for Untested {
    fn kind(&self) -> &'static str {
        "gpu"
    }

    fn device(&self) -> String {
        self.device.name.clone()
    }

    fn band_rows(&self, row: RowBytes) -> usize {
        (BAND_BYTES / row.read.max(row.written)).max(1)
    }

    /// The buffers of the bands in flight, the host's and the device's, which a software device has in the same memory.
    fn held_bytes(&self, row: RowBytes) -> u64 {
        let rows = self.band_rows(row) + 2;
        (transfer::RING * 2 * rows * (row.read + row.written)) as u64
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        self.check_width(plan)?;
        bake::run(&self.device, plan, Doubt::Near, bands, sinks)
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        self.run_layers(plan, bands, sink)
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        self.run_layers(plan, bands, sink)
    }

    fn tangents(&self, plan: &TangentPlan<'_>, out: &mut [[f32; 4]]) -> Result<()> {
        tangents::run(&self.device, plan, Limits::of(&self.device), out)
    }
}

impl Gpu {
    /// Opens the adapter that `selector` means, or the best one, and tests it.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if there is none, or it does not open, or it computes wrong bytes.
    pub fn open(selector: Option<&str>) -> Result<Self> {
        Self::tested(Untested::open(selector)?)
    }

    /// Opens the first real GPU that passes its self-test; else says why there is none.
    pub fn open_real() -> Result<Self, String> {
        if !adapters::can_be_real() {
            return Err("no real GPU: no driver of one is loaded".into());
        }
        let mut reasons = Vec::new();
        for adapter in adapters::primary() {
            let info = adapter.get_info();
            if !adapters::is_candidate(&info) {
                reasons.push(format!("{} is {}", adapters::describe(&info), adapters::kind(&info)));
                continue;
            }
            match Untested::open_adapter(&adapter).and_then(Self::tested) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => reasons.push(error.to_string()),
            }
        }
        let found = if reasons.is_empty() { "none found".into() } else { reasons.join("; ") };
        Err(format!("no real GPU: {found}"))
    }

    /// The device, for other kernels than its own.
    #[cfg(feature = "cli")]
    pub fn untested(&self) -> &Untested {
        &self.untested
    }

    fn tested(untested: Untested) -> Result<Self> {
        self_test::run(&untested.device)?;
        Ok(Self { untested })
    }

    /// Refuses rows that this device cannot take, and a kernel that computes wrong bytes; each kernel is tested once.
    fn accept_bake(&self, plan: &BakePlan) -> Result<()> {
        self.untested.check_width(plan)?;
        self_test::accept_bake(&self.untested.device, plan)
    }
}

impl Backend for Gpu {
    fn kind(&self) -> &'static str {
        self.untested.kind()
    }

    fn device(&self) -> String {
        self.untested.device()
    }

    fn band_rows(&self, row: RowBytes) -> usize {
        self.untested.band_rows(row)
    }

    fn held_bytes(&self, row: RowBytes) -> u64 {
        self.untested.held_bytes(row)
    }

    fn bake(&self, plan: &BakePlan, bands: &mut dyn HeightBands, sinks: &mut [&mut dyn CodeSink]) -> Result<()> {
        self.accept_bake(plan)?;
        self.untested.bake(plan, bands, sinks)
    }

    fn blend(&self, plan: &BlendPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        layers::accept(&self.untested.device, plan)?;
        self.untested.blend(plan, bands, sink)
    }

    fn parallax(&self, plan: &ParallaxPlan, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()> {
        layers::accept(&self.untested.device, plan)?;
        self.untested.parallax(plan, bands, sink)
    }

    fn tangents(&self, plan: &TangentPlan<'_>, out: &mut [[f32; 4]]) -> Result<()> {
        tangents_self_test::accept(&self.untested.device, plan)?;
        self.untested.tangents(plan, out)
    }

    fn gpu(&self) -> Option<&Untested> {
        Some(&self.untested)
    }
}

/// Every kernel's text.
pub(crate) fn sources() -> &'static [kernel::KernelSource] {
    &kernel::ALL
}

/// All adapters, each opened and tested, in the order in which `auto` would choose.
pub(crate) fn devices() -> Vec<crate::Device> {
    let mut picked_one = false;
    let describe = |adapter: wgpu::Adapter| {
        let info = adapter.get_info();
        let self_test =
            Untested::open_adapter(&adapter).and_then(Gpu::tested).map(drop).map_err(|error| error.to_string());
        let candidate = adapters::is_candidate(&info);
        let picked = candidate && self_test.is_ok() && !picked_one;
        picked_one |= picked;
        let reason = match (picked, candidate, self_test.is_ok()) {
            (true, ..) => "the first real GPU that passes its self-test",
            (_, false, _) if adapters::is_real(&info) => "OpenGL is used only when it is named",
            (_, false, _) => "software is used only when it is named",
            (.., false) => "it cannot be used",
            _ => "another GPU comes first",
        };
        crate::Device {
            api: adapters::api(&info).into(),
            kind: adapters::kind(&info).into(),
            driver: [info.driver.as_str(), &info.driver_info].join(" ").trim().into(),
            name: info.name,
            self_test,
            picked,
            reason: reason.into(),
        }
    };
    adapters::all().into_iter().map(describe).collect()
}
