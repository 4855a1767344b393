//! How far the normals of a baked map are from those of its heights.

use super::Errors;
use crate::error::Result;
use crate::exact::AxisScale;
use crate::inspect::angle::degrees;
use crate::map::{HeightMap, Heights};
use crate::material::Texture;
use crate::ops::bake::{BakeOptions, Filter};
use rayon::prelude::*;

/// The normals of a height map in double precision (FGED2 eq. 7.41 to 7.43), y along growing v: within 1e-13 degrees of
/// real arithmetic for integer heights.
pub struct TrueNormals<'a> {
    heights: &'a HeightMap,
    options: BakeOptions,
    /// The scale of each axis in texels over the stencil's divisor.
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
        let divisor = f64::from(q) * 2.0 * (centre + 2.0 * outer);
        let per_difference = [x, y].map(|part| f64::from(part) / divisor);
        Ok(Self { heights, options: *options, per_difference, weights: [centre, outer] })
    }

    /// The normal of the texel in column x, row y.
    pub fn at(&self, x: usize, y: usize) -> [f64; 3] {
        let size = self.heights.size();
        let height = |dx: isize, dy: isize| {
            let column = self.options.edges.x.resolve(x as isize + dx, size.width());
            let row = self.options.edges.y.resolve(y as isize + dy, size.height());
            height(self.heights.heights(), row * size.width() + column)
        };
        let [centre, outer] = self.weights;
        let along_x = |dy| height(1, dy) - height(-1, dy);
        let along_y = |dx| height(dx, 1) - height(dx, -1);
        let mut slope = [centre * along_x(0), centre * along_y(0)];
        if outer != 0.0 {
            slope[0] += outer * (along_x(-1) + along_x(1));
            slope[1] += outer * (along_y(-1) + along_y(1));
        }
        let [x, y] = [-slope[0] * self.per_difference[0], -slope[1] * self.per_difference[1]];
        let length = (x * x + y * y + 1.0).sqrt();
        [x / length, y / length, 1.0 / length]
    }

    /// The angles in degrees between these normals and those of a baked map, as a shader reads them.
    ///
    /// `baked` is of the heights' size.
    pub fn errors(&self, baked: &Texture<3>) -> Errors {
        let width = self.heights.size().width();
        let angle =
            |(i, normal): (usize, &[f32; 3])| degrees(self.at(i % width, i / width), normal.map(f64::from)) as f32;
        Errors::of(baked.texels().par_iter().enumerate().map(angle).collect())
    }
}

fn height(heights: Heights<'_>, texel: usize) -> f64 {
    match heights {
        Heights::U8(codes) => f64::from(codes[texel]) / 255.0,
        Heights::U16(codes) => f64::from(codes[texel]) / 65_535.0,
        Heights::F32(heights) => heights[texel].into(),
    }
}
