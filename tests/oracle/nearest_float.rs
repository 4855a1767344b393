//! The nearest float to A / sqrt(S), ties to even: a search through the bit patterns.

use num_bigint::{BigInt, BigUint, Sign};

/// An IEEE binary format.
#[derive(Clone, Copy)]
pub struct FloatLayout {
    bits: u32,
    fraction_bits: u32,
    bias: i32,
}

impl FloatLayout {
    pub const F16: Self = Self { bits: 16, fraction_bits: 10, bias: 15 };
    pub const F32: Self = Self { bits: 32, fraction_bits: 23, bias: 127 };

    /// The bit pattern of the float nearest to `a / sqrt(s)`, which is at most 1 in magnitude.
    pub fn nearest(self, a: &BigInt, s: &BigInt) -> u32 {
        let a_squared = a.magnitude() * a.magnitude();
        // Patterns of one sign are in the order of their values.
        let (mut least, mut greatest) = (0, (self.bias as u32) << self.fraction_bits);
        while least < greatest {
            let pattern = (least + greatest) / 2;
            if self.is_beyond(pattern, &a_squared, s.magnitude()) {
                least = pattern + 1;
            } else {
                greatest = pattern;
            }
        }
        if a.sign() == Sign::Minus { least | 1 << (self.bits - 1) } else { least }
    }

    /// Whether |a| / sqrt(s) is nearer to a greater float than to that of `pattern`.
    fn is_beyond(self, pattern: u32, a_squared: &BigUint, s: &BigUint) -> bool {
        // The middle between this float, f 2^e, and the next one is (2 f + 1) 2^(e - 1).
        let (significand, exponent) = self.parts(pattern);
        let middle = BigUint::from(2 * significand + 1);
        let scaled = a_squared << (2 * (1 - exponent) as u32);
        let bound = &middle * &middle * s;
        scaled > bound || (scaled == bound && pattern % 2 == 1)
    }

    /// f and e of the value f 2^e.
    fn parts(self, pattern: u32) -> (u32, i32) {
        let fraction = pattern & ((1 << self.fraction_bits) - 1);
        let (implied, exponent) = match pattern >> self.fraction_bits {
            0 => (0, 1),
            exponent => (1 << self.fraction_bits, exponent as i32),
        };
        (fraction | implied, exponent - self.bias - self.fraction_bits as i32)
    }
}

#[test]
fn known_components_have_known_floats() {
    let nearest = |layout: FloatLayout, a: i64, s: i64| layout.nearest(&a.into(), &s.into());
    // 1/2 = 1/sqrt(4), 3/5, 1/3, 1/sqrt(2) in binary32 and binary16.
    for (a, s, f32_bits, f16_bits) in [
        (0, 1, 0x0000_0000, 0x0000),
        (1, 1, 0x3f80_0000, 0x3c00),
        (-1, 1, 0xbf80_0000, 0xbc00),
        (1, 4, 0x3f00_0000, 0x3800),
        (3, 25, 0x3f19_999a, 0x38cd),
        (1, 9, 0x3eaa_aaab, 0x3555),
        (1, 2, 0x3f35_04f3, 0x39a8),
        (-1, 2, 0xbf35_04f3, 0xb9a8),
        // 2^-24 is the least half float, 2^-25 ties with zero, and a little more does not.
        (1, 1 << 48, 0x3380_0000, 0x0001),
        (1, 1 << 50, 0x3300_0000, 0x0000),
        (1, (1 << 50) - 1, 0x3300_0000, 0x0001),
        (-1, 1 << 52, 0xb280_0000, 0x8000),
    ] {
        assert_eq!(nearest(FloatLayout::F32, a, s), f32_bits, "{a}/sqrt({s})");
        assert_eq!(nearest(FloatLayout::F16, a, s), f16_bits, "{a}/sqrt({s})");
    }
}
