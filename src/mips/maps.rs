//! The smaller levels of normal and parallax maps, from sums to codes.

use super::bake::LevelsOut;
use super::pyramid::{Pyramid, Rows};
use super::rows::{codes_of, samples_of};
use super::sample::Sample;
use super::tee::Tap;
use crate::backend::cpu::levels::{LevelHeight, LevelSum, planes, samples};
use crate::error::Result;
use crate::map::{HeightType, TexelFormat};
use crate::ops::bake::BakePlan;
use crate::stream::{Band, HeightBand};

/// The levels of a plan's maps.
pub(super) struct MapLevels<'a> {
    plan: &'a BakePlan,
    sums: Sums,
    /// For each map of the plan.
    sinks: Vec<LevelsOut<'a>>,
}

enum Sums {
    Integers(Pyramid<i32>),
    Floats(Pyramid<f32>),
}

impl<'a> MapLevels<'a> {
    pub fn new(plan: &'a BakePlan, sinks: Vec<LevelsOut<'a>>) -> Self {
        let sums = match plan.height_type {
            HeightType::U8 | HeightType::U16 => Sums::Integers(Pyramid::new(plan.size, planes(plan))),
            HeightType::F32 => Sums::Floats(Pyramid::new(plan.size, planes(plan))),
        };
        Self { plan, sums, sinks }
    }

    /// Bytes that are held at most while strips of `rows` rows are added.
    pub fn held_bytes(plan: &BakePlan, rows: usize) -> u64 {
        let planes = planes(plan);
        let texel_bytes = plan.outputs().map(|format| format.bytes()).sum();
        match plan.height_type {
            HeightType::U8 | HeightType::U16 => Pyramid::<i32>::held_bytes(plan.size, planes, texel_bytes, rows),
            HeightType::F32 => Pyramid::<f32>::held_bytes(plan.size, planes, texel_bytes, rows),
        }
    }
}

impl Tap for MapLevels<'_> {
    fn add(&mut self, row: usize, strip: &HeightBand<'_>) -> Result<()> {
        let Self { plan, sums, sinks } = self;
        match (strip, sums) {
            (HeightBand::U8(strip), Sums::Integers(pyramid)) => add(plan, pyramid, row, strip, sinks),
            (HeightBand::U16(strip), Sums::Integers(pyramid)) => add(plan, pyramid, row, strip, sinks),
            (HeightBand::F32(strip), Sums::Floats(pyramid)) => add(plan, pyramid, row, strip, sinks),
            _ => unreachable!("the plan was made for heights of another type"),
        }
    }

    fn finish(self: Box<Self>) -> Result<()> {
        let Self { plan, sums, mut sinks } = *self;
        match sums {
            Sums::Integers(mut pyramid) => write(plan, pyramid.finish(), &mut sinks),
            Sums::Floats(mut pyramid) => write(plan, pyramid.finish(), &mut sinks),
        }
    }
}

fn add<T: LevelHeight>(
    plan: &BakePlan,
    pyramid: &mut Pyramid<T::Sum>,
    row: usize,
    strip: &Band<'_, T>,
    sinks: &mut [LevelsOut<'_>],
) -> Result<()>
where
    T::Sum: Sample<Sum: LevelSum>,
{
    let strip_samples = samples_of(strip, planes(plan), |row, row_samples| samples(plan, strip, row, row_samples));
    write(plan, pyramid.add(row, &strip_samples), sinks)
}

fn write<S: Sample + LevelSum>(plan: &BakePlan, complete: Vec<Rows<S>>, sinks: &mut [LevelsOut<'_>]) -> Result<()> {
    let formats: Vec<TexelFormat> = plan.outputs().collect();
    for rows in complete.iter().filter(|rows| !rows.rows.is_empty()) {
        let maps = codes_of(rows, planes(plan), &formats, |sums, maps| S::codes(plan, rows.weight, sums, maps));
        for (sink, codes) in sinks.iter_mut().zip(&maps) {
            sink.as_mut().map_or(Ok(()), |sink| sink.write(rows.level, rows.rows.start, codes.as_ref()))?;
        }
    }
    Ok(())
}
