//! The normals that a map, reduced or not, stands for.

use crate::error::{Error, Result};
use crate::inspect::angle::degrees;
use crate::map::{HeightMap, Size};
use crate::material::Texture;
use crate::measure::{Errors, TrueNormals};
use crate::ops::bake::BakeOptions;
use rayon::prelude::*;

/// For each texel of a reduced map the normal of the mean slope of the texels that it stands for, in double precision.
///
/// Slopes, not normals, are what a mean keeps: a texel of `by` x `by` others rises as much across as all of them. Of a
/// map that is not reduced these are its [`TrueNormals`].
pub(super) struct VisibleNormals<'a> {
    whole: TrueNormals<'a>,
    by: usize,
    size: Size,
}

impl<'a> VisibleNormals<'a> {
    /// Those of `heights`, of which a bake with `options` would be, reduced by `by`, a divisor of both sides.
    ///
    /// # Errors
    /// As [`TrueNormals::new`].
    pub fn new(heights: &'a HeightMap, options: &BakeOptions, by: u32) -> Result<Self> {
        let (whole, by) = (heights.size(), by as usize);
        if by == 0 || whole.width() % by != 0 || whole.height() % by != 0 {
            let range = format!("a divisor of both sides of the map, which has {whole} texels");
            return Err(Error::parameter("shrink", by, range));
        }
        let size = Size::new(whole.width() / by, whole.height() / by)?;
        Ok(Self { whole: TrueNormals::new(heights, options)?, by, size })
    }

    /// The angles in degrees to the normals of a map of the reduced size, as a shader reads them.
    pub fn errors(&self, normals: &Texture<3>) -> Errors {
        self.angles(|i| normals.texels()[i])
    }

    /// The angles in degrees to no normal map at all.
    pub fn leanings(&self) -> Errors {
        self.angles(|_| [0.0, 0.0, 1.0])
    }

    fn angles(&self, shown: impl Fn(usize) -> [f32; 3] + Sync) -> Errors {
        let width = self.size.width();
        let angle = |i| degrees(self.at(i % width, i / width), shown(i).map(f64::from)) as f32;
        Errors::of((0..self.size.texels()).into_par_iter().map(angle).collect())
    }

    /// The normal of the reduced texel in column x, row y; of any length.
    fn at(&self, x: usize, y: usize) -> [f64; 3] {
        let (by, mut sum) = (self.by, [0.0; 2]);
        for row in y * by..(y + 1) * by {
            for column in x * by..(x + 1) * by {
                let [x, y] = self.whole.slope(column, row);
                sum = [sum[0] - x, sum[1] - y];
            }
        }
        [sum[0], sum[1], (by * by) as f64]
    }
}
