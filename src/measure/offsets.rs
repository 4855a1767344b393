//! How far parallax methods are from the relief that they stand for.

use super::{Errors, median_time};
use crate::material::{Material, ParallaxMethod};
use crate::split_mix::SplitMix;
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
        let mut unit = move || (random.bits() >> 11) as f64 / (1u64 << 53) as f64;
        let (z, across) = elevation.to_radians().sin_cos();
        let pixel = |_| {
            let uv = [unit() as f32, unit() as f32];
            let (sin, cos) = (std::f64::consts::TAU * unit()).sin_cos();
            View { uv, eye: [across * cos, across * sin, z].map(|part| part as f32) }
        };
        Self { pixels: (0..count).map(pixel).collect() }
    }

    /// The pixels.
    pub fn pixels(&self) -> &[View] {
        &self.pixels
    }

    /// The offsets that relief intersection gives, in texture coordinates.
    pub fn truth(&self, material: &Material) -> Vec<[f32; 2]> {
        self.pixels.par_iter().map(|view| material.offset(material.truth(view.eye), view.uv, view.eye)).collect()
    }

    /// How far `method` is from `truth`, in texels.
    pub fn errors(&self, material: &Material, method: ParallaxMethod, truth: &[[f32; 2]]) -> Errors {
        let size = material.size();
        let texels = [size.width() as f32, size.height() as f32];
        let error = |(view, truth): (&View, &[f32; 2])| {
            let offset = material.offset(method, view.uv, view.eye);
            ((offset[0] - truth[0]) * texels[0]).hypot((offset[1] - truth[1]) * texels[1])
        };
        Errors::of(self.pixels.par_iter().zip(truth).map(error).collect())
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
