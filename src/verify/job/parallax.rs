//! Heights and given normals into parallax maps.

use super::pieces::{cut_heights, cut_normals, cuts, print_heights, print_normals, simpler_heights, simpler_normals};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{HeightMap, NormalMap, ParallaxFormat};
use crate::ops::Precision;
use crate::verify::answer::Answer;
use crate::verify::oracle::{self, Real};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ParallaxJob {
    pub heights: HeightMap,
    pub normals: NormalMap,
    pub format: ParallaxFormat,
    pub precision: Precision,
}

impl ParallaxJob {
    pub fn run(&self, baker: &Baker) -> Result<Vec<Answer>> {
        let map = baker.parallax_with_normals(&self.heights, &self.normals, self.format, self.precision)?;
        Ok(vec![map.into()])
    }

    pub fn smaller(&self, texel: usize) -> Vec<Self> {
        let cut = cuts(self.heights.size(), texel).into_iter().map(|cut| Self {
            heights: cut_heights(&self.heights, &cut),
            normals: cut_normals(&self.normals, &cut),
            ..self.clone()
        });
        let heights = simpler_heights(&self.heights).into_iter().map(|heights| Self { heights, ..self.clone() });
        let normals = simpler_normals(&self.normals).into_iter().map(|normals| Self { normals, ..self.clone() });
        cut.chain(heights.chain(normals).filter(|_| self.precision == Precision::Exact)).collect()
    }

    pub fn has_integers_alone(&self) -> bool {
        self.heights.height_type().greatest_code().is_some() && !self.normals.format().depth.is_float()
    }

    pub fn real(&self, index: usize) -> Option<Real> {
        oracle::parallax_with_normals(&self.heights, &self.normals, index)
    }

    pub fn input(&self) -> String {
        format!("{}\n{}", print_heights("heights", &self.heights), print_normals("normals", &self.normals))
    }
}
