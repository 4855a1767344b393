//! The nearest integer code to a component A / sqrt(S), decided in integers.

use super::Radicand;
use crate::map::{Depth, Encoding, TexelFormat};

/// How one integer encoding rounds.
///
/// Unorm and snorm are one rule: the code is `floor((m v + c + 1) / 2)` with m = c = L for unorm and m = 2L, c = 0
/// for snorm, so it is at least k exactly when `m A >= t sqrt(S)` with `t = 2k - 1 - c` (DESIGN 3.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CodeRounding {
    /// Factor m of the component, below 2^16.
    pub m: i32,
    /// Centre c.
    pub c: i32,
    /// The least code that a component of -1 gives.
    pub least: i32,
    /// The greatest code, for a component of 1.
    pub greatest: i32,
    /// Added to a code to store it: 2^(b-1) for biased.
    pub offset: i32,
    /// Keeps the stored bits of a code.
    pub mask: u32,
}

impl CodeRounding {
    /// The rounding of an integer format; `None` for floats.
    pub fn new(format: TexelFormat) -> Option<Self> {
        let TexelFormat { encoding, depth, .. } = format;
        let l = encoding.greatest_code(depth)? as i32;
        let mask = match depth {
            Depth::Bits8 => 0xff,
            _ => 0xffff,
        };
        let (m, c, least) = if encoding == Encoding::Unorm { (l, l, 0) } else { (2 * l, 0, -l) };
        let offset = if encoding == Encoding::Biased { l + 1 } else { 0 };
        Some(Self { m, c, least, greatest: l, offset, mask })
    }

    /// The code of the component `a / sqrt(s)`, `a^2 <= s`, as it is stored.
    pub fn code<S: Radicand>(&self, a: S::Part, s: S) -> u32 {
        // The estimate is off by far less than half a code, so one comparison decides between two codes.
        let estimate = S::float(a) / s.to_f64().sqrt();
        let below = ((f64::from(self.m) * estimate + f64::from(self.c)) * 0.5).floor() as i32;
        let below = below.clamp(self.least, self.greatest - 1);
        let reaches_next = self.reaches(a, s, 2 * below + 1 - self.c);
        self.stored(below + i32::from(reaches_next))
    }

    /// Whether `m a >= t sqrt(s)`.
    fn reaches<S: Radicand>(&self, a: S::Part, s: S, t: i32) -> bool {
        let square = |value: i32| u64::from(value.unsigned_abs()).pow(2);
        let mmaa = S::square(a).times(square(self.m));
        let tts = s.times(square(t));
        match (S::float(a) < 0.0, t < 0) {
            (false, true) => true,
            (true, false) => false,
            (false, false) => mmaa >= tts,
            (true, true) => mmaa <= tts,
        }
    }

    /// The code of a float component: floor((m v + c + 1) / 2) in f32, in this order: v (m/2) + (c + 1)/2, whose
    /// constants are exact.
    pub fn code_of_float(&self, component: f32) -> u32 {
        let code = component * (self.m as f32 * 0.5) + (self.c as f32 + 1.0) * 0.5;
        self.stored(code.floor() as i32)
    }

    /// The bits that store a code.
    pub fn stored(&self, code: i32) -> u32 {
        (code + self.offset) as u32 & self.mask
    }
}
