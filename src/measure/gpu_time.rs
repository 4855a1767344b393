//! How long parallax methods take on a GPU, by the WGSL of the shader library.

use super::maps::timed;
use super::parallax::{OffsetTime, parallax_methods};
use super::steps::Steps;
use super::{View, Views};
use crate::backend::gpu::{Binding, OwnPipeline};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{Edges, Size};
use crate::material::{Material, ParallaxMethod};
use half::f16;
use std::time::Duration;

/// What a dispatch takes at least, beside one that computes nothing, so that a clock can tell.
const LONG_ENOUGH: Duration = Duration::from_millis(20);

/// Invocations for each pixel, and offsets for each invocation, at most: powers of four.
const MOST: (u32, u32) = (64, 1024);

/// The share of a dispatch's time by which it must be longer than one without offsets, to be told from it.
const NOISE: f64 = 0.05;

/// The kernel, and the functions that it calls.
pub(crate) const WGSL: &str = concat!(
    include_str!("../../kernels/offset_time.wgsl"),
    include_str!("../../kernels/shared/parallax_method.wgsl"),
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
    let scene = Scene::new(gpu.compile(WGSL, "time_offsets", &[])?, material, &views, runs);
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
    material: &'a Material,
    views: Vec<u32>,
    textures: [Vec<u32>; 4],
    runs: usize,
}

impl<'a> Scene<'a> {
    fn new(pipeline: OwnPipeline<'a>, material: &'a Material, views: &Views, runs: usize) -> Self {
        // Floats of 16 bits are what every device filters.
        let word = |value: f32| f16::from_f32(value).to_f32().to_bits();
        let heights = material.heights().texels().iter().map(|[h]| word(*h)).collect();
        let parallax = material.parallax().texels().iter().map(|[p]| word(*p)).collect();
        let normals = |axis: usize| material.normals().texels().iter().map(|m| word(m[axis])).collect();
        let pixel = |view: &View| {
            let ([u, v], [x, y, z]) = (view.uv, view.eye);
            [u, v, x, y, z].map(f32::to_bits)
        };
        let views = views.pixels().iter().flat_map(pixel).collect();
        Self { pipeline, material, views, textures: [heights, parallax, normals(0), normals(1)], runs }
    }

    /// Nanoseconds that a pixel takes, by dispatches that grow until they are long enough; nothing where the longest one
    /// is not told from one without offsets.
    fn nanoseconds(&self, method: ParallaxMethod) -> Result<Option<f64>> {
        let (mut copies, mut rounds) = (1, 1);
        loop {
            let without = self.time(method, copies, 0)?;
            let time = self.time(method, copies, rounds)?.saturating_sub(without);
            if time >= LONG_ENOUGH || (copies, rounds) == MOST {
                let offsets = f64::from(self.pixels()) * f64::from(copies) * f64::from(rounds);
                let is_told = time.as_secs_f64() > NOISE * without.as_secs_f64();
                return Ok(is_told.then(|| time.as_secs_f64() * 1e9 / offsets));
            }
            *(if copies < MOST.0 { &mut copies } else { &mut rounds }) *= 4;
        }
    }

    /// How long a dispatch takes, with all that goes to the device and comes back.
    fn time(&self, method: ParallaxMethod, copies: u32, rounds: u32) -> Result<Duration> {
        timed(self.runs, || self.sums(method, copies, rounds))
    }

    /// For each pixel, `copies` times, the sum of the texture coordinates to which `rounds` places are moved, as words.
    fn sums(&self, method: ParallaxMethod, copies: u32, rounds: u32) -> Result<Vec<u32>> {
        let count = self.pixels() * copies;
        let vectors = [self.material.scale_in_uv(), self.material.step(method)];
        let vectors = vectors.as_flattened().iter().map(|part| part.to_bits());
        let job: Vec<u32> = method.words().into_iter().chain(vectors).chain([rounds, self.pixels()]).collect();
        // A NaN is no place.
        let poison = vec![f32::NAN.to_bits(); 2 * count as usize];
        let [heights, parallax, x, y] =
            self.textures.each_ref().map(|words| (Binding::Texture(self.size()), &words[..]));
        let buffers = [
            (Binding::Uniform, &job[..]),
            (Binding::Read, &self.views[..]),
            (Binding::ReadWrite, &poison[..]),
            heights,
            parallax,
            x,
            y,
            (Binding::Sampler(Edges::default()), &[]),
        ];
        let written = self.pipeline.run(&buffers, [count.div_ceil(64), 1, 1])?;
        Ok(written.into_iter().flatten().collect())
    }

    fn pixels(&self) -> u32 {
        (self.views.len() / 5) as u32
    }

    fn size(&self) -> Size {
        self.material.size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Grid, HeightMap};
    use crate::ops::bake::BakeOptions;
    use crate::{Depth, Encoding, NormalFormat, ParallaxFormat, Scale};
    use std::f64::consts::TAU;

