//! The one comparison of codes that every test uses.

use half::f16;
use std::fmt::{Debug, Display, Write};
use texbake::{CodeMap, CodesRef, Depth, Encoding, MapFormat, NormalFormat, ParallaxFormat, Size};

/// What a comparison knows of a format.
pub trait Format: MapFormat + PartialEq + Debug {
    /// How a code is stored.
    fn code(&self) -> (Encoding, Depth);
    /// What the codes of a texel are called.
    fn channels(&self) -> &'static [&'static str];
}

impl Format for NormalFormat {
    fn code(&self) -> (Encoding, Depth) {
        (self.encoding, self.depth)
    }

    fn channels(&self) -> &'static [&'static str] {
        &["x", "y", "z"][..self.channels.count()]
    }
}

impl Format for ParallaxFormat {
    fn code(&self) -> (Encoding, Depth) {
        (self.encoding, self.depth)
    }

    fn channels(&self) -> &'static [&'static str] {
        &["parallax"]
    }
}

/// The stored bits of each code of a map; -0.0 is not 0.0 here.
#[derive(Debug, Clone)]
pub struct Image<F = NormalFormat> {
    pub size: Size,
    pub format: F,
    pub bits: Vec<u32>,
}

impl<F: Format> From<&CodeMap<F>> for Image<F> {
    fn from(map: &CodeMap<F>) -> Self {
        let bits = match map.codes() {
            CodesRef::U8(codes) => codes.iter().map(|&code| code.into()).collect(),
            CodesRef::U16(codes) => codes.iter().map(|&code| code.into()).collect(),
            CodesRef::F16(codes) => codes.iter().map(|code| code.to_bits().into()).collect(),
            CodesRef::F32(codes) => codes.iter().map(|code| code.to_bits()).collect(),
        };
        Self { size: map.size(), format: map.format(), bits }
    }
}

impl<F: Format> Image<F> {
    /// A code as the number that it stores.
    pub fn number(&self, index: usize) -> f64 {
        let bits = self.bits[index];
        match self.format.code() {
            (_, Depth::Float16) => f16::from_bits(bits as u16).to_f64(),
            (_, Depth::Float32) => f32::from_bits(bits).into(),
            (Encoding::Snorm, Depth::Bits8) => (bits as u8 as i8).into(),
            (Encoding::Snorm, Depth::Bits16) => (bits as u16 as i16).into(),
            _ => bits.into(),
        }
    }

    /// The numbers of the texel in column `x`, row `y`.
    pub fn texel(&self, x: usize, y: usize) -> Vec<f64> {
        let channels = self.format.channels().len();
        let first = (y * self.size.width() + x) * channels;
        (first..first + channels).map(|index| self.number(index)).collect()
    }
}

const SHOWN: usize = 8;

/// The first codes that differ, in words; nothing compared is a difference too.
pub fn differences<F: Format>(got: &Image<F>, expected: &Image<F>) -> Result<(), String> {
    let shape = |image: &Image<F>| (image.size, image.format, image.bits.len());
    if shape(got) != shape(expected) {
        return Err(format!("got a map of {:?}, expected {:?}", shape(got), shape(expected)));
    }
    let names = expected.format.channels();
    let (width, channels) = (expected.size.width(), names.len());
    if expected.bits.is_empty() || expected.bits.len() != expected.size.texels() * channels {
        return Err(format!("{} codes of {} x {channels} were compared", expected.bits.len(), expected.size));
    }
    let differ: Vec<usize> = (0..got.bits.len()).filter(|&i| got.bits[i] != expected.bits[i]).collect();
    if differ.is_empty() {
        return Ok(());
    }
    let mut report = format!("{} of {} codes differ", differ.len(), got.bits.len());
    for &i in differ.iter().take(SHOWN) {
        let (texel, channel) = (i / channels, names[i % channels]);
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
pub fn assert_same<F: Format>(what: impl Display, got: &Image<F>, expected: &Image<F>) {
    if let Err(report) = differences(got, expected) {
        panic!("{what}: {report}");
    }
}
