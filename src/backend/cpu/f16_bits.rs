//! Between f32 and f16 in integers, so that a loop of it becomes vector code on every machine.

use half::f16;

/// The nearest f16, ties to even, of a number between -2 and 2.
#[inline(always)]
pub(super) fn nearest_f16_of_f32(value: f32) -> f16 {
    const LEAST_NORMAL: u32 = (127 - 14) << 23;
    const REBIAS: u32 = (127 - 15) << 23;
    let bits = value.to_bits();
    let (sign, magnitude) = ((bits >> 16) as u16 & 0x8000, bits & 0x7fff_ffff);
    // Adds just under half of the last place kept, or exactly half if that place is odd.
    let normal = magnitude.wrapping_sub(REBIAS).wrapping_add(0xfff + ((magnitude >> 13) & 1)) >> 13;
    // Next to 0.5 a float's last place is 2^-24, a subnormal f16's only one: the addition rounds.
    let subnormal = (f32::from_bits(magnitude) + 0.5).to_bits() - 0.5f32.to_bits();
    let rounded = if magnitude < LEAST_NORMAL { subnormal } else { normal };
    f16::from_bits(sign | rounded as u16)
}

/// A finite f16 as it is.
#[inline(always)]
pub(super) fn f32_of_f16(value: f16) -> f32 {
    let bits = u32::from(value.to_bits());
    // With the exponent's bits in their place it is too small by 2^(127 - 15), subnormal or not.
    let magnitude = f32::from_bits((bits & 0x7fff) << 13) * 2f32.powi(127 - 15);
    f32::from_bits(magnitude.to_bits() | (bits & 0x8000) << 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_as_half_does() {
        // Every f16 in range, and the f32 on and around each half-way point.
        for bits in 0..=f16::ONE.to_bits() {
            let [this, next] = [bits, bits + 1].map(|bits| f16::from_bits(bits).to_f32());
            let between = ((this + next) * 0.5).to_bits();
            for magnitude in [this.to_bits(), between - 1, between, between + 1] {
                for value in [f32::from_bits(magnitude), -f32::from_bits(magnitude)] {
                    assert_eq!(nearest_f16_of_f32(value).to_bits(), f16::from_f32(value).to_bits(), "{value:e}");
                }
            }
        }
        // Below the rebias, what is not used wraps.
        for below in 0..=4097 {
            let value = f32::from_bits(2f32.powi(-15).to_bits() - below);
            assert_eq!(nearest_f16_of_f32(value).to_bits(), f16::from_f32(value).to_bits(), "{value:e}");
        }
        for value in [0.0, -0.0, f32::from_bits(1), -f32::MIN_POSITIVE] {
            assert_eq!(nearest_f16_of_f32(value).to_bits(), f16::from_f32(value).to_bits(), "{value:e}");
        }
    }

    #[test]
    fn every_finite_f16_is_an_f32() {
        for value in (0..=u16::MAX).map(f16::from_bits).filter(|value| value.is_finite()) {
            assert_eq!(f32_of_f16(value).to_bits(), value.to_f32().to_bits(), "{value:e}");
        }
    }
}
