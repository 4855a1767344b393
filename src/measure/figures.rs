//! Everything that is measured of a map.

use super::blends::{self, BlendFigure, Layers, blend_figures};
use super::frames::{Extent, FrameFigure, frame_figures};
use super::front::Front;
use super::fronts;
use super::maps::{NormalFigure, PRECISIONS, ParallaxFigure, normal_figures, parallax_figures};
use super::parallax::{OffsetFigure, OffsetTime, offset_figures};
use super::region::{Region, quarter_turned, scale_for};
use super::steps::{Progress, Steps};
use super::surfaces::SURFACES;
use super::{normal_formats, parallax_formats};
use crate::baker::Baker;
use crate::error::{Error, Result};
use crate::map::{Convention, HeightMap};
use crate::material::Material;
use crate::mesh::Mesh;
use crate::ops::Precision;
use crate::ops::bake::BakeOptions;
use crate::stream::Monitor;
use serde::Serialize;

/// How a map is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasureOptions {
    /// Scale, filter and edges; maps, formats and precision are measured, whatever is said here.
    pub bake: BakeOptions,
    /// Which way green points.
    pub convention: Convention,
    /// What pixels are drawn from.
    pub seed: u64,
    /// Runs of which a time is the median, after one that is not counted: 1 to 1000.
    pub runs: usize,
    /// Less: a smaller part of the map, fewer pixels, fewer elevations.
    pub quick: bool,
    /// The elevation, in degrees, that the fronts of parallax are for: 1 and more, below 90. What is seen from below 1
    /// degree is tens of heights away.
    pub elevation: f64,
}

impl Default for MeasureOptions {
    fn default() -> Self {
        let (bake, convention) = (BakeOptions::default(), Convention::default());
        Self { bake, convention, seed: 1, runs: 5, quick: false, elevation: 30.0 }
    }
}

/// What is measured.
pub struct Measured<'a> {
    /// The heights.
    pub heights: &'a HeightMap,
    /// The heights that are blended with them; without, the same heights turned by a quarter to the right.
    pub detail: Option<&'a HeightMap>,
    /// Meshes by name, besides the generated ones.
    pub models: &'a [(String, Mesh)],
    /// What bakes.
    pub devices: &'a [Baker],
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// The part of the map.
    pub region: Region,
    /// Its normal maps.
    pub normal_maps: Vec<NormalFigure>,
    /// Its parallax maps.
    pub parallax_maps: Vec<ParallaxFigure>,
    /// Blends of its normals with those of the detail.
    pub blends: Vec<BlendFigure>,
    /// Parallax methods, on `pixels` pixels each.
    pub offsets: Vec<OffsetFigure>,
    /// The same on GPUs, from the elevation of the fronts, on the middle 512 texels of the map.
    pub offset_times: Vec<OffsetTime>,
    /// Pixels that each parallax method is measured on.
    pub pixels: usize,
    /// Ways to tangent space.
    pub frames: Vec<FrameFigure>,
    /// What each step buys and costs.
    pub fronts: Vec<Front>,
    /// What could not be measured, and why.
    pub notes: Vec<String>,
}

impl MeasureOptions {
    fn check(&self) -> Result<()> {
        if !(1.0..90.0).contains(&self.elevation) {
            return Err(Error::parameter("elevation", self.elevation, "1 degree or more, and below 90"));
        }
        if !(1..=1000).contains(&self.runs) {
            return Err(Error::parameter("runs", self.runs, "from 1 to 1000"));
        }
        Ok(())
    }

    /// Fails if a ray along one of the axes cannot be followed; others cross fewer texels.
    fn check_views(&self, material: &Material) -> Result<()> {
        self.elevations().into_iter().try_for_each(|elevation| material.truth_at(elevation).map(drop))
    }

    /// The longest side of the part that is measured, in texels.
    fn side(&self) -> usize {
        if self.quick { 256 } else { 2048 }
    }

    fn pixels(&self) -> usize {
        if self.quick { 2048 } else { 16_384 }
    }

    /// The elevations that parallax is seen from, in degrees, from the steepest; that of the fronts is one.
    pub fn elevations(&self) -> Vec<f64> {
        let usual: &[f64] = if self.quick { &[60.0, 20.0] } else { &[80.0, 60.0, 45.0, 30.0, 20.0, 10.0] };
        let mut elevations = usual.to_vec();
        if !elevations.contains(&self.elevation) {
            elevations.push(self.elevation);
        }
        elevations.sort_by(|a, b| b.total_cmp(a));
        elevations
    }
}

