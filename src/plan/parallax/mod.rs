//! Which parallax method at run time, and which map for it.

mod search;
mod sides;
mod words;

pub(super) use search::choose;
pub(super) use sides::Sides;

use super::decision::{Decision, bytes_per_texel};
use super::subject::Reduced;
use crate::baker::Baker;
use crate::error::Result;
use crate::io::check_parallax_format;
use crate::map::{Depth, Encoding, HeightMap, NormalMap, ParallaxFormat, ParallaxMap};
use crate::material::{Material, ParallaxMethod};
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;
use std::path::Path;

/// A parallax method that keeps within its tolerance, with its map if it reads one.
#[derive(Debug, Clone)]
pub(super) struct ParallaxChoice {
    pub method: ParallaxMethod,
    pub map: Option<MapChoice>,
    /// The error that counts, in pixels.
    pub error: f64,
    /// What a screen full of it takes, if that is bounded.
    pub milliseconds: Option<f64>,
    /// Bytes of what the method reads, the normal map aside, over texels of the height map.
    pub bytes: f64,
    pub decisions: Vec<Decision>,
}

/// A parallax map.
#[derive(Debug, Clone, Copy)]
pub(super) struct MapChoice {
    pub format: ParallaxFormat,
    /// The largest error of a texel, of values from -1 to 1.
    pub error: f64,
}

impl ParallaxChoice {
    /// The format of its map.
    pub fn format(&self) -> Option<ParallaxFormat> {
        self.map.map(|map| map.format)
    }
}

/// The formats that files of this extension hold, cheapest first; of those that cost the same, one with a code for zero.
pub(super) fn formats(extension: &str) -> Vec<ParallaxFormat> {
    let file = Path::new("map").with_extension(extension);
    let encodings = [Encoding::Snorm, Encoding::Biased, Encoding::Unorm, Encoding::Float];
    let depths = [Depth::Bits8, Depth::Bits16, Depth::Float16, Depth::Float32];
    let all = encodings.into_iter().flat_map(|encoding| depths.map(|depth| ParallaxFormat { encoding, depth }));
    let mut formats: Vec<_> = all.filter(|format| check_parallax_format(&file, *format).is_ok()).collect();
    formats.sort_by_key(|format| format.depth.bytes());
    formats.dedup_by_key(|format| format.depth);
    formats
}

/// The maps of a reduced height map with the whole one, as a scene has them.
pub(super) fn material(
    heights: &HeightMap,
    normals: &NormalMap,
    parallax: &ParallaxMap,
    options: &BakeOptions,
) -> Result<Material> {
    Ok(Material::of_maps(heights, normals, parallax, options.scale.resolve(heights.size())?, options.edges))
}

/// A parallax map of the reduced heights.
pub(super) fn bake(
    baker: &Baker,
    reduced: &Reduced<'_>,
    format: ParallaxFormat,
    precision: Precision,
) -> Result<ParallaxMap> {
    let options = BakeOptions { normal: None, parallax: Some(format), precision, ..reduced.options };
    let maps = baker.bake(&reduced.heights, &options)?;
    Ok(maps.parallax.unwrap_or_else(|| unreachable!("it was asked for")))
}

/// `biased 8, 1 byte per texel`.
fn describe(format: ParallaxFormat) -> String {
    format!("{} {}, {}", format.encoding, format.depth, bytes_per_texel(format.depth.bytes() as f64))
}
