//! Known-answer tests: a device that computes other bytes than the specification is not used.

use super::device::Device;
use super::normal;
use super::transfer::Transfer;
use crate::backend::Backend;
use crate::backend::cpu::Reference;
use crate::error::Result;
use crate::exact::{Rational, Scale};
use crate::map::{Depth, Encoding, Grid, HeightMap, HeightType, NormalFormat, NormalMap};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, Filter, NormalOptions};
use crate::stream::{MapBands, MapSink};

const WIDTH: usize = 67;
const HEIGHT: usize = 16;

/// At device open: small maps through each arithmetic.
pub(super) fn run(device: &Device) -> Result<()> {
    for (heights, options) in cases()? {
        let map = noise(heights)?;
        test(device, &map, &BakePlan::new(&options.into(), map.size(), heights)?)?;
    }
    Ok(())
}

/// Before a plan's first bake: a small map with the plan's own options, once for each kernel.
pub(super) fn accept(device: &Device, plan: &BakePlan) -> Result<()> {
    if plan.precision == Precision::Exact && !device.is_tested(&Transfer::kernel(plan)) {
        let map = noise(plan.height_type)?;
        test(device, &map, &BakePlan { size: map.size(), ..*plan })?;
    }
    Ok(())
}

/// Bakes a map on the device and by the reference; the device remembers a kernel that passes.
fn test(device: &Device, map: &HeightMap, plan: &BakePlan) -> Result<()> {
    let row_codes = normal::format(plan).texel().row_codes(plan.size.width());
    let mut normal = NormalMap::zeroed(plan.size, normal::format(plan));
    let mut expected = normal.clone();
    let bands = || MapBands::new(map, plan.edges.y, HEIGHT / 2);
    Transfer::new(device, plan)?.run(&mut bands(), &mut MapSink::new(normal.codes_mut(), row_codes))?;
    Reference.bake(plan, &mut bands(), &mut [&mut MapSink::new(expected.codes_mut(), row_codes)])?;
    if normal == expected {
        device.set_tested(Transfer::kernel(plan));
        return Ok(());
    }
    let (heights, NormalFormat { encoding, depth, .. }) = (map.height_type(), normal::format(plan));
    let reason = format!("it fails the self-test: wrong {encoding} codes of {depth} bits for {heights} heights");
    Err(device.error(reason))
}

/// Noise of a height type; floats of every exponent and both signs, subnormals included.
fn noise(height_type: HeightType) -> Result<HeightMap> {
    let bits = |x: usize, y: usize| scrambled((y * WIDTH + x) as u32);
    Ok(match height_type {
        HeightType::U8 => Grid::from_fn(WIDTH, HEIGHT, |x, y| (bits(x, y) >> 24) as u8)?.into(),
        HeightType::U16 => Grid::from_fn(WIDTH, HEIGHT, |x, y| (bits(x, y) >> 16) as u16)?.into(),
        // The mask leaves out infinities and NaN.
        HeightType::F32 => Grid::from_fn(WIDTH, HEIGHT, |x, y| f32::from_bits(bits(x, y) & 0xff7f_ffff))?.try_into()?,
    })
}

/// Narrow and wide integers to codes, wide integers to floats, floats.
fn cases() -> Result<[(HeightType, NormalOptions); 4]> {
    let format = |encoding, depth| NormalFormat { encoding, depth, ..Default::default() };
    // Odd parts as long as allowed: every limb is in use.
    let steep = Scale::texels(Rational::new(16_777_213, 9_699_691)?);
    let options = |filter, format| NormalOptions { scale: steep, filter, format, ..Default::default() };
    Ok([
        (HeightType::U8, NormalOptions { scale: Scale::texels(24), ..Default::default() }),
        (HeightType::U16, options(Filter::Scharr, format(Encoding::Unorm, Depth::Bits16))),
        (HeightType::U16, options(Filter::Central, format(Encoding::Float, Depth::Float32))),
        (HeightType::F32, options(Filter::Sobel, format(Encoding::Float, Depth::Float32))),
    ])
}

/// A number without pattern for each index (the finaliser of MurmurHash3, public domain).
fn scrambled(index: u32) -> u32 {
    let a = (index ^ (index >> 16)).wrapping_add(1).wrapping_mul(0x85eb_ca6b);
    let b = (a ^ (a >> 13)).wrapping_mul(0xc2b2_ae35);
    b ^ (b >> 16)
}
