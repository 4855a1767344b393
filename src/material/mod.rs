//! The maps of a material as a scene samples them, and the ways to look at their relief.
//!
//! Texture coordinates run from 0 to 1 over a map, u along the rows and v **down** them. Tangent space has x along growing
//! u and y along growing v.

mod intersection;
mod method;
mod texture;

pub use method::ParallaxMethod;
pub use texture::Texture;

use crate::baker::Baker;
use crate::error::{Error, Result};
use crate::exact::AxisScale;
use crate::map::{Edges, HeightMap, NormalMap, ParallaxMap, Size};
use crate::ops::bake::BakeOptions;
use crate::shading::{limited_offset, plane_offset, relief_offset, step_scale, stepped_offset, welsh_offset};
use crate::vector::normalized;

/// A material's height, normal and parallax map as textures, with what a shader needs to know of them.
///
/// ```
/// use texbake::material::{Material, ParallaxMethod};
/// use texbake::{BakeOptions, Baker, Grid, HeightMap, Scale};
///
/// let heights = HeightMap::from(Grid::from_fn(64, 64, |x, y| (x ^ y) as u8)?);
/// let options = BakeOptions { scale: Scale::texels(8), ..Default::default() };
/// let material = Material::bake(&Baker::cpu(), &heights, &options)?;
/// let (uv, eye) = ([0.5, 0.5], [0.6, 0.0, 0.8]);
/// let [x, _] = material.offset(ParallaxMethod::Limited, uv, eye);
/// assert!(x < 0.0); // the heights are below 1/2, and things that are deeper move away from the eye
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Material {
    heights: Texture<1>,
    normals: Texture<3>,
    parallax: Texture<1>,
    /// The scale s of each axis in texels.
    scale: [f32; 2],
}

impl Material {
    /// Bakes the maps of `heights`; a map whose format `options` leave out is baked in the default one.
    ///
    /// # Errors
    /// As [`Baker::bake`].
    pub fn bake(baker: &Baker, heights: &HeightMap, options: &BakeOptions) -> Result<Self> {
        let normal = options.normal.unwrap_or_default();
        let parallax = options.parallax.unwrap_or_default();
        let options = BakeOptions { normal: Some(normal), parallax: Some(parallax), ..*options };
        let maps = baker.bake(heights, &options)?;
        let (Some(normals), Some(parallax)) = (&maps.normal, &maps.parallax) else {
            unreachable!("both were asked for");
        };
        Ok(Self::of_maps(heights, normals, parallax, options.scale.resolve(heights.size())?, options.edges))
    }

    /// The material of maps that are there; they may have different sizes.
    pub fn of_maps(
        heights: &HeightMap,
        normals: &NormalMap,
        parallax: &ParallaxMap,
        scale: AxisScale,
        edges: Edges,
    ) -> Self {
        let axis = |part: i32| (f64::from(part) / f64::from(scale.q)) as f32;
        Self {
            heights: Texture::of_heights(heights, edges),
            normals: Texture::of_normals(normals, edges),
            parallax: Texture::of_parallax(parallax, edges),
            scale: [axis(scale.x), axis(scale.y)],
        }
    }

    /// Width and height of the height map in texels.
    pub fn size(&self) -> Size {
        self.heights.size()
    }

    /// The scale s in texels of the height map, for each axis.
    pub fn scale(&self) -> [f32; 2] {
        self.scale
    }

    /// The height of h = 1 in texture coordinates, s / r, for each axis.
    pub fn scale_in_uv(&self) -> [f32; 2] {
        let r = self.texels();
        [self.scale[0] / r[0], self.scale[1] / r[1]]
    }

    /// The heights, in [0, 1].
    pub fn heights(&self) -> &Texture<1> {
        &self.heights
    }

    /// The normals as stored, with y along growing v.
    pub fn normals(&self) -> &Texture<3> {
        &self.normals
    }

    /// The parallax map's n_z (2h - 1).
    pub fn parallax(&self) -> &Texture<1> {
        &self.parallax
    }

    /// The normal at texture coordinates, interpolated and normalised.
    pub fn normal(&self, uv: [f32; 2]) -> [f32; 3] {
        normalized(self.normals.sample(uv))
    }

