//! Normal maps and parallax maps: every precision, encoding, number of bits and of channels on every device.

use super::steps::Steps;
use super::time::median_time;
use super::{Errors, TrueNormals, normal_formats, parallax_formats};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{CodeMap, Convention, Encoding, HeightMap, MapFormat, Maps, Size, TexelFormat};
use crate::material::Texture;
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;
use serde::Serialize;
use std::time::Duration;

/// What a kind of map is, and what it costs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stored {
    /// What baked it.
    pub device: String,
    /// Exact or fast.
    pub precision: String,
    /// How a component becomes a code.
    pub encoding: String,
    /// How a code is stored.
    pub bits: String,
    /// Time of a bake from memory to memory, for each texel: the median.
    pub nanoseconds_per_texel: f64,
    /// Size of a texel, without compression.
    pub bytes_per_texel: usize,
}

/// A kind of normal map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NormalFigure {
    /// What it is, and what it costs.
    #[serde(flatten)]
    pub stored: Stored,
    /// Components that are stored.
    pub channels: String,
    /// Angles to the normals in double precision, of the codes as a shader decodes them.
    pub error_degrees: Errors,
}

/// A kind of parallax map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParallaxFigure {
    /// What it is, and what it costs.
    #[serde(flatten)]
    pub stored: Stored,
    /// Distances to n_z (2h - 1) in double precision; values are between -1 and 1.
    pub error: Errors,
}

impl NormalFigure {
    /// `exact, unorm 8 xyz`.
    pub fn name(&self) -> String {
        format!("{} {}", self.stored.name(), self.channels)
    }
}

impl Stored {
    /// `exact, unorm 8`.
    pub fn name(&self) -> String {
        let Self { precision, encoding, bits, .. } = self;
        format!("{precision}, {encoding} {bits}")
    }

    fn of(device: &Baker, precision: Precision, format: TexelFormat, size: Size, time: Duration) -> Self {
        Self {
            device: device.name(),
            precision: precision.to_string(),
            encoding: format.encoding.to_string(),
            bits: format.depth.to_string(),
            nanoseconds_per_texel: per_texel(time, size),
            bytes_per_texel: format.depth.bytes() * format.channels,
        }
    }
}

/// Precisions, in the order of the figures.
pub(super) const PRECISIONS: [Precision; 2] = [Precision::Exact, Precision::Fast];

/// Every normal map of some heights on a device; of `options` scale, filter and edges count.
pub(super) fn normal_figures(
    device: &Baker,
    heights: &HeightMap,
    options: &BakeOptions,
    convention: Convention,
    runs: usize,
    steps: &mut Steps<'_>,
) -> Result<Vec<NormalFigure>> {
    let (truth, size) = (TrueNormals::new(heights, options)?, heights.size());
    let mut figures = Vec::new();
    for precision in PRECISIONS {
        for format in normal_formats(convention) {
            let (encoding, depth, channels) = (format.encoding, format.depth, format.channels);
            steps.next(&format!("normal map, {precision}, {encoding} {depth} {channels}"))?;
            let options = BakeOptions { normal: Some(format), parallax: None, precision, ..*options };
            let mut map = poisoned(size, format);
            let time = timed(runs, || {
                device.bake_into(heights, &options, Maps { normal: Some(map.codes_mut()), ..Maps::default() })
            })?;
            figures.push(NormalFigure {
                stored: Stored::of(device, precision, format.texel(), size, time),
                channels: channels.to_string(),
                error_degrees: truth.errors(&Texture::of_normals(&map, options.edges)),
            });
        }
    }
    Ok(figures)
}

/// Every parallax map of some heights on a device.
pub(super) fn parallax_figures(
    device: &Baker,
    heights: &HeightMap,
    options: &BakeOptions,
    runs: usize,
    steps: &mut Steps<'_>,
) -> Result<Vec<ParallaxFigure>> {
    let (truth, size) = (TrueNormals::new(heights, options)?, heights.size());
    let mut figures = Vec::new();
    for precision in PRECISIONS {
        for format in parallax_formats() {
            steps.next(&format!("parallax map, {precision}, {} {}", format.encoding, format.depth))?;
            let options = BakeOptions { normal: None, parallax: Some(format), precision, ..*options };
            let mut map = poisoned(size, format);
            let time = timed(runs, || {
                device.bake_into(heights, &options, Maps { parallax: Some(map.codes_mut()), ..Maps::default() })
            })?;
            figures.push(ParallaxFigure {
                stored: Stored::of(device, precision, format.texel(), size, time),
                error: truth.parallax_errors(&Texture::of_parallax(&map, options.edges)),
            });
        }
    }
    Ok(figures)
}

/// Room for a map in which a texel that nobody writes is far off: NaN, -1, or 1 where no code is below zero.
pub(super) fn poisoned<F: MapFormat>(size: Size, format: F) -> CodeMap<F> {
    let mut map = CodeMap::zeroed(size, format);
    let byte = if format.stored().encoding == Encoding::Snorm { 0x80 } else { 0xff };
    map.codes_mut().bytes_mut().fill(byte);
    map
}

/// How long work takes that may fail: the median of `runs` runs.
pub(crate) fn timed<T>(runs: usize, mut work: impl FnMut() -> Result<T>) -> Result<Duration> {
    let mut failure = None;
    let time = median_time(runs, || {
        if failure.is_none() {
            failure = work().err();
        }
    });
    failure.map_or(Ok(time), Err)
}

/// Nanoseconds for each texel.
pub(super) fn per_texel(time: Duration, size: Size) -> f64 {
    time.as_secs_f64() * 1e9 / size.texels() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Grid;
    use crate::material::Texture;

    /// A device that writes nothing must not score: not even on a plane, of which zeros are the right x and y.
    #[test]
    fn what_is_not_written_is_far_off() {
        let heights = HeightMap::from(Grid::from_fn(8, 4, |_, _| 128u8).unwrap());
        let options = BakeOptions::default();
        let truth = TrueNormals::new(&heights, &options).unwrap();
        for format in normal_formats(Convention::Gl) {
            let map = poisoned(heights.size(), format);
            let errors = truth.errors(&Texture::of_normals(&map, options.edges));
            // From z to (1, 1, 1).
            assert!(errors.mean > 54.7, "{format:?}: {errors:?}");
        }
        for format in parallax_formats() {
            let map = poisoned(heights.size(), format);
            let errors = truth.parallax_errors(&Texture::of_parallax(&map, options.edges));
            assert!(errors.mean > 0.99, "{format:?}: {errors:?}");
        }
    }
}
