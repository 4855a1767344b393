//! Heights into normal and parallax maps.

use super::pieces::{cut_heights, cuts, print_heights, simpler_heights};
use crate::baker::Baker;
use crate::error::Result;
use crate::exact::Scale;
use crate::map::{Edge, Edges, HeightMap};
use crate::ops::Precision;
use crate::ops::bake::{BakeOptions, Filter};
use crate::verify::answer::Answer;
use crate::verify::oracle::{self, Real};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BakeJob {
    pub heights: HeightMap,
    pub options: BakeOptions,
}

impl BakeJob {
    pub fn run(&self, baker: &Baker) -> Result<Vec<Answer>> {
        let maps = baker.bake(&self.heights, &self.options)?;
        Ok(maps.normal.map(Answer::from).into_iter().chain(maps.parallax.map(Answer::from)).collect())
    }

    pub fn smaller(&self, map: usize, index: usize) -> Vec<Self> {
        let texel = index / self.channels(map);
        let with = |heights| Self { heights, ..self.clone() };
        let of = |options| Self { options, ..self.clone() };
        let options = self.options;
        let cut = cuts(self.heights.size(), texel).into_iter().map(|cut| with(cut_heights(&self.heights, &cut)));
        let plain = [
            of(BakeOptions { scale: Scale::texels(1), ..options }),
            of(BakeOptions { filter: Filter::Central, ..options }),
            of(BakeOptions { edges: Edges::both(Edge::Wrap), ..options }),
        ];
        let values = simpler_heights(&self.heights).into_iter().map(with);
        let plain = plain.into_iter().filter(|job| job != self);
        let simpler = plain.chain(values).filter(|_| options.precision == Precision::Exact);
        cut.chain(simpler).collect()
    }

    pub fn real(&self, map: usize, index: usize) -> Option<Real> {
        match self.channels(map) {
            1 => oracle::parallax(&self.heights, &self.options, index),
            channels => oracle::normal(&self.heights, &self.options, index / channels, index % channels),
        }
    }

    /// Codes of a texel of answer `map`: of the normal map, if there is one, and then of the parallax map.
    fn channels(&self, map: usize) -> usize {
        self.options.normal.filter(|_| map == 0).map_or(1, |format| format.channels.count())
    }

    pub fn input(&self) -> String {
        let BakeOptions { scale, filter, edges, .. } = self.options;
        format!("scale {scale}, {filter}, {edges}\n{}", print_heights("heights", &self.heights))
    }
}