    /// By how much `method` moves the texture coordinates of the pixel at `uv` whose eye is in the direction `eye`, of
    /// length one, in tangent space, with z above zero.
    pub fn offset(&self, method: ParallaxMethod, uv: [f32; 2], eye: [f32; 3]) -> [f32; 2] {
        let scale = self.scale_in_uv();
        let bias = scale.map(|s| -s / 2.0);
        let height = |uv| self.heights.sample(uv)[0];
        match method {
            ParallaxMethod::None => [0.0; 2],
            ParallaxMethod::Welsh => welsh_offset(height(uv), scale, bias, eye),
            ParallaxMethod::Limited => limited_offset(height(uv), scale, bias, eye),
            ParallaxMethod::Plane { limit } => {
                let [x, y] = plane_offset(self.normal(uv), height(uv) - 0.5, eye, limit);
                [x * scale[0], y * scale[1]]
            }
            ParallaxMethod::Steps { k } => {
                stepped_offset(|uv| self.parallax.sample(uv)[0], uv, eye, self.step(method), k)
            }
            ParallaxMethod::Relief { steps, bisections } => relief_offset(height, uv, eye, scale, steps, bisections),
        }
    }

    /// What a step of `method` through the parallax map multiplies the eye by.
    pub(crate) fn step(&self, method: ParallaxMethod) -> [f32; 2] {
        match method {
            ParallaxMethod::Steps { k } => step_scale(self.scale, self.texels(), k, 1.0),
            _ => [0.0; 2],
        }
    }

    /// Where the pixel at `uv` sees the relief, as an offset of texture coordinates: what every [`Material::offset`] is
    /// measured against. Between the centres of texels the heights are bilinear, and the ray meets them at a root, so
    /// that no step misses a bump.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the ray crosses more than 16 384 texels on its way through the relief.
    pub fn intersection(&self, uv: [f32; 2], eye: [f32; 3]) -> Result<[f32; 2]> {
        self.check_slant(eye)?;
        let [x, y, z] = eye.map(f64::from);
        let texels = self.texels().map(f64::from);
        let side = if self.scale[0] < 0.0 { -1.0 } else { 1.0 };
        let slant = [x / z * side * f64::from(self.scale[0]), y / z * side * f64::from(self.scale[1])];
        let at = [0, 1].map(|axis| f64::from(uv[axis]) * texels[axis]);
        let offset = intersection::intersection(&self.heights, at, slant, side);
        Ok([0, 1].map(|axis| (offset[axis] / texels[axis]) as f32))
    }

    /// The march that pictures show as the truth: no step crosses more than a quarter of a texel, and bisection goes on
    /// to the last bits.
    ///
    /// # Errors
    /// As [`Material::intersection`].
    pub fn truth(&self, eye: [f32; 3]) -> Result<ParallaxMethod> {
        let texels = self.check_slant(eye)?;
        Ok(ParallaxMethod::Relief { steps: (4.0 * texels).max(16.0).ceil() as u32, bisections: 16 })
    }

    /// The truth for eyes at so many degrees above the surface, on whichever side: along the axis that takes more steps.
    ///
    /// # Errors
    /// As [`Material::truth`].
    pub fn truth_at(&self, elevation: f64) -> Result<ParallaxMethod> {
        let (z, across) = libm::sincos(elevation.to_radians());
        let along = |axis: usize| {
            let mut eye = [0.0, 0.0, z as f32];
            eye[axis] = across as f32;
            self.truth(eye)
        };
        let (x, y) = (along(0)?, along(1)?);
        Ok(if x.fetches() >= y.fetches() { x } else { y })
    }

    /// How many texels the ray crosses on its way through the relief, if it can be followed.
    fn check_slant(&self, [x, y, z]: [f32; 3]) -> Result<f32> {
        const MOST: f32 = 16_384.0;
        let texels = (self.scale[0] * x).hypot(self.scale[1] * y) / z;
        if texels <= MOST {
            return Ok(texels);
        }
        let scale = self.scale[0].abs().max(self.scale[1].abs());
        let elevation = (z.atan2(x.hypot(y)).to_degrees() * 1e3).round() / 1e3;
        let range = format!("at most {} texels to be seen from {elevation} degrees", (scale * MOST / texels).floor());
        Err(Error::parameter("scale", scale, range))
    }

    /// Texels of the height map along each axis.
    pub fn texels(&self) -> [f32; 2] {
        [self.size().width() as f32, self.size().height() as f32]
    }
}
