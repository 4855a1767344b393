//! Every parallax method over the angles from which a surface is seen.

use super::steps::Steps;
use super::{Errors, Views};
use crate::error::Result;
use crate::material::{Material, ParallaxMethod};
use serde::Serialize;

/// A parallax method at one elevation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OffsetFigure {
    /// The angle between the view and the surface: 90 is straight from above.
    pub elevation_degrees: f64,
    /// The method, as [`ParallaxMethod`] prints it.
    pub method: String,
    /// Lookups of a map for each pixel, at most.
    pub fetches: u32,
    /// Distances to the offsets of relief intersection.
    pub error_texels: Errors,
    /// Time on one thread of the CPU, by the functions of [`crate::shading`]: the median.
    pub nanoseconds_per_pixel: f64,
}

/// The time of a parallax method on a GPU.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OffsetTime {
    /// The GPU.
    pub device: String,
    /// The angle between the view and the surface.
    pub elevation_degrees: f64,
    /// The method, as [`ParallaxMethod`] prints it.
    pub method: String,
    /// Time by the WGSL of the shader library, of many pixels at once: the median. Nothing where the longest dispatch is
    /// not told from one that moves no pixel.
    pub nanoseconds_per_pixel: Option<f64>,
}

/// Every method: none, Welsh's, limited, planes with two limits, k steps up to 16, and relief intersection by few steps
/// and by many.
pub fn parallax_methods() -> Vec<ParallaxMethod> {
    let single = [
        ParallaxMethod::None,
        ParallaxMethod::Welsh,
        ParallaxMethod::Limited,
        ParallaxMethod::Plane { limit: 1.0 },
        ParallaxMethod::Plane { limit: 3.0 },
    ];
    let stepped = (1..=16).map(ParallaxMethod::steps);
    let relief = [8, 16, 32, 64].map(|steps| ParallaxMethod::Relief { steps, bisections: 5 });
    single.into_iter().chain(stepped).chain(relief).collect()
}

/// Every method at every elevation, on `pixels` pixels.
pub(super) fn offset_figures(
    material: &Material,
    elevations: &[f64],
    pixels: usize,
    seed: u64,
    runs: usize,
    steps: &mut Steps<'_>,
) -> Result<Vec<OffsetFigure>> {
    let mut figures = Vec::new();
    for &elevation in elevations {
        steps.next(&format!("parallax from {elevation} degrees"))?;
        let views = Views::at_elevation(elevation, pixels, seed);
        let truth = views.truth(material, steps.monitor)?;
        for method in parallax_methods() {
            figures.push(OffsetFigure {
                elevation_degrees: elevation,
                method: method.to_string(),
                fetches: method.fetches(),
                error_texels: views.errors(material, method, &truth, material.texels(), steps.monitor)?,
                nanoseconds_per_pixel: views.nanoseconds(material, method, runs),
            });
        }
    }
    Ok(figures)
}
