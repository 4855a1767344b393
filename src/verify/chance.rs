//! Chance that repeats.

use crate::split_mix::SplitMix;

/// The same numbers from the same seed everywhere.
#[derive(Debug, Clone)]
pub(crate) struct Chance(SplitMix);

impl Chance {
    /// Chance of its own for each name under one seed, so that a case repeats without those before it.
    pub fn named(seed: u64, name: &str) -> Self {
        // FNV-1a.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        Self(SplitMix(seed ^ hash))
    }

    pub fn bits(&mut self) -> u64 {
        self.0.bits()
    }

    /// An integer in `0..end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.0.below(end)
    }

    /// One of them.
    pub fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// A number from -1 to 1, in steps of 2^-23.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 8_388_608.0 - 1.0
    }

    /// Any finite f32, subnormals included: every exponent is as likely.
    pub fn finite(&mut self) -> f32 {
        // The mask leaves out infinities and NaN.
        f32::from_bits(self.bits() as u32 & 0xff7f_ffff)
    }
}

#[cfg(test)]
mod tests {
    use super::Chance;

    #[test]
    fn names_have_chance_of_their_own_that_repeats() {
        let first = |seed, name| Chance::named(seed, name).bits();
        assert_eq!(first(1, "a"), first(1, "a"));
        assert_ne!(first(1, "a"), first(1, "b"));
        assert_ne!(first(1, "a"), first(2, "a"));
    }

    #[test]
    fn numbers_keep_to_their_range() {
        let mut chance = Chance::named(0, "");
        assert!((0..1000).all(|_| chance.finite().is_finite() && chance.unit().abs() <= 1.0 && chance.below(7) < 7));
    }
}
