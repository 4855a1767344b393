//! The GPU, through wgpu.

mod adapters;
mod device;
mod hosted;
mod kernel;
mod normal;
#[cfg(test)]
mod reflection;
mod self_test;
mod transfer;

use crate::backend::Backend;
use crate::error::Result;
use crate::ops::normal::NormalPlan;
use crate::stream::{CodeSink, HeightBands};
use device::Device;
pub use hosted::{Codes, Heights, Hosted, NormalBake};
use std::panic::{AssertUnwindSafe, catch_unwind};
use transfer::Transfer;

/// A GPU that has passed its self-test.
pub(crate) struct Gpu {
    device: Device,
}

/// Codes of a band stay near this many bytes: enough to fill a GPU, little enough to stay far below a driver's
/// patience with one dispatch.
const BAND_BYTES: usize = 8 << 20;

/// The most workgroups of one dispatch in each dimension, on every WebGPU device.
const GREATEST_DISPATCH: usize = 65_535;

impl Gpu {
    /// Opens the adapter that `selector` means, or the best one, and tests it.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if there is none, or it does not open, or it computes wrong bytes.
    pub fn open(selector: Option<&str>) -> Result<Self> {
        Self::open_adapter(&adapters::select(selector)?)
    }

    /// Opens the first real GPU that passes its self-test; else says why there is none.
    pub fn open_real() -> Result<Self, String> {
        let mut reasons = Vec::new();
        for adapter in adapters::primary() {
            let info = adapter.get_info();
            if !adapters::is_real(&info) {
                reasons.push(format!("{} is {}", adapters::describe(&info), adapters::kind(&info)));
                continue;
            }
            match Self::open_adapter(&adapter) {
                Ok(gpu) => return Ok(gpu),
                Err(error) => reasons.push(error.to_string()),
            }
        }
        let found = if reasons.is_empty() { "none found".into() } else { reasons.join("; ") };
        Err(format!("no real GPU: {found}"))
    }

    fn open_adapter(adapter: &wgpu::Adapter) -> Result<Self> {
        let gpu = Self { device: Device::open(adapter)? };
        self_test::run(&gpu)?;
        Ok(gpu)
    }
}

impl Backend for Gpu {
    fn kind(&self) -> &'static str {
        "gpu"
    }

    fn device(&self) -> String {
        self.device.name.clone()
    }

    fn band_rows(&self, plan: &NormalPlan) -> usize {
        let row_bytes = plan.row_codes() * plan.format.depth.bytes();
        (BAND_BYTES / row_bytes).clamp(1, GREATEST_DISPATCH)
    }

    fn normal(&self, plan: &NormalPlan, bands: &mut dyn HeightBands, sink: &mut dyn CodeSink) -> Result<()> {
        // The widest rows: 16 bytes of codes for a texel, and a halo above and below one row of heights.
        if 4 * plan.row_codes() * plan.format.depth.bytes() > self.device.greatest_binding() {
            return Err(self.device.error(format_args!("rows of {} texels exceed its buffers", plan.size.width())));
        }
        // wgpu may panic when a device is lost (gfx-rs/wgpu: poll on a lost device); a lost device is not our bug.
        catch_unwind(AssertUnwindSafe(|| Transfer::new(&self.device, plan).run(bands, sink))).unwrap_or_else(|_| {
            Err(self.device.check().err().unwrap_or_else(|| self.device.error("the driver failed")))
        })
    }
}

/// All adapters, each opened and tested, in the order in which `auto` would choose.
pub(crate) fn devices() -> Vec<crate::Device> {
    let mut picked_one = false;
    let describe = |adapter: wgpu::Adapter| {
        let info = adapter.get_info();
        let self_test = catch_unwind(AssertUnwindSafe(|| Gpu::open_adapter(&adapter).map(drop)))
            .unwrap_or_else(|_| Err(crate::Error::device(adapters::describe(&info), "the driver failed")))
            .map_err(|error| error.to_string());
        let considered = adapters::is_real(&info) && info.backend != wgpu::Backend::Gl;
        let picked = considered && self_test.is_ok() && !picked_one;
        picked_one |= picked;
        let reason = match (picked, considered, self_test.is_ok()) {
            (true, ..) => "the first real GPU that passes its self-test",
            (_, false, _) if adapters::is_real(&info) => "OpenGL is used only when it is named",
            (_, false, _) => "software is used only when it is named",
            (.., false) => "it fails its self-test",
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
