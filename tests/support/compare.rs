//! The one comparison of codes that every test uses.

use half::f16;
use std::fmt::{Display, Write};
use texbake::{CodesRef, Depth, Encoding, NormalFormat, NormalMap, Size};

/// The stored bits of each code of a normal map; -0.0 is not 0.0 here.
#[derive(Debug, Clone)]
pub struct Image {
    pub size: Size,
    pub format: NormalFormat,
    pub bits: Vec<u32>,
}

impl From<&NormalMap> for Image {
    fn from(map: &NormalMap) -> Self {
        let bits = match map.codes() {
            CodesRef::U8(codes) => codes.iter().map(|&code| code.into()).collect(),
            CodesRef::U16(codes) => codes.iter().map(|&code| code.into()).collect(),
            CodesRef::F16(codes) => codes.iter().map(|code| code.to_bits().into()).collect(),
            CodesRef::F32(codes) => codes.iter().map(|code| code.to_bits()).collect(),
        };
        Self { size: map.size(), format: map.format(), bits }
    }
}

impl Image {
    /// A code as the number that it stores.
    pub fn number(&self, index: usize) -> f64 {
        let bits = self.bits[index];
        match (self.format.encoding, self.format.depth) {
            (_, Depth::Float16) => f16::from_bits(bits as u16).to_f64(),
            (_, Depth::Float32) => f32::from_bits(bits).into(),
            (Encoding::Snorm, Depth::Bits8) => (bits as u8 as i8).into(),
            (Encoding::Snorm, Depth::Bits16) => (bits as u16 as i16).into(),
            _ => bits.into(),
        }
    }

    /// The numbers of the texel in column `x`, row `y`.
    pub fn texel(&self, x: usize, y: usize) -> Vec<f64> {
        let channels = self.format.channels.count();
        let first = (y * self.size.width() + x) * channels;
        (first..first + channels).map(|index| self.number(index)).collect()
    }
}

const SHOWN: usize = 8;

/// The first codes that differ, in words; nothing compared is a difference too.
pub fn differences(got: &Image, expected: &Image) -> Result<(), String> {
    let shape = |image: &Image| (image.size, image.format, image.bits.len());
    if shape(got) != shape(expected) {
        return Err(format!("got a map of {:?}, expected {:?}", shape(got), shape(expected)));
    }
    let (width, channels) = (expected.size.width(), expected.format.channels.count());
    if expected.bits.is_empty() || expected.bits.len() != expected.size.texels() * channels {
        return Err(format!("{} codes of {} x {channels} were compared", expected.bits.len(), expected.size));
    }
    let differ: Vec<usize> = (0..got.bits.len()).filter(|&i| got.bits[i] != expected.bits[i]).collect();
    if differ.is_empty() {
        return Ok(());
    }
    let mut report = format!("{} of {} codes differ", differ.len(), got.bits.len());
    for &i in differ.iter().take(SHOWN) {
        let (texel, channel) = (i / channels, ["x", "y", "z"][i % channels]);
        let (column, row) = (texel % width, texel / width);
        let (got_number, expected_number) = (got.number(i), expected.number(i));
        write!(
            report,
            "\n  column {column}, row {row}, {channel}: got {got_number} ({:#x}), expected {expected_number} ({:#x})",
            got.bits[i], expected.bits[i]
        )
        .expect("a string takes text");
    }
    Err(report)
}

/// Fails the test with the first codes that differ.
pub fn assert_same(what: impl Display, got: &Image, expected: &Image) {
    if let Err(report) = differences(got, expected) {
        panic!("{what}: {report}");
    }
}
