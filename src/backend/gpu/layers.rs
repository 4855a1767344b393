//! Operations on several maps that lie over each other: how they run, and their known-answer test.

use super::device::Device;
use super::input::input_bits;
use super::operation::{Doubt, Layer, Operation, row_bytes};
use super::self_test::{By, HEIGHT, WIDTH, scrambled, test};
use super::transfer::Transfer;
use crate::error::Result;
use crate::map::{Codes, CodesRef, Depth, Size, TexelFormat};
use crate::ops::Precision;
use crate::stream::{CodeSink, LayerBand, LayerBands, MapLayers};
use half::f16;
use std::ops::Range;

/// An operation on several maps.
pub(super) trait LayerOperation: Operation + Sized {
    /// How each layer is stored before it is sent.
    fn layers(&self) -> Vec<TexelFormat>;

    /// Whether bytes are promised.
    fn precision(&self) -> Precision;

    /// The same on maps of another size.
    fn of_size(&self, size: Size) -> Self;

    /// The specification's codes.
    fn reference(&self, bands: &mut dyn LayerBands, sink: &mut dyn CodeSink) -> Result<()>;
}

/// Bytes of a row of each layer as it arrives.
pub(super) fn input_row_bytes(operation: &impl LayerOperation) -> Vec<usize> {
    let texel_bytes = |format: &TexelFormat| format.channels * input_bits(format.depth) as usize / 8;
    operation.layers().iter().map(|format| row_bytes(operation.width(), texel_bytes(format))).collect()
}

/// Runs all bands through a device, untested.
pub(super) fn run(
    device: &Device,
    operation: &impl LayerOperation,
    doubt: Doubt,
    bands: &mut dyn LayerBands,
    sinks: &mut [&mut dyn CodeSink],
) -> Result<()> {
    let mut transfer = Transfer::new(device, operation, doubt)?;
    while let Some(band) = bands.next()? {
        transfer.send(band.rows, |rows| layers(&band, rows), sinks)?;
    }
    transfer.finish(sinks)
}

/// Some rows of a band.
fn layers<'a>(band: &LayerBand<'a>, rows: Range<usize>) -> Vec<Layer<'a>> {
    let part = |codes: &CodesRef<'a>| {
        let row_codes = codes.len() / band.rows;
        Layer { rows: rows.len(), codes: codes.slice(rows.start * row_codes..rows.end * row_codes) }
    };
    band.layers.iter().map(part).collect()
}

/// Before an operation's first run: small maps with its own options, once for each kernel.
pub(super) fn accept(device: &Device, operation: &impl LayerOperation) -> Result<()> {
    if operation.precision() == Precision::Fast || device.is_tested(&operation.kernel()) {
        return Ok(());
    }
    compare(device, operation, Size::new(WIDTH, HEIGHT)?, HEIGHT / 2)
}

/// Runs an operation on noise of `size`, on the device and by the reference.
pub(super) fn compare(device: &Device, operation: &impl LayerOperation, size: Size, band_rows: usize) -> Result<()> {
    let (operation, formats) = (operation.of_size(size), operation.layers());
    let maps: Vec<Codes> = formats.iter().zip(1..).map(|(format, seed)| noise(*format, size, seed)).collect();
    let bands = || MapLayers::new(maps.iter().map(Codes::as_ref).collect(), size.height(), band_rows);
    let inputs = formats.iter().map(|format| format!("{} codes of {} bits", format.encoding, format.depth));
    test(device, &operation, size, &inputs.collect::<Vec<_>>().join(" and "), |by| match by {
        By::Device(doubt, sinks) => run(device, &operation, doubt, &mut bands(), sinks),
        By::Reference(sinks) => operation.reference(&mut bands(), sinks[0]),
    })
}

/// Noise of a format; floats of both signs, from 2^-30 to 4 or, of 16 bits, of every exponent.
pub(super) fn noise(format: TexelFormat, size: Size, seed: u32) -> Codes {
    let count = (size.texels() * format.channels) as u32;
    let bits = (0..count).map(|index| scrambled(seed * count + index));
    match format.depth {
        Depth::Bits8 => Codes::U8(bits.map(|bits| (bits >> 24) as u8).collect()),
        Depth::Bits16 => Codes::U16(bits.map(|bits| (bits >> 16) as u16).collect()),
        // The mask leaves out infinities and NaN.
        Depth::Float16 => Codes::F16(bits.map(|bits| f16::from_bits((bits >> 16) as u16 & 0xfbff)).collect()),
        Depth::Float32 => {
            let float = |bits: u32| f32::from_bits((bits & 0x807f_ffff) | ((97 + (bits >> 23) % 32) << 23));
            Codes::F32(bits.map(float).collect())
        }
    }
}
