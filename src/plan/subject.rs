//! A height map under plan, whole and reduced.

use super::scene::{Facts, SceneMaterial, Tolerance};
use super::view::Seen;
use super::visible::VisibleNormals;
use crate::baker::Baker;
use crate::error::Result;
use crate::io::ReadOptions;
use crate::map::{HeightMap, ParallaxMap};
use crate::material::Texture;
use crate::measure::TrueNormals;
use crate::ops::bake::BakeOptions;
use crate::stream::Monitor;
use std::num::NonZeroU32;
use std::path::Path;

/// A height map under plan.
pub(super) struct Subject<'a> {
    pub path: &'a Path,
    pub material: &'a SceneMaterial,
    pub heights: HeightMap,
    pub seen: Seen,
    pub baker: &'a Baker,
    pub monitor: &'a Monitor,
}

/// A height map at one of the resolutions that it can be reduced to.
pub(super) struct Reduced<'a> {
    /// The factor.
    pub by: u32,
    pub heights: HeightMap,
    /// A bake of it, without maps.
    pub options: BakeOptions,
    pub visible: VisibleNormals<'a>,
}

/// The greatest factor of [`ReadOptions::shrink`].
const GREATEST_SHRINK: u32 = 64;

/// A texel that is a millionth wider than a pixel is none: views are given in decimals.
const MARGIN: f64 = 1e-6;

impl<'a> Subject<'a> {
    pub fn read(path: &'a Path, material: &'a SceneMaterial, baker: &'a Baker, monitor: &'a Monitor) -> Result<Self> {
        let (heights, _) = HeightMap::read_with(path, &material.facts.read)?;
        let seen = material.view.of(heights.size(), material.extent);
        Ok(Self { path, material, heights, seen, baker, monitor })
    }

    pub fn facts(&self) -> &Facts {
        &self.material.facts
    }

    pub fn tolerance(&self) -> Tolerance {
        self.material.tolerance
    }

    /// The factors by which the map can be reduced so that a texel still covers no more than a pixel, greatest first;
    /// at last 1.
    pub fn factors(&self) -> Vec<u32> {
        let (width, height) = (self.heights.size().width(), self.heights.size().height());
        let divides = |by: &u32| width % *by as usize == 0 && height % *by as usize == 0;
        let is_seen = |by: &u32| *by == 1 || f64::from(*by) * self.seen.longer_side() <= 1.0 + MARGIN;
        (1..=GREATEST_SHRINK).rev().filter(divides).filter(is_seen).collect()
    }

    /// The map reduced by one of the factors.
    pub fn reduced(&self, by: u32) -> Result<Reduced<'_>> {
        Reduced::read(self.path, self.facts(), &self.heights, by)
    }
}

impl<'a> Reduced<'a> {
    /// The map at `path`, whose heights are `whole`, reduced by `by`.
    pub fn read(path: &Path, facts: &Facts, whole: &'a HeightMap, by: u32) -> Result<Self> {
        let shrink = by.try_into().unwrap_or(NonZeroU32::MIN);
        let (heights, _) = HeightMap::read_with(path, &ReadOptions { shrink, ..facts.read.clone() })?;
        let options = facts.bake();
        let visible = VisibleNormals::new(whole, &options, by)?;
        let options = BakeOptions { scale: options.scale.shrunk(shrink)?, ..options };
        Ok(Self { by, heights, options, visible })
    }

    /// The largest error of a texel of a parallax map of it, of values from -1 to 1.
    pub fn parallax_error(&self, map: &ParallaxMap) -> Result<f64> {
        let texture = Texture::of_parallax(map, self.options.edges);
        Ok(TrueNormals::new(&self.heights, &self.options)?.parallax_errors(&texture).largest)
    }

    /// What a byte for each texel of this map is for each of the whole one.
    pub fn share(&self) -> f64 {
        1.0 / f64::from(self.by * self.by)
    }
}
