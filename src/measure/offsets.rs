//! How far parallax methods are from the relief that they stand for.

use super::Errors;
use super::time::median_time;
use crate::error::Result;
use crate::material::{Material, ParallaxMethod};
use crate::split_mix::SplitMix;
use crate::stream::Monitor;
use rayon::prelude::*;
use std::hint::black_box;

/// Pixels from which a material is looked at, spread over it at random, each from its own side.
#[derive(Debug, Clone)]
pub struct Views {
    pixels: Vec<View>,
}

/// A pixel: its texture coordinates, and the direction to its eye in tangent space, of length one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where the ray from the eye meets the plane that is textured.
    pub uv: [f32; 2],
    /// Towards the eye.
    pub eye: [f32; 3],
}

impl Views {
    /// `count` pixels that see the surface at `elevation` degrees, between 0 and 90: 90 is straight from above.
    pub fn at_elevation(elevation: f64, count: usize, seed: u64) -> Self {
        let mut random = SplitMix(seed);
        let (z, across) = elevation.to_radians().sin_cos();
        let pixel = |_| {
            let uv = [random.unit() as f32, random.unit() as f32];
            let (sin, cos) = (std::f64::consts::TAU * random.unit()).sin_cos();
            View { uv, eye: [across * cos, across * sin, z].map(|part| part as f32) }
        };
        Self { pixels: (0..count).map(pixel).collect() }
    }

    /// The pixels.
    pub fn pixels(&self) -> &[View] {
        &self.pixels
    }

    /// The offsets that relief intersection gives, in texture coordinates.
    ///
    /// # Errors
    /// As [`Material::intersection`]; [`crate::Error::Cancelled`].
    pub fn truth(&self, material: &Material, monitor: &Monitor) -> Result<Vec<[f32; 2]>> {
        self.each(monitor, |view| material.intersection(view.uv, view.eye))
    }

    /// The offsets that `method` gives, in texture coordinates.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn offsets(&self, material: &Material, method: ParallaxMethod, monitor: &Monitor) -> Result<Vec<[f32; 2]>> {
        self.each(monitor, |view| Ok(material.offset(method, view.uv, view.eye)))
    }

    /// How far `method` is from `truth`, in units of which each axis of the texture has as many as `units` says:
    /// [`Material::texels`], or the pixels that it covers.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn errors(
        &self,
        material: &Material,
        method: ParallaxMethod,
        truth: &[[f32; 2]],
        units: [f32; 2],
        monitor: &Monitor,
    ) -> Result<Errors> {
        let offsets = self.offsets(material, method, monitor)?;
        Ok(Errors::of(offsets.iter().zip(truth).map(|(&offset, &truth)| distance(offset, truth, units)).collect()))
    }

    /// Relief takes thousands of lookups for a pixel: each asks whether it is still wanted.
    fn each(&self, monitor: &Monitor, offset: impl Fn(&View) -> Result<[f32; 2]> + Sync) -> Result<Vec<[f32; 2]>> {
        self.pixels.par_iter().map(|view| monitor.check().and_then(|()| offset(view))).collect()
    }

    /// Nanoseconds that a pixel takes by `method` on one thread of the CPU: the median of `runs` runs.
    pub fn nanoseconds(&self, material: &Material, method: ParallaxMethod, runs: usize) -> f64 {
        let time = median_time(runs, || {
            for view in &self.pixels {
                black_box(material.offset(method, black_box(view.uv), view.eye));
            }
        });
        time.as_secs_f64() * 1e9 / self.pixels.len() as f64
    }
}

/// How far texture coordinates are from others, in units of which each axis has as many as `units` says.
pub(crate) fn distance(a: [f32; 2], b: [f32; 2], units: [f32; 2]) -> f32 {
    ((a[0] - b[0]) * units[0]).hypot((a[1] - b[1]) * units[1])
}
