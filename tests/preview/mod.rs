//! Pictures: lit from where the light is, bumps out, and the same on every device.

mod command;
mod devices;
mod models;
mod panels;
mod raster;
mod sheets;

use texbake::material::Material;
use texbake::preview::{Camera, Light, Look, Samples, Shot, Surface};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, Convention, Depth, Encoding, Grid, HeightMap, NormalFormat, ParallaxFormat, Scale};

/// Square maps have so many texels on a side.
const SIDE: usize = 64;
const SCALE: i32 = 8;

/// 16-bit heights of (x, y) in [0, 1], at the centres of texels.
fn heights(height: impl Fn(f64, f64) -> f64) -> HeightMap {
    heights_of([SIDE; 2], height)
}

/// The same of a map of any width and height.
fn heights_of([width, height]: [usize; 2], of: impl Fn(f64, f64) -> f64) -> HeightMap {
    let at = |i: usize, texels: usize| (i as f64 + 0.5) / texels as f64;
    let code = |x, y| (65_535.0 * of(at(x, width), at(y, height)).clamp(0.0, 1.0)).round() as u16;
    Grid::from_fn(width, height, code).unwrap().into()
}

/// A pyramid with its top in the middle: one code in 65535 for each face's slope.
fn pyramid() -> HeightMap {
    heights(|x, y| 1.0 - 2.0 * (x - 0.5).abs().max((y - 0.5).abs()))
}

/// Hills that are nowhere as steep as the ray from 25 degrees.
fn hills() -> HeightMap {
    heights(|x, y| 0.5 + 0.22 * (TAU * x).sin() + 0.22 * (TAU * (2.0 * y + x)).cos())
}

const TAU: f64 = std::f64::consts::TAU;

fn format(convention: Convention) -> NormalFormat {
    NormalFormat { encoding: Encoding::Snorm, depth: Depth::Bits16, convention, ..NormalFormat::default() }
}

fn options(convention: Convention) -> BakeOptions {
    let parallax = ParallaxFormat { encoding: Encoding::Snorm, depth: Depth::Bits16 };
    BakeOptions {
        scale: Scale::texels(SCALE),
        normal: Some(format(convention)),
        parallax: Some(parallax),
        ..Default::default()
    }
}

fn material(heights: &HeightMap, convention: Convention) -> Material {
    Material::bake(&Baker::cpu(), heights, &options(convention)).unwrap()
}

/// Gentle hills of 64 x 16 texels over a plane of 2 x 1, so that a height is 8 texels along x and 4 along y.
fn wide() -> Material {
    let hills = heights_of([SIDE, 16], |x, y| 0.5 + 0.2 * (TAU * x).sin() + 0.12 * (TAU * (x + y)).cos());
    let scale = Scale::physical(2.into(), 1.into(), "0.25".parse().unwrap());
    Material::bake(&Baker::cpu(), &hills, &BakeOptions { scale, ..options(Convention::Gl) }).unwrap()
}

/// White, without highlights.
fn plain(azimuth: f32) -> Look {
    let light = Light { azimuth, ..Light::default() };
    Look { light, highlight: 0.0, low: [1.0; 3], high: [1.0; 3], ..Look::default() }
}

/// From straight above a sample is a texel.
fn from_above(material: &Material, surface: Surface, look: Look) -> Samples {
    let camera = Camera { elevation: 90.0, width: 1.0 };
    let shot = Shot { material, surface, camera, look, count: [SIDE as u32; 2] };
    shot.on_cpu(&Monitor::default()).unwrap()
}
