//! How long parallax methods take on a GPU, by the WGSL of the shader library.

use super::maps::timed;
use super::parallax::{OffsetTime, parallax_methods};
use super::steps::Steps;
use super::{View, Views};
use crate::backend::gpu::{Binding, OwnPipeline};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::Size;
use crate::material::{Material, ParallaxMethod};
use half::f16;
use std::time::Duration;

/// What a dispatch takes at least, beside one that computes nothing, so that a clock can tell.
const LONG_ENOUGH: Duration = Duration::from_millis(20);

/// Invocations for each pixel, and offsets for each invocation, at most: powers of four.
const MOST: (u32, u32) = (64, 1024);

/// The kernel, and the functions that it calls.
const TEXT: &str = concat!(
    include_str!("offset_time.wgsl"),
    include_str!("../../kernels/shading/welsh_offset.wgsl"),
    include_str!("../../kernels/shading/plane_offset.wgsl"),
    include_str!("../../kernels/shading/stepped_offset.wgsl"),
    include_str!("../../kernels/shading/relief_offset.wgsl"),
);

/// Every method on a device, seen from one elevation; nothing where it is no GPU.
///
/// A time is that of a dispatch less that of one without offsets, over the number of offsets. Textures have one channel of
/// floats, so that the plane of a texel takes three lookups: of its height, and of x and y of its normal.
pub(super) fn offset_times(
    device: &Baker,
    material: &Material,
    (elevation, pixels, seed): (f64, usize, u64),
    runs: usize,
    steps: &mut Steps<'_>,
) -> Result<Vec<OffsetTime>> {
    let Some(gpu) = device.gpu_device() else { return Ok(Vec::new()) };
    steps.next(&format!("parallax on {}", device.name()))?;
    let views = Views::at_elevation(elevation, pixels, seed);
    let scene = Scene::new(gpu.compile(TEXT, "time_offsets", &[])?, material, &views, runs);
    let time = |method: ParallaxMethod| {
        steps.monitor.check()?;
        Ok(OffsetTime {
            device: device.name(),
            elevation_degrees: elevation,
            method: method.to_string(),
            nanoseconds_per_pixel: scene.nanoseconds(method)?,
        })
    };
    parallax_methods().into_iter().map(time).collect()
}

/// Devices that are timed.
pub(super) fn gpus(devices: &[Baker]) -> usize {
    devices.iter().filter(|device| device.gpu_device().is_some()).count()
}

/// A material and pixels, ready for a device.
struct Scene<'a> {
    pipeline: OwnPipeline<'a>,
    scale: [f32; 2],
    views: Vec<u32>,
    textures: [Vec<u32>; 4],
    size: Size,
    runs: usize,
}

impl<'a> Scene<'a> {
    fn new(pipeline: OwnPipeline<'a>, material: &Material, views: &Views, runs: usize) -> Self {
        // Floats of 16 bits are what every device filters.
        let word = |value: f32| f16::from_f32(value).to_f32().to_bits();
        let heights = material.heights().texels().iter().map(|[h]| word(*h)).collect();
        let parallax = material.parallax().texels().iter().map(|[p]| word(*p)).collect();
        let normals = |axis: usize| material.normals().texels().iter().map(|m| word(m[axis])).collect();
        let pixel = |view: &View| {
            let ([u, v], [x, y, z]) = (view.uv, view.eye);
            [u, v, x, y, z].map(f32::to_bits)
        };
        Self {
            pipeline,
            scale: material.scale_in_uv(),
            views: views.pixels().iter().flat_map(pixel).collect(),
            textures: [heights, parallax, normals(0), normals(1)],
            size: material.size(),
            runs,
        }
    }

    /// Nanoseconds that a pixel takes, by dispatches that grow until they are long enough.
    fn nanoseconds(&self, method: ParallaxMethod) -> Result<f64> {
        let (mut copies, mut rounds) = (1, 1);
        loop {
            let without = self.time(method, copies, 0)?;
            let time = self.time(method, copies, rounds)?.saturating_sub(without);
            if time >= LONG_ENOUGH || (copies, rounds) == MOST {
                let offsets = self.views.len() as f64 / 5.0 * f64::from(copies) * f64::from(rounds);
                return Ok(time.as_secs_f64() * 1e9 / offsets);
            }
            *(if copies < MOST.0 { &mut copies } else { &mut rounds }) *= 4;
        }
    }

    /// How long a dispatch takes, with all that goes to the device and comes back.
    fn time(&self, method: ParallaxMethod, copies: u32, rounds: u32) -> Result<Duration> {
        let pixels = (self.views.len() / 5) as u32;
        let (kind, steps, bisections, limit) = match method {
            ParallaxMethod::None => (0, 0, 0, 0.0),
            ParallaxMethod::Welsh => (1, 0, 0, 0.0),
            ParallaxMethod::Limited => (2, 0, 0, 0.0),
            ParallaxMethod::Plane { limit } => (3, 0, 0, limit),
            ParallaxMethod::Steps { k } => (4, k.get(), 0, 0.0),
            ParallaxMethod::Relief { steps, bisections } => (5, steps, bisections, 0.0),
        };
        let [x, y] = self.scale.map(f32::to_bits);
        let job = [kind, steps, bisections, rounds, x, y, limit.to_bits(), pixels];
        let sums = vec![0; (pixels * copies) as usize];
        let texture = |i: usize| (Binding::Texture(self.size), &self.textures[i][..]);
        let buffers = [
            (Binding::Uniform, &job[..]),
            (Binding::Read, &self.views[..]),
            (Binding::ReadWrite, &sums[..]),
            texture(0),
            texture(1),
            texture(2),
            texture(3),
            (Binding::Sampler, &[]),
        ];
        timed(self.runs, || self.pipeline.run(&buffers, [(pixels * copies).div_ceil(64), 1, 1]))
    }
}
