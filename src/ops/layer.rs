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

/// The greatest magnitude of a float component; what is beyond it, or no number, is refused where maps are read.
pub(crate) const GREATEST_COMPONENT: f32 = 65_536.0;

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
        self.integer_vector(reading, component(0), component(1), component)
    }

    /// The normal whose first components are `x` and `y`; `component(2)` is z where it is stored.
    #[inline(always)]
    fn integer_vector(&self, reading: &CodeReading, x: i32, y: i32, component: impl Fn(usize) -> i32) -> Vector<i32> {
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
            let [x, y, z] = self.integers(reading, codes, index);
            let over_l = |u: i32| u as f32 * (1.0 / reading.greatest as f32);
            return [over_l(x), over_l(y), over_l(z)];
        }
        let at = index * self.channels.count();
        let component = |channel: usize| match codes {
            CodesRef::F16(codes) => codes[at + channel].to_f32(),
            CodesRef::F32(codes) => codes[at + channel],
            CodesRef::U8(_) | CodesRef::U16(_) => unreachable!("the format says floats"),
        };
        let [x, y] = [zero_below(SMALLEST, component(0)), zero_below(SMALLEST, component(1))];
        let z = match self.channels {
            Channels::Xyz => component(2).max(LEAST_Z),
            Channels::Xy => (1.0 - (x * x + y * y)).max(LEAST_Z * LEAST_Z).sqrt(),
        };
        [x, self.green as f32 * y, z]
    }
}
