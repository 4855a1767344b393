//! The blend kernel's host side: which text, which constants, which parameters.

use super::device::Device;
use crate::error::Result;
use crate::ops::blend::BlendPlan;
use crate::stream::{CodeSink, LayerBands};

/// Blends all bands on a device, untested.
pub(super) fn run(device: &Device, _: &BlendPlan, _: &mut dyn LayerBands, _: &mut [&mut dyn CodeSink]) -> Result<()> {
    Err(device.error("it blends no maps yet"))
}