    const ELEVATION: f64 = 40.0;
    const ROUNDS: u32 = 3;

    /// How far a place of a device may be from the CPU's, in texture coordinates.
    fn bound() -> f64 {
        let highest = 1.0 / 8.0;
        let cotangent = 1.0 / ELEVATION.to_radians().tan();
        // Texels are halves, up to 2^-12 off, and weights between them have 8 bits: neighbours differ by 0.1 in all. The
        // relief rises by 0.16 where the ray falls by 0.84, so that what is off by one is met 1.25 farther.
        let height = 1.25 * (2f64.powi(-12) + 0.1 / 256.0);
        // Relief in 8 steps that are halved 5 times ends in either of two cells.
        let cell = 1.0 / 8.0 / 32.0;
        highest * cotangent * (height + cell)
    }

    /// A wave of another length, another scale and another number of texels along each axis.
    fn material() -> Material {
        let wave = |at: usize, of: usize| (TAU * at as f64 / of as f64).sin();
        let heights = Grid::from_fn(64, 16, |x, y| (0.5 + 0.2 * (wave(x, 64) + wave(y, 16))) as f32).unwrap();
        let heights = HeightMap::try_from(heights).unwrap();
        let (encoding, depth) = (Encoding::Float, Depth::Float32);
        let options = BakeOptions {
            scale: Scale::physical(2.into(), 1.into(), "1/8".parse().unwrap()),
            normal: Some(NormalFormat { encoding, depth, ..Default::default() }),
            parallax: Some(ParallaxFormat { encoding, depth }),
            ..Default::default()
        };
        Material::bake(&Baker::cpu(), &heights, &options).unwrap()
    }

    /// How far a device's places are from the CPU's at most, by any method.
    fn largest_difference(device: &Baker, wgsl: &str) -> f64 {
        let (material, views) = (material(), Views::at_elevation(ELEVATION, 500, 1));
        let pipeline = device.gpu_device().unwrap().compile(wgsl, "time_offsets", &[]).unwrap();
        let scene = Scene::new(pipeline, &material, &views, 1);
        let of = |method| {
            let sums = scene.sums(method, 2, ROUNDS).unwrap();
            assert_eq!(sums.len(), 2 * 2 * 500);
            let (sums, _) = sums.as_chunks::<2>();
            let difference = |(sum, view): (&[u32; 2], &View)| {
                let moved = |round: u32| {
                    let uv = [0, 1].map(|axis| view.uv[axis] + round as f32 * [0.618_034, 0.414_214][axis]);
                    let offset = material.offset(method, uv, view.eye);
                    [0, 1].map(|axis| f64::from(uv[axis]) + f64::from(offset[axis]))
                };
                let off = |axis: usize| {
                    let expected: f64 = (0..ROUNDS).map(|round| moved(round)[axis]).sum();
                    (f64::from(f32::from_bits(sum[axis])) - expected).abs() / f64::from(ROUNDS)
                };
                off(0).hypot(off(1))
            };
            let differences = sums.iter().zip(views.pixels().iter().cycle()).map(difference);
            differences.fold(0.0, |a, b| if b.is_nan() { f64::INFINITY } else { f64::max(a, b) })
        };
        parallax_methods().into_iter().map(of).fold(0.0, f64::max)
    }

    #[test]
    fn what_is_timed_are_the_offsets() {
        let Ok(device) = Baker::gpu(Some("vulkan:llvmpipe")) else {
            assert!(std::env::var_os("TEXBAKE_REQUIRE_GPU").is_none(), "no lavapipe");
            return eprintln!("skipped: no lavapipe");
        };
        let off = largest_difference(&device, WGSL);
        assert!(off <= bound(), "{off} is above {}", bound());
        for (what, from, to) in [
            ("scales exchanged", "v, job.scale,", "v, job.scale.yx,"),
            ("steps exchanged", "job.step)", "job.step.yx)"),
            ("normals exchanged", "vec3<f32>(x, y,", "vec3<f32>(y, x,"),
            ("half of the offset", "uv + parallax_offset", "uv + 0.5 * parallax_offset"),
            ("another method", "METHOD_LIMITED = 2u", "METHOD_LIMITED = 9u"),
            ("a sum that is not written", "sums[id.x] = sum", "sums[id.x / 2u] = sum"),
        ] {
            assert!(WGSL.contains(from), "{what}: the kernel has no {from:?}");
            let off = largest_difference(&device, &WGSL.replacen(from, to, 1));
            assert!(off > 3.0 * bound(), "{what}: {off}");
        }
    }

    #[test]
    fn the_kernel_is_valid_and_has_no_atomics() {
        let module = naga::front::wgsl::parse_str(WGSL).unwrap();
        let flags = naga::valid::ValidationFlags::all();
        naga::valid::Validator::new(flags, naga::valid::Capabilities::empty()).validate(&module).unwrap();
        assert!(!module.types.iter().any(|(_, ty)| matches!(ty.inner, naga::TypeInner::Atomic(_))));
    }
}
