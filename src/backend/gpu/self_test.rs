//! A known-answer test at device open: a driver that computes other bytes than the specification is not used.

use super::Gpu;
use crate::backend::Backend;
use crate::backend::cpu::Reference;
use crate::error::Result;
use crate::exact::Scale;
use crate::map::{Depth, Encoding, Grid, HeightMap, NormalFormat, NormalMap};
use crate::ops::normal::{Filter, NormalOptions, NormalPlan};
use crate::stream::{MapBands, MapSink};

/// Bakes small maps through each exact kernel and compares with the reference.
pub(super) fn run(gpu: &Gpu) -> Result<()> {
    for (map, options) in cases()? {
        let plan = NormalPlan::new(&options, map.size(), map.depth())?;
        if bake(gpu, &map, &plan)? != bake(&Reference, &map, &plan)? {
            let reason = format!("it fails the self-test: wrong codes for {} heights", map.depth());
            return Err(gpu.device.error(reason));
        }
    }
    Ok(())
}

/// A map for each exact way: narrow and wide integers to codes, wide integers to floats, floats.
fn cases() -> Result<[(HeightMap, NormalOptions); 4]> {
    const WIDTH: usize = 67;
    const HEIGHT: usize = 16;
    let noise = |x: usize, y: usize| scrambled((y * WIDTH + x) as u32);
    let bytes = Grid::from_fn(WIDTH, HEIGHT, |x, y| (noise(x, y) >> 24) as u8)?;
    let integers = Grid::from_fn(WIDTH, HEIGHT, |x, y| (noise(x, y) >> 16) as u16)?;
    let floats = Grid::from_fn(WIDTH, HEIGHT, |x, y| {
        // Every exponent and both signs, subnormals included, infinities and NaN not.
        f32::from_bits(noise(x, y) & 0xff7f_ffff)
    })?;
    let format = |encoding, depth| NormalFormat { encoding, depth, ..Default::default() };
    // Odd parts as long as allowed: every limb is in use.
    let steep = Scale::texels(crate::exact::Rational::new(16_777_213, 9_699_691)?);
    let options = |filter, format| NormalOptions { scale: steep, filter, format, ..Default::default() };
    Ok([
        (bytes.into(), NormalOptions { scale: Scale::texels(24), ..Default::default() }),
        (integers.clone().into(), options(Filter::Scharr, format(Encoding::Unorm, Depth::Bits16))),
        (integers.into(), options(Filter::Central, format(Encoding::Float, Depth::Float32))),
        (floats.try_into()?, options(Filter::Sobel, format(Encoding::Float, Depth::Float32))),
    ])
}

fn bake(backend: &dyn Backend, map: &HeightMap, plan: &NormalPlan) -> Result<NormalMap> {
    let mut normal = NormalMap::zeroed(plan.size, plan.format);
    let mut bands = MapBands::new(map, plan.edges.y, plan.size.height());
    backend.normal(plan, &mut bands, &mut MapSink::new(normal.codes_mut(), plan.row_codes()))?;
    Ok(normal)
}

/// A number without pattern for each index (the finaliser of MurmurHash3, public domain).
fn scrambled(index: u32) -> u32 {
    let a = (index ^ (index >> 16)).wrapping_add(1).wrapping_mul(0x85eb_ca6b);
    let b = (a ^ (a >> 13)).wrapping_mul(0xc2b2_ae35);
    b ^ (b >> 16)
}
