//! A normal map as an input: from the codes of a texel to its normal.

use super::bake::zero_below;
use crate::exact::CodeReading;
use crate::map::{Channels, CodesRef, Convention, NormalFormat};

/// x, y, z of a normal of any length above zero, z above zero too.
pub(crate) type Vector<T> = [T; 3];

/// How the texels of a normal map become normals, with green as another map has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LayerReading {
    /// `None` for floats.
    pub codes: Option<CodeReading>,
    pub channels: Channels,
    /// 1, or -1 to turn green around.
    pub green: i32,
}

/// Float components below this magnitude count as zero, as slopes do.
const SMALLEST: f32 = 1.0 / 33_554_432.0; // 2^-25

/// The least z of a float normal; z at or below zero, too, counts as this.
const LEAST_Z: f32 = 1.0 / 16_777_216.0; // 2^-24

impl LayerReading {
    /// Reads a map of `format`, and gives green as `convention` says.
    pub fn new(format: NormalFormat, convention: Convention) -> Self {
        let green = if format.convention == convention { 1 } else { -1 };
        Self { codes: CodeReading::new(format.texel()), channels: format.channels, green }
    }

    /// The normal of texel `index` as integers over L: of integer codes only.
    #[inline(always)]
    pub fn integers(&self, reading: &CodeReading, codes: CodesRef<'_>, index: usize) -> Vector<i32> {
        let at = index * self.channels.count();
        let component = |channel: usize| match codes {
            CodesRef::U8(codes) => reading.component(codes[at + channel].into()),
            CodesRef::U16(codes) => reading.component(codes[at + channel].into()),
            CodesRef::F16(_) | CodesRef::F32(_) => unreachable!("floats have no integer components"),
        };
        self.integer_vector(reading, component)
    }

    /// The normal of a texel whose codes mean the components `component(0)` and so on.
    #[inline(always)]
    pub fn integer_vector(&self, reading: &CodeReading, component: impl Fn(usize) -> i32) -> Vector<i32> {
        let [x, y] = [component(0), component(1)];
        let z = match self.channels {
            Channels::Xyz => reading.rising(component(2)),
            Channels::Xy => reading.rebuilt(x, y),
        };
        [x, self.green * y, z]
    }

    /// The normal of texel `index` in f32, in this order of operations.
    #[inline(always)]
    pub fn floats(&self, codes: CodesRef<'_>, index: usize) -> Vector<f32> {
        if let Some(reading) = &self.codes {
            return float_of_integers(reading, self.integers(reading, codes, index));
        }
        let at = index * self.channels.count();
        let component = |channel: usize| match codes {
            CodesRef::F16(codes) => codes[at + channel].to_f32(),
            CodesRef::F32(codes) => codes[at + channel],
            CodesRef::U8(_) | CodesRef::U16(_) => unreachable!("the format says floats"),
        };
        self.float_vector(component)
    }

    /// The normal of a texel that stores the floats `component(0)` and so on, in this order of operations.
    #[inline(always)]
    pub fn float_vector(&self, component: impl Fn(usize) -> f32) -> Vector<f32> {
        let [x, y] = [zero_below(SMALLEST, component(0)), zero_below(SMALLEST, component(1))];
        let z = match self.channels {
            Channels::Xyz => component(2).max(LEAST_Z),
            Channels::Xy => (1.0 - (x * x + y * y)).max(LEAST_Z * LEAST_Z).sqrt(),
        };
        [x, self.green as f32 * y, z]
    }
}

/// Integers over L as floats.
#[inline(always)]
pub(crate) fn float_of_integers(reading: &CodeReading, [x, y, z]: Vector<i32>) -> Vector<f32> {
    let over_l = |u: i32| u as f32 * (1.0 / reading.greatest as f32);
    [over_l(x), over_l(y), over_l(z)]
}
