//! Chance that repeats.

/// SplitMix64 (Steele, Lea and Flood, 2014): the same numbers from the same seed everywhere.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer in `0..end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.bits() % end
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
