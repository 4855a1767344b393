//! The GPU, through wgpu.

mod adapters;
mod device;
mod kernel;
mod normal;
mod self_test;
mod transfer;

use crate::backend::Backend;
use crate::error::{Error, Result};
use crate::ops::normal::NormalPlan;
use crate::stream::{CodeSink, HeightBands};
use device::Device;
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
    /// [`Error::Device`] if there is none, or it does not open, or it computes wrong bytes.
    pub fn open(selector: Option<&str>) -> Result<Self> {
        Self::open_adapter(&adapters::select(selector)?)
    }

    fn open_adapter(adapter: &wgpu::Adapter) -> Result<Self> {
        let gpu = Self { device: Device::open(adapter)? };
        self_test::run(&gpu)?;
        Ok(gpu)
    }
}

impl Backend for Gpu {
    fn name(&self) -> String {
        format!("gpu, {}", self.device.name)
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
