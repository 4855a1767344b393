//! Chance that repeats.

#[path = "../../src/split_mix.rs"]
mod split_mix;

use split_mix::SplitMix;

/// The same numbers from the same seed everywhere.
pub struct Random(SplitMix);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    pub fn bits(&mut self) -> u64 {
        self.0.bits()
    }

    /// An integer in `0..end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.0.below(end)
    }

    /// An integer in `-greatest..=greatest` whose magnitude is as likely to have few bits as many.
    pub fn any_magnitude(&mut self, greatest: i64) -> i64 {
        let shift = self.below(u64::from(greatest.unsigned_abs().ilog2()) + 1);
        let magnitude = (self.below(greatest.unsigned_abs() + 1) >> shift) as i64;
        if self.bits() & 1 == 0 { magnitude } else { -magnitude }
    }

    /// Any finite f32: every exponent, subnormals included, is as likely.
    pub fn finite(&mut self) -> f32 {
        loop {
            let value = f32::from_bits(self.bits() as u32);
            if value.is_finite() {
                return value;
            }
        }
    }
}
