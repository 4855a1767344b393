//! One look at a plane.

use super::camera::{Camera, Rays};
use super::limits::{SAMPLES, check_method, within};
use super::look::Look;
use crate::error::Result;
use crate::material::{Material, ParallaxMethod};
use crate::stream::Monitor;
use rayon::prelude::*;
use std::fmt;

/// What is done with a material's maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surface {
    /// Nothing but its colours.
    Flat,
    /// The normal map, at texture coordinates that a parallax method has moved.
    Mapped(ParallaxMethod),
    /// The same by relief intersection in steps that are fine enough for each ray: the truth.
    Truth,
}

impl fmt::Display for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flat => f.pad("flat"),
            Self::Mapped(ParallaxMethod::None) => f.pad("normal mapped"),
            Self::Mapped(ParallaxMethod::Welsh) => f.pad("Welsh"),
            Self::Mapped(ParallaxMethod::Limited) => f.pad("Welsh, limited"),
            Self::Mapped(ParallaxMethod::Steps { k }) if k.get() == 1 => f.pad("1 step"),
            Self::Mapped(ParallaxMethod::Steps { k }) => f.pad(&format!("{k} steps")),
            Self::Mapped(method) => method.fmt(f),
            Self::Truth => f.pad("relief: the truth"),
        }
    }
}

/// One look at a plane that wears a material.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// What it wears.
    pub material: &'a Material,
    /// How its maps are used.
    pub surface: Surface,
    /// Where the eye is.
    pub camera: Camera,
    /// Light and colours.
    pub look: Look,
    /// Samples across and down, each from 1 to 8192.
    pub count: [u32; 2],
}

/// What each sample of a shot sees, in rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Linear colours.
    pub colours: Vec<[f32; 3]>,
    /// By how much texture coordinates were moved.
    pub offsets: Vec<[f32; 2]>,
}

impl Shot<'_> {
    /// Its rays.
    pub fn rays(&self) -> Rays {
        self.camera.rays(self.material, self.count)
    }

    /// What moves the texture coordinates; the truth is [`Material::truth`] of the shallowest ray.
    ///
    /// # Errors
    /// As [`Material::truth`].
    pub fn method(&self) -> Result<ParallaxMethod> {
        match self.surface {
            Surface::Flat => Ok(ParallaxMethod::None),
            Surface::Mapped(method) => Ok(method),
            Surface::Truth => self.material.truth(self.rays().shallowest()),
        }
    }

    /// Fails if a number is outside its range.
    pub(super) fn check(&self) -> Result<()> {
        self.camera.check()?;
        self.count.iter().try_for_each(|&count| within("samples on a side", count, &SAMPLES))?;
        check_method(self.method()?)
    }

    /// The samples, computed on all cores.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] if elevation, width, count or steps are outside their ranges;
    /// [`crate::Error::Cancelled`] if `monitor` says so.
    pub fn on_cpu(&self, monitor: &Monitor) -> Result<Samples> {
        self.check()?;
        let (rays, method, light) = (self.rays(), self.method()?, self.look.light.direction());
        let [across, down] = self.count;
        let row = |y| {
            monitor.check()?;
            Ok((0..across).map(|x| self.sample(&rays, method, light, [x, y])).collect())
        };
        let rows: Result<Vec<Vec<_>>> = (0..down).into_par_iter().map(row).collect();
        let (colours, offsets) = rows?.into_iter().flatten().unzip();
        Ok(Samples { colours, offsets })
    }

    /// Colour and offset of a sample; `kernels/preview.wgsl` does the same.
    fn sample(&self, rays: &Rays, method: ParallaxMethod, light: [f32; 3], [x, y]: [u32; 2]) -> ([f32; 3], [f32; 2]) {
        let view = rays.at(x as f32 + 0.5, y as f32 + 0.5);
        let offset = self.material.offset(method, view.uv, view.eye);
        let uv = [view.uv[0] + offset[0], view.uv[1] + offset[1]];
        let colour = self.look.colour(self.material.heights().sample(uv)[0]);
        let normal = match self.surface {
            Surface::Flat => [0.0, 0.0, 1.0],
            Surface::Mapped(_) | Surface::Truth => self.material.normal(uv),
        };
        (self.look.lit(colour, normal, light, view.eye), offset)
    }
}
