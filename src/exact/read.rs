//! From codes to components, as integers.

use crate::map::TexelFormat;
use crate::map::{Depth, Encoding};

/// How one integer encoding is read: a component is the integer u over L, with -L <= u <= L.
///
/// Unorm: u = 2c - L (DESIGN 3.1), but the code that zero is written as, (L + 1)/2, reads as 0 and not as 1: a flat
/// texel is flat, and a slope along one axis has none along the other. Snorm and biased: u is the signed code; the one
/// below -L, which is never written, reads as -L.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CodeReading {
    /// Turns a stored code into an unsigned one in the order of its components: the sign bit of snorm, else 0.
    pub flip: u32,
    /// u = factor c - centre: factor 2 and centre L for unorm, 1 and 2^(b-1) for the others.
    pub factor: i32,
    pub centre: i32,
    /// The greatest magnitude L.
    pub greatest: i32,
}

impl CodeReading {
    /// The reading of an integer format; `None` for floats.
    pub fn new(format: TexelFormat) -> Option<Self> {
        let greatest = format.encoding.greatest_code(format.depth)? as i32;
        let half = match format.depth {
            Depth::Bits8 => 1 << 7,
            _ => 1 << 15,
        };
        Some(match format.encoding {
            Encoding::Unorm => Self { flip: 0, factor: 2, centre: greatest, greatest },
            Encoding::Snorm => Self { flip: half, factor: 1, centre: half as i32, greatest },
            _ => Self { flip: 0, factor: 1, centre: half as i32, greatest },
        })
    }

    /// u for a stored code.
    #[inline(always)]
    pub fn component(&self, code: u32) -> i32 {
        let u = self.factor * (code ^ self.flip) as i32 - self.centre;
        let u = if u < -self.greatest { -self.greatest } else { u };
        if self.factor == 2 && u == 1 { 0 } else { u }
    }

    /// z of a texel that stores it: at least 1, since a normal that does not rise has no slope.
    #[inline(always)]
    pub fn rising(&self, z: i32) -> i32 {
        z.max(1)
    }

    /// z of a texel that stores x and y only: floor(sqrt(L^2 - x^2 - y^2)), at least 1 (FGED2 eq. 7.44).
    #[inline(always)]
    pub fn rebuilt(&self, x: i32, y: i32) -> i32 {
        // Integers below 2^34, which f64 holds as they are.
        let square = |u: i32| f64::from(u) * f64::from(u);
        let rest = square(self.greatest) - square(x) - square(y);
        // Below 2^32 an f64 root is exact enough that its floor is the integer root.
        let root = rest.max(1.0).sqrt().floor();
        // Next to 1.5 * 2^52 a float's last place is 1. `as i32` saturates, which costs more.
        (root + 6_755_399_441_055_744.0).to_bits() as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(encoding: Encoding, depth: Depth) -> CodeReading {
        CodeReading::new(TexelFormat { encoding, depth, channels: 3 }).unwrap()
    }

    #[test]
    fn codes_read_as_their_encoding_says() {
        let components = |encoding, depth, codes: [u32; 5]| codes.map(|code| reading(encoding, depth).component(code));
        assert_eq!(components(Encoding::Unorm, Depth::Bits8, [0, 127, 128, 129, 255]), [-255, -1, 0, 3, 255]);
        assert_eq!(components(Encoding::Snorm, Depth::Bits8, [0x80, 0x81, 0xff, 0, 0x7f]), [-127, -127, -1, 0, 127]);
        assert_eq!(components(Encoding::Biased, Depth::Bits8, [0, 1, 127, 128, 255]), [-127, -127, -1, 0, 127]);
        let words = [0, 32767, 32768, 32769, 65535];
        assert_eq!(components(Encoding::Unorm, Depth::Bits16, words), [-65535, -1, 0, 3, 65535]);
        assert_eq!(components(Encoding::Biased, Depth::Bits16, words), [-32767, -1, 0, 1, 32767]);
        assert_eq!(components(Encoding::Snorm, Depth::Bits16, [32768, 32769, 65535, 0, 1]), [-32767, -32767, -1, 0, 1]);
    }

    #[test]
    fn rebuilt_z_is_the_integer_root() {
        for (encoding, depth) in [(Encoding::Unorm, Depth::Bits16), (Encoding::Snorm, Depth::Bits8)] {
            let reading = reading(encoding, depth);
            let l = i64::from(reading.greatest);
            for (x, y) in [(0, 0), (3, 4), (l, 0), (l, 1), (l / 2, l / 3), (l - 1, 5), (1, l - 1)] {
                let (z, rest) = (i64::from(reading.rebuilt(x as i32, y as i32)), l * l - x * x - y * y);
                assert!(z == 1 && rest < 4 || z * z <= rest && (z + 1) * (z + 1) > rest, "{x} {y}: {z}");
            }
        }
    }
}
