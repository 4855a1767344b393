//! The levels of a roughness map, from slopes to codes.

use super::pyramid::{Pyramid, Rows};
use super::roughness::{PLANES, Roughness};
use super::rows::{codes_of, samples_of};
use super::tee::Tap;
use crate::backend::cpu::levels::LevelHeight;
use crate::error::Result;
use crate::map::RoughnessFormat;
use crate::ops::bake::BakePlan;
use crate::stream::{Band, HeightBand, LevelSink};

/// The smaller levels of the roughness map of a plan's slopes.
pub(super) struct RoughnessLevels<'a> {
    plan: &'a BakePlan,
    roughness: Roughness,
    format: RoughnessFormat,
    sums: Pyramid<f64>,
    sink: Box<dyn LevelSink + 'a>,
}

impl<'a> RoughnessLevels<'a> {
    pub fn new(
        plan: &'a BakePlan,
        roughness: Roughness,
        format: RoughnessFormat,
        sink: Box<dyn LevelSink + 'a>,
    ) -> Self {
        Self { plan, roughness, format, sums: Pyramid::new(plan.size, PLANES), sink }
    }

    /// Bytes that are held at most while strips of `rows` rows are added on `threads` threads, of which each has the
    /// stencil sums of a row.
    pub fn held_bytes(plan: &BakePlan, format: RoughnessFormat, rows: usize, threads: usize) -> u64 {
        let stencil_sums = threads * plan.size.width() * size_of::<[f32; 2]>();
        Pyramid::<f64>::held_bytes(plan.size, PLANES, format.texel().bytes(), rows) + stencil_sums as u64
    }

    fn samples<T: LevelHeight<Sum: Into<f64>>>(&self, strip: &Band<'_, T>) -> Vec<f64> {
        let Self { plan, roughness, .. } = self;
        samples_of(strip, PLANES, |row, samples| roughness.samples(plan, strip, row, samples))
    }

    fn write(&mut self, complete: Vec<Rows<f64>>) -> Result<()> {
        let (roughness, formats) = (&self.roughness, [self.format.texel()]);
        for rows in complete.iter().filter(|rows| !rows.rows.is_empty()) {
            let maps = codes_of(rows, PLANES, &formats, |sums, maps| {
                maps.into_iter().for_each(|codes| roughness.codes(rows.weight, sums, codes));
            });
            maps.iter().try_for_each(|codes| self.sink.write(rows.level, rows.rows.start, codes.as_ref()))?;
        }
        Ok(())
    }
}

impl Tap for RoughnessLevels<'_> {
    fn add(&mut self, row: usize, strip: &HeightBand<'_>) -> Result<()> {
        let samples = match strip {
            HeightBand::U8(strip) => self.samples(strip),
            HeightBand::U16(strip) => self.samples(strip),
            HeightBand::F32(strip) => self.samples(strip),
        };
        let complete = self.sums.add(row, &samples);
        self.write(complete)
    }

    fn finish(mut self: Box<Self>) -> Result<()> {
        let complete = self.sums.finish();
        self.write(complete)
    }
}
