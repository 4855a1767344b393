//! Two normal maps into one.

use super::pieces::{cut_heights, cut_normals, cuts, print_heights, print_normals, simpler_heights, simpler_normals};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{HeightMap, NormalMap};
use crate::ops::Precision;
use crate::ops::blend::{BlendInputs, BlendOptions};
use crate::verify::answer::Answer;
use crate::verify::oracle::{self, Real};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BlendJob {
    pub base: NormalMap,
    pub detail: NormalMap,
    pub mask: Option<HeightMap>,
    pub options: BlendOptions,
}

impl BlendJob {
    pub fn run(&self, baker: &Baker) -> Result<Vec<Answer>> {
        let inputs = BlendInputs { base: &self.base, detail: &self.detail, mask: self.mask.as_ref() };
        Ok(vec![baker.blend(&inputs, &self.options)?.into()])
    }

    pub fn smaller(&self, index: usize) -> Vec<Self> {
        let texel = index / self.options.format.channels.count();
        let cut = cuts(self.base.size(), texel).into_iter().map(|cut| Self {
            base: cut_normals(&self.base, &cut),
            detail: cut_normals(&self.detail, &cut),
            mask: self.mask.as_ref().map(|mask| cut_heights(mask, &cut)),
            ..self.clone()
        });
        let base = simpler_normals(&self.base).into_iter().map(|base| Self { base, ..self.clone() });
        let detail = simpler_normals(&self.detail).into_iter().map(|detail| Self { detail, ..self.clone() });
        let masks = self.mask.iter().flat_map(simpler_heights);
        let mask = masks.map(|mask| Self { mask: Some(mask), ..self.clone() });
        let simpler = base.chain(detail).chain(mask).filter(|_| self.options.precision == Precision::Exact);
        cut.chain(simpler).collect()
    }

    pub fn has_integers_alone(&self) -> bool {
        ![self.base.format(), self.detail.format()].iter().any(|format| format.depth.is_float())
    }

    pub fn real(&self, index: usize) -> Option<Real> {
        let channels = self.options.format.channels.count();
        let texel = index / channels;
        let mask = self.mask.as_ref().map(|mask| (mask, texel));
        let (method, convention) = (self.options.method, self.options.format.convention);
        oracle::blended(method, [(&self.base, texel), (&self.detail, texel)], mask, convention, index % channels)
    }

    pub fn input(&self) -> String {
        let mut text = format!("{}\n{}", print_normals("base", &self.base), print_normals("detail", &self.detail));
        if let Some(mask) = &self.mask {
            text += "\n";
            text += &print_heights("mask", mask);
        }
        text
    }
}
