//! Known-answer tests: a device that computes other bytes than the specification is not used.

use super::bake;
use super::device::Device;
use super::operation::{Doubt, Operation};
use crate::backend::Backend;
use crate::backend::cpu::Reference;
use crate::error::Result;
use crate::exact::{Rational, Scale};
use crate::map::{Codes, Depth, Encoding, Grid, HeightMap, HeightType, NormalFormat, Size};
use crate::ops::Precision;
use crate::ops::bake::{BakePlan, Filter, NormalOptions};
use crate::stream::{CodeSink, MapBands, MapSink};

pub(super) const WIDTH: usize = 67;
pub(super) const HEIGHT: usize = 16;

/// At device open: small maps through each arithmetic.
pub(super) fn run(device: &Device) -> Result<()> {
    for (heights, options) in cases()? {
        let map = noise(heights)?;
        test_bake(device, &map, &BakePlan::new(&options.into(), map.size(), heights)?)?;
    }
    Ok(())
}

/// Before a plan's first bake: a small map with the plan's own options, once for each kernel.
pub(super) fn accept_bake(device: &Device, plan: &BakePlan) -> Result<()> {
    if plan.precision == Precision::Exact && !device.is_tested(&plan.kernel()) {
        let map = noise(plan.height_type)?;
        test_bake(device, &map, &BakePlan { size: map.size(), ..*plan })?;
    }
    Ok(())
}

fn test_bake(device: &Device, map: &HeightMap, plan: &BakePlan) -> Result<()> {
    let bands = || MapBands::new(map, plan.edges.y, HEIGHT / 2);
    test(device, plan, plan.size, &format!("{} heights", map.height_type()), |by| match by {
        By::Device(doubt, sinks) => bake::run(device, plan, doubt, &mut bands(), sinks),
        By::Reference(sinks) => Reference.bake(plan, &mut bands(), sinks),
    })
}

/// Who runs a test's job, and where its codes go.
pub(super) enum By<'a, 'b> {
    Device(Doubt, &'a mut [&'b mut dyn CodeSink]),
    Reference(&'a mut [&'b mut dyn CodeSink]),
}

/// Runs a job on maps of `size` on the device, as it is and with all codes decided by integers, and by the reference;
/// the device remembers a kernel that passes.
pub(super) fn test(
    device: &Device,
    operation: &impl Operation,
    size: Size,
    inputs: &str,
    job: impl Fn(By<'_, '_>) -> Result<()>,
) -> Result<()> {
    let expected = filled(operation, size, 0x5a, |sinks| job(By::Reference(sinks)))?;
    for doubt in [Doubt::Near, Doubt::Everywhere] {
        let got = filled(operation, size, 0xa5, |sinks| job(By::Device(doubt, sinks)))?;
        for ((got, expected), format) in got.iter().zip(&expected).zip(operation.outputs()) {
            if got.as_ref().bytes() != expected.as_ref().bytes() {
                let (encoding, depth) = (format.encoding, format.depth);
                let entry_point = operation.kernel().source.entry_point;
                return Err(device.error(format_args!(
                    "it fails the self-test: {entry_point}: wrong {encoding} codes of {depth} bits for {inputs}"
                )));
            }
        }
    }
    device.set_tested(operation.kernel());
    Ok(())
}

/// The codes of an operation's maps; `poison` is what stands there before.
fn filled(
    operation: &impl Operation,
    size: Size,
    poison: u8,
    fill: impl FnOnce(&mut [&mut dyn CodeSink]) -> Result<()>,
) -> Result<Vec<Codes>> {
    let formats = operation.outputs();
    let mut maps: Vec<Codes> =
        formats.iter().map(|format| Codes::zeroed(format.depth, size.texels() * format.channels)).collect();
    maps.iter_mut().for_each(|map| map.as_mut().bytes_mut().fill(poison));
    let whole = maps.iter_mut().zip(&formats);
    let mut sinks: Vec<MapSink<'_>> =
        whole.map(|(map, format)| MapSink::new(map.as_mut(), format.row_codes(size.width()))).collect();
    let mut sinks: Vec<&mut dyn CodeSink> = sinks.iter_mut().map(|sink| sink as &mut dyn CodeSink).collect();
    fill(&mut sinks)?;
    Ok(maps)
}

/// Noise of a height type: above of every height, floats of every exponent and both signs, subnormals included; below
/// in squares of four texels, flat inside, floats from -1 to 3, so that normals of any scale point up and lean.
pub(super) fn noise(height_type: HeightType) -> Result<HeightMap> {
    let is_flat = |y: usize| y >= HEIGHT / 2;
    let bits = |x: usize, y: usize| {
        let (x, y) = if is_flat(y) { (x / 4, y / 4 * 4) } else { (x, y) };
        scrambled((y * WIDTH + x) as u32)
    };
    Ok(match height_type {
        HeightType::U8 => Grid::from_fn(WIDTH, HEIGHT, |x, y| (bits(x, y) >> 24) as u8)?.into(),
        HeightType::U16 => Grid::from_fn(WIDTH, HEIGHT, |x, y| (bits(x, y) >> 16) as u16)?.into(),
        HeightType::F32 => Grid::from_fn(WIDTH, HEIGHT, |x, y| match is_flat(y) {
            true => (bits(x, y) >> 8) as f32 / 4_194_304.0 - 1.0,
            // The mask leaves out infinities and NaN.
            false => f32::from_bits(bits(x, y) & 0xff7f_ffff),
        })?
        .try_into()?,
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
pub(super) fn scrambled(index: u32) -> u32 {
    let a = (index ^ (index >> 16)).wrapping_add(1).wrapping_mul(0x85eb_ca6b);
    let b = (a ^ (a >> 13)).wrapping_mul(0xc2b2_ae35);
    b ^ (b >> 16)
}