/// Measures a map. Errors are the same for the same options and seed, whatever the machine does besides; times are not.
///
/// A map longer than 2048 texels on a side (256 in a quick run) is measured in its middle, which then is a map of its own.
/// The material of the parallax methods has the height map itself, 8-bit unorm normals and an 8-bit snorm parallax map;
/// pixels and mesh points are drawn from the seed.
///
/// # Errors
/// [`Error::Parameter`] for an option out of range; what a bake reports; [`Error::Cancelled`].
pub fn measure(
    measured: &Measured<'_>,
    options: &MeasureOptions,
    monitor: &Monitor,
    watch: &mut dyn FnMut(Progress<'_>),
) -> Result<Figures> {
    options.check()?;
    let (convention, runs, seed) = (options.convention, options.runs, options.seed);
    let size = measured.heights.size();
    let region = Region::middle(size, options.side());
    let heights = region.of(measured.heights)?;
    let axes = options.bake.scale.resolve(size)?;
    let bake = BakeOptions { scale: scale_for(axes, heights.size())?, precision: Precision::Exact, ..options.bake };
    let detail = match measured.detail {
        Some(detail) => Region::middle(detail.size(), options.side()).of(detail)?,
        None => quarter_turned(&heights)?,
    };
    let of_detail = BakeOptions { scale: scale_for(axes, detail.size())?, ..bake };
    let layers = Layers { base: (&heights, bake), detail: (&detail, of_detail) };
    let material = Material::bake(&Baker::cpu(), &heights, &BakeOptions { normal: None, parallax: None, ..bake })?;
    // Before hours of work.
    options.check_views(&material)?;

    let of = count(measured, options);
    let steps = &mut Steps { done: 0, of, monitor, watch };
    let (mut normal_maps, mut parallax_maps, mut blends) = (Vec::new(), Vec::new(), Vec::new());
    for device in measured.devices {
        normal_maps.extend(normal_figures(device, &heights, &bake, convention, runs, steps)?);
        parallax_maps.extend(parallax_figures(device, &heights, &bake, runs, steps)?);
        blends.extend(blend_figures(device, &layers, convention, runs, steps)?);
    }
    let pixels = options.pixels();
    let offsets = offset_figures(&material, &options.elevations(), pixels, seed, runs, steps)?;
    let (offset_times, notes) = offset_times(measured.devices, &heights, &bake, options, steps)?;
    let frames = frame_figures(&material, measured.models, Extent { pixels, seed, runs }, steps)?;
    let mut fronts = fronts::storage(&normal_maps, &parallax_maps);
    fronts.extend(fronts::times(&normal_maps, &parallax_maps, &blends));
    fronts.extend(fronts::parallax(&offsets, &offset_times, options.elevation));
    Ok(Figures { region, normal_maps, parallax_maps, blends, offsets, offset_times, pixels, frames, fronts, notes })
}

/// Steps of a measurement.
fn count(measured: &Measured<'_>, options: &MeasureOptions) -> usize {
    let maps = PRECISIONS.len() * (normal_formats(options.convention).len() + parallax_formats().len());
    let blends = blends::FORMATS.len() * blends::methods().len();
    let meshes = SURFACES.len() + measured.models.len();
    measured.devices.len() * (maps + blends) + options.elevations().len() + gpus(measured.devices) + meshes
}

/// The texels on a side of the map that GPUs are timed with: textures are uploaded for each run.
#[cfg(feature = "gpu")]
const SIDE_ON_GPU: usize = 512;

/// How long parallax methods take on the devices that are GPUs, and why on some they were not timed.
#[cfg(feature = "gpu")]
fn offset_times(
    devices: &[Baker],
    heights: &HeightMap,
    bake: &BakeOptions,
    options: &MeasureOptions,
    steps: &mut Steps<'_>,
) -> Result<(Vec<OffsetTime>, Vec<String>)> {
    let (mut times, mut notes) = (Vec::new(), Vec::new());
    if gpus(devices) == 0 {
        return Ok((times, notes));
    }
    let part = Region::middle(heights.size(), SIDE_ON_GPU).of(heights)?;
    let scale = scale_for(bake.scale.resolve(heights.size())?, part.size())?;
    let bake = BakeOptions { scale, normal: None, parallax: None, ..*bake };
    let material = Material::bake(&Baker::cpu(), &part, &bake)?;
    let seen = (options.elevation, options.pixels(), options.seed);
    for device in devices {
        match super::gpu_time::offset_times(device, &material, seen, options.runs, steps) {
            Ok(found) => times.extend(found),
            Err(Error::Device { adapter, reason }) => {
                notes.push(format!("parallax was not timed on {adapter}: {reason}"));
            }
            Err(error) => return Err(error),
        }
    }
    Ok((times, notes))
}

#[cfg(feature = "gpu")]
use super::gpu_time::gpus;

#[cfg(not(feature = "gpu"))]
fn offset_times(
    _: &[Baker],
    _: &HeightMap,
    _: &BakeOptions,
    _: &MeasureOptions,
    _: &mut Steps<'_>,
) -> Result<(Vec<OffsetTime>, Vec<String>)> {
    Ok(Default::default())
}

#[cfg(not(feature = "gpu"))]
fn gpus(_: &[Baker]) -> usize {
    0
}
