//! What a backend answers: the codes of a map, or the tangents of a mesh's corners.

use crate::map::{Codes, CodesRef, Depth, Encoding, NormalMap, ParallaxMap, TexelFormat};
use half::f16;

/// What the codes of a texel are together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// A direction, of two or three components.
    Normal,
    /// A number.
    Parallax,
    /// A direction and a sign.
    Tangent,
}

/// The codes of one map.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Answer {
    pub meaning: Meaning,
    pub format: TexelFormat,
    /// Texels in a row; the corners of a mesh are one row.
    pub width: usize,
    pub codes: Codes,
}

impl From<NormalMap> for Answer {
    fn from(map: NormalMap) -> Self {
        let (format, width) = (map.format().texel(), map.size().width());
        Self { meaning: Meaning::Normal, format, width, codes: map.into_codes() }
    }
}

impl From<ParallaxMap> for Answer {
    fn from(map: ParallaxMap) -> Self {
        let (format, width) = (map.format().texel(), map.size().width());
        Self { meaning: Meaning::Parallax, format, width, codes: map.into_codes() }
    }
}

impl Answer {
    pub fn len(&self) -> usize {
        self.codes.as_ref().len()
    }

    pub fn texels(&self) -> usize {
        self.len() / self.format.channels
    }

    /// The stored bits of a code.
    pub fn bits(&self, index: usize) -> u32 {
        match self.codes.as_ref() {
            CodesRef::U8(codes) => codes[index].into(),
            CodesRef::U16(codes) => codes[index].into(),
            CodesRef::F16(codes) => codes[index].to_bits().into(),
            CodesRef::F32(codes) => codes[index].to_bits(),
        }
    }

    /// A code as the number that it stores: of snorm with its sign.
    pub fn number(&self, index: usize) -> f64 {
        let bits = self.bits(index);
        match (self.codes.as_ref(), self.format.encoding) {
            (CodesRef::F16(_), _) => f16::from_bits(bits as u16).to_f64(),
            (CodesRef::F32(_), _) => f32::from_bits(bits).into(),
            (CodesRef::U8(_), Encoding::Snorm) => (bits as u8 as i8).into(),
            (CodesRef::U16(_), Encoding::Snorm) => (bits as u16 as i16).into(),
            _ => bits.into(),
        }
    }

    /// The component from -1 to 1 that a code stores.
    pub fn component(&self, index: usize) -> f64 {
        let number = self.number(index);
        let Some(greatest) = self.format.encoding.greatest_code(self.format.depth).map(f64::from) else {
            return number;
        };
        match self.format.encoding {
            Encoding::Unorm => (2.0 * number - greatest) / greatest,
            Encoding::Biased => (number - greatest - 1.0) / greatest,
            _ => number / greatest,
        }
    }

    /// The direction of a texel, of any length; `None` for a number.
    pub fn direction(&self, texel: usize) -> Option<[f64; 3]> {
        if self.meaning == Meaning::Parallax {
            return None;
        }
        let at = texel * self.format.channels;
        let [x, y] = [self.component(at), self.component(at + 1)];
        let z = match self.format.channels {
            2 => (1.0 - x * x - y * y).max(0.0).sqrt(),
            _ => self.component(at + 2),
        };
        Some([x, y, z])
    }

    /// Whether directions are stored so finely that angles between them are those of what was computed.
    pub fn has_fine_directions(&self) -> bool {
        self.meaning != Meaning::Parallax && self.format.depth == Depth::Float32 && self.format.channels >= 3
    }

    /// What a code of a texel is called.
    pub fn channel(&self, index: usize) -> &'static str {
        match self.meaning {
            Meaning::Parallax => "parallax",
            Meaning::Normal | Meaning::Tangent => ["x", "y", "z", "w"][index % self.format.channels],
        }
    }
}
