//! How far the texels of baked maps are from what the heights stand for.

use super::Errors;
use crate::error::Result;
use crate::exact::AxisScale;
use crate::inspect::angle::degrees;
use crate::map::{HeightMap, Heights, Size};
use crate::material::Texture;
use crate::ops::bake::{BakeOptions, Filter};
use rayon::prelude::*;

/// The normals of a height map in double precision (FGED2 eq. 7.41 to 7.43), y along growing v.
///
/// Differences of integer codes are exact; what follows rounds ten times, each by 2^-53: within 1e-13 degrees of real
/// arithmetic.
pub struct TrueNormals<'a> {
    heights: &'a HeightMap,
    options: BakeOptions,
    /// The code of h = 1.
    greatest: f64,
    /// The scale of each axis in texels over the stencil's divisor and the greatest code.
    per_difference: [f64; 2],
    weights: [f64; 2],
}

impl<'a> TrueNormals<'a> {
    /// Those that a bake with these options stands for.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a scale out of range.
    pub fn new(heights: &'a HeightMap, options: &BakeOptions) -> Result<Self> {
        let AxisScale { x, y, q, .. } = options.scale.resolve(heights.size())?;
        let [centre, outer] = match options.filter {
            Filter::Central => [1.0, 0.0],
            Filter::Sobel => [2.0, 1.0],
            Filter::Scharr => [10.0, 3.0],
            Filter::Prewitt => [1.0, 1.0],
        };
        let greatest = heights.height_type().greatest_code().map_or(1.0, f64::from);
        let divisor = f64::from(q) * 2.0 * (centre + 2.0 * outer) * greatest;
        let per_difference = [x, y].map(|part| f64::from(part) / divisor);
        Ok(Self { heights, options: *options, greatest, per_difference, weights: [centre, outer] })
    }

    /// Width and height of the map in texels.
    pub fn size(&self) -> Size {
        self.heights.size()
    }

    /// The slopes dz/dx and dz/dy of the texel in column x, row y, in texels.
    pub fn slope(&self, x: usize, y: usize) -> [f64; 2] {
        let size = self.heights.size();
        let code = |dx: isize, dy: isize| {
            let column = self.options.edges.x.resolve(x as isize + dx, size.width());
            let row = self.options.edges.y.resolve(y as isize + dy, size.height());
            code(self.heights.heights(), row * size.width() + column)
        };
        let [centre, outer] = self.weights;
        let along_x = |dy| code(1, dy) - code(-1, dy);
        let along_y = |dx| code(dx, 1) - code(dx, -1);
        let mut slope = [centre * along_x(0), centre * along_y(0)];
        if outer != 0.0 {
            slope[0] += outer * (along_x(-1) + along_x(1));
            slope[1] += outer * (along_y(-1) + along_y(1));
        }
        [slope[0] * self.per_difference[0], slope[1] * self.per_difference[1]]
    }

    /// The normal of the texel in column x, row y.
    pub fn at(&self, x: usize, y: usize) -> [f64; 3] {
        normal_of(self.slope(x, y))
    }

    /// The height of the texel in column x, row y.
    pub fn height(&self, x: usize, y: usize) -> f64 {
        code(self.heights.heights(), y * self.size().width() + x) / self.greatest
    }

    /// The value of the parallax map there, n_z (2h - 1) (FGED2 section 7.7); a height beyond 0 and 1 counts as 0 or 1.
    pub fn parallax_at(&self, x: usize, y: usize) -> f64 {
        let h = self.height(x, y).clamp(0.0, 1.0);
        self.at(x, y)[2] * (2.0 * h - 1.0)
    }

    /// The angles in degrees between these normals and those of a baked map, as a shader reads them.
    ///
    /// `baked` is of the heights' size.
    pub fn errors(&self, baked: &Texture<3>) -> Errors {
        errors_of(baked, |x, y| self.at(x, y))
    }

    /// How far the values of a baked parallax map are from those of [`TrueNormals::parallax_at`].
    ///
    /// `baked` is of the heights' size.
    pub fn parallax_errors(&self, baked: &Texture<1>) -> Errors {
        let width = self.size().width();
        let error = |(i, value): (usize, &[f32; 1])| {
            (f64::from(value[0]) - self.parallax_at(i % width, i / width)).abs() as f32
        };
        Errors::of(baked.texels().par_iter().enumerate().map(error).collect())
    }
}

/// The angles in degrees between the normals of a map, as a shader reads them, and those that are true of column and row.
pub(super) fn errors_of(baked: &Texture<3>, truth: impl Fn(usize, usize) -> [f64; 3] + Sync) -> Errors {
    let width = baked.size().width();
    let angle = |(i, normal): (usize, &[f32; 3])| degrees(truth(i % width, i / width), normal.map(f64::from)) as f32;
    Errors::of(baked.texels().par_iter().enumerate().map(angle).collect())
}

/// The normal of a slope (FGED2 eq. 7.43).
pub(super) fn normal_of([dx, dy]: [f64; 2]) -> [f64; 3] {
    let length = (dx * dx + dy * dy + 1.0).sqrt();
    [-dx / length, -dy / length, 1.0 / length]
}

fn code(heights: Heights<'_>, texel: usize) -> f64 {
    match heights {
        Heights::U8(codes) => codes[texel].into(),
        Heights::U16(codes) => codes[texel].into(),
        Heights::F32(heights) => heights[texel].into(),
    }
}
