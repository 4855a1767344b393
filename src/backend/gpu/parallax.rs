//! The parallax kernel's host side: which text, which constants, which parameters.

use super::device::Device;
use crate::error::Result;
use crate::ops::parallax::ParallaxPlan;
use crate::stream::{CodeSink, LayerBands};

/// Bakes all bands on a device, untested.
pub(super) fn run(
    device: &Device,
    _: &ParallaxPlan,
    _: &mut dyn LayerBands,
    _: &mut [&mut dyn CodeSink],
) -> Result<()> {
    Err(device.error("it bakes no parallax maps from normals yet"))
}
