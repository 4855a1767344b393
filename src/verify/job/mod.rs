//! One input to one operation: what verification runs, compares and shrinks.

mod bake;
mod blend;
mod parallax;
mod pieces;
mod tangents;

pub(crate) use bake::BakeJob;
pub(crate) use blend::BlendJob;
pub(crate) use parallax::ParallaxJob;
pub(crate) use tangents::TangentJob;

use super::answer::Answer;
use super::oracle::Real;
use crate::baker::Baker;
use crate::error::Result;
use crate::ops::Precision;

/// An operation's options and inputs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Job {
    Bake(BakeJob),
    Blend(BlendJob),
    Parallax(ParallaxJob),
    Tangents(TangentJob),
}

impl Job {
    /// What a backend makes of it: one answer for each map.
    pub fn run(&self, baker: &Baker) -> Result<Vec<Answer>> {
        match self {
            Self::Bake(job) => job.run(baker),
            Self::Blend(job) => job.run(baker),
            Self::Parallax(job) => job.run(baker),
            Self::Tangents(job) => job.run(baker),
        }
    }

    /// The same in another precision.
    pub fn with_precision(&self, precision: Precision) -> Self {
        let mut job = self.clone();
        match &mut job {
            Self::Bake(job) => job.options.precision = precision,
            Self::Blend(job) => job.options.precision = precision,
            Self::Parallax(job) => job.precision = precision,
            Self::Tangents(job) => job.options.precision = precision,
        }
        job
    }

    /// Whether it is `fast`, and promises no bytes.
    pub fn is_fast(&self) -> bool {
        let precision = match self {
            Self::Bake(job) => job.options.precision,
            Self::Blend(job) => job.options.precision,
            Self::Parallax(job) => job.precision,
            Self::Tangents(job) => job.options.precision,
        };
        precision == Precision::Fast
    }

    /// Simpler jobs of the same kernel, the boldest first, around code `index` of answer `map`, which is wrong. Those of
    /// `fast` are cut only: simpler numbers could be some for which it promises nothing.
    pub fn smaller(&self, map: usize, index: usize) -> Vec<Self> {
        match self {
            Self::Bake(job) => job.smaller(map, index).into_iter().map(Self::Bake).collect(),
            Self::Blend(job) => job.smaller(index).into_iter().map(Self::Blend).collect(),
            Self::Parallax(job) => job.smaller(index).into_iter().map(Self::Parallax).collect(),
            Self::Tangents(job) => job.smaller().into_iter().map(Self::Tangents).collect(),
        }
    }

    /// What code `index` of answer `map` stores, in real arithmetic; `None` where no whole numbers say it.
    pub fn real(&self, map: usize, index: usize) -> Option<Real> {
        match self {
            Self::Bake(job) => job.real(map, index),
            Self::Blend(job) => job.real(index),
            Self::Parallax(job) => job.real(index),
            Self::Tangents(_) => None,
        }
    }

    /// Whether `exact` promises the correctly rounded codes, and not only the same ones.
    pub fn is_correctly_rounded(&self) -> bool {
        match self {
            Self::Bake(job) => job.heights.height_type().greatest_code().is_some(),
            Self::Blend(job) => job.has_integers_alone(),
            Self::Parallax(job) => job.has_integers_alone(),
            Self::Tangents(_) => false,
        }
    }

    /// The input in full, bits and all: for small ones.
    pub fn input(&self) -> String {
        match self {
            Self::Bake(job) => job.input(),
            Self::Blend(job) => job.input(),
            Self::Parallax(job) => job.input(),
            Self::Tangents(job) => job.input(),
        }
    }
}
