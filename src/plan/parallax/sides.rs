//! Where a material is looked at from, and what is right there.

use crate::error::Result;
use crate::map::HeightMap;
use crate::material::{Material, ParallaxMethod, Texture};
use crate::measure::{Errors, View, Views, digits, median_time};
use crate::ops::bake::BakeOptions;
use crate::plan::prediction::ErrorOf;
use crate::plan::view::Seen;
use crate::stream::Monitor;
use rayon::prelude::*;
use std::hint::black_box;

/// Pixels that are looked at from each elevation, each from its own side. A check looks at the same ones.
pub(super) const PIXELS: usize = 8192;
const SEED: u64 = 1;

/// Elevations from the shallowest one up.
const ELEVATIONS: u32 = 4;

/// Runs of which a time is the median.
const RUNS: usize = 5;

/// Pixels at several elevations with the offsets that are right there.
pub(in crate::plan) struct Sides {
    seen: Seen,
    /// Pixels that the texture covers along each axis.
    units: [f32; 2],
    /// The shallowest first.
    elevations: Vec<(Views, Vec<[f32; 2]>)>,
    /// The offset of a height of 0 or 1, whichever is farther away, where it is largest.
    largest: f64,
}

impl Sides {
    /// Looks at `material`, which has the maps of `heights`.
    pub fn new(
        heights: &HeightMap,
        options: &BakeOptions,
        material: &Material,
        seen: Seen,
        monitor: &Monitor,
    ) -> Result<Self> {
        let texels = material.texels();
        let units = [0, 1].map(|axis| texels[axis] * seen.pixels_per_texel[axis] as f32);
        let largest = largest_offset(heights, options, seen)?;
        let elevations = elevations(seen.angle).into_iter().map(|elevation| {
            let views = Views::at_elevation(elevation, PIXELS, SEED);
            let truth = views.truth(material, monitor)?;
            Ok((views, truth))
        });
        Ok(Self { seen, units, elevations: elevations.collect::<Result<_>>()?, largest })
    }

    /// The errors of a method in pixels, from where the one that counts is largest.
    pub fn errors(
        &self,
        material: &Material,
        method: ParallaxMethod,
        of: ErrorOf,
        monitor: &Monitor,
    ) -> Result<Errors> {
        let mut worst = Errors::default();
        for (views, truth) in &self.elevations {
            let errors = views.errors(material, method, truth, self.units, monitor)?;
            // What is no number is infinite there.
            if of.errors(errors) >= of.errors(worst) {
                worst = errors;
            }
        }
        if method == ParallaxMethod::None {
            // No pixel need have met the highest texel.
            worst.largest = self.largest;
        }
        Ok(worst)
    }

    /// Milliseconds that a screen of so many pixels takes on all threads of the CPU, at the shallowest elevation.
    pub fn milliseconds(&self, material: &Material, method: ParallaxMethod, screen: f64) -> f64 {
        let (views, _) = &self.elevations[0];
        let offset = |view: &View| _ = black_box(material.offset(method, black_box(view.uv), view.eye));
        let time = median_time(RUNS, || views.pixels().par_iter().for_each(offset));
        time.as_secs_f64() * 1e3 * screen / PIXELS as f64
    }

    /// Where it is looked at from: `8192 pixels at each of 20, 37.5, 55 and 72.5 degrees`.
    pub fn words(&self) -> String {
        let angles: Vec<String> = elevations(self.seen.angle).into_iter().map(digits).collect();
        match &angles[..] {
            [first @ .., last] if !first.is_empty() => {
                format!("{PIXELS} pixels at each of {} and {last} degrees", first.join(", "))
            }
            _ => format!("{PIXELS} pixels at {} degrees", angles.concat()),
        }
    }
}

/// From the shallowest angle up; straight from above nothing moves.
fn elevations(shallowest: f64) -> Vec<f64> {
    let step = (90.0 - shallowest) / f64::from(ELEVATIONS);
    let mut elevations: Vec<f64> = (0..ELEVATIONS).map(|i| shallowest + f64::from(i) * step).collect();
    elevations.dedup();
    elevations
}

/// The largest offset that can be seen at the shallowest angle a, in pixels: |2h - 1| s/2 cot a texels of the greatest
/// |2h - 1|, the offset of relief as high as it gets.
fn largest_offset(heights: &HeightMap, options: &BakeOptions, seen: Seen) -> Result<f64> {
    let scale = options.scale.resolve(heights.size())?;
    let [x, y] = seen.pixels_per_texel;
    let pixels = (f64::from(scale.x).abs() * x).max(f64::from(scale.y).abs() * y) / f64::from(scale.q);
    let heights = Texture::of_heights(heights, options.edges);
    let highest = heights.texels().iter().map(|[h]| (2.0 * f64::from(*h) - 1.0).abs()).fold(0.0, f64::max);
    // Straight from above the tangent is no exact infinity.
    let cotangent = if seen.angle == 90.0 { 0.0 } else { 1.0 / libm::tan(seen.angle.to_radians()) };
    Ok(highest / 2.0 * pixels * cotangent)
}
