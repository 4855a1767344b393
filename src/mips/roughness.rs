//! The roughness that replaces the detail that filtering removes.
//!
//! A level has one slope where level 0 has many. What they scatter is put into the lobe of the surface's shading instead:
//! the level's alpha grows with their variance.
//!
//! - LEAN (Olano and Baker, LEAN Mapping, 2010): slopes of a Beckmann lobe are normally distributed with the variance
//!   alpha^2 / 2 along each axis, and those of the map come on top (their equation for the sum of covariances). With the
//!   mean over both axes that is alpha'^2 = alpha^2 + var dx + var dy.
//! - Toksvig (Mipmapping Normal Maps, 2005): the mean of unit normals is the shorter the more they differ, and Blinn's
//!   exponent s becomes s' = f s with f = |N| / (|N| + s (1 - |N|)), which is 1/s' = 1/s + (1 - |N|) / |N|. Alpha is that
//!   of Walter and others (Microfacet Models for Refraction, 2007): alpha^2 = 2 / (s + 2).
//!
//! What is stored is the roughness r of glTF, Unreal and Unity, alpha = r^2 (Burley, Physically-Based Shading at Disney,
//! 2012), as an unorm code. All is computed in f64, by operations that IEEE rounds, in the order that stands here and in
//! [`super::pyramid::Pyramid`].

use crate::backend::cpu::levels::{LevelHeight, sums_of_row};
use crate::error::{Error, Result};
use crate::exact::Rational;
use crate::map::{CodesMut, Encoding, RoughnessFormat};
use crate::names::named;
use crate::ops::bake::{BakePlan, Slope};
use crate::stream::Band;

/// How a level's roughness follows from what filtering removes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RoughnessMethod {
    /// The variance of slopes.
    #[default]
    Lean,
    /// The length of the mean normal.
    Toksvig,
}

named! {
    RoughnessMethod "roughness" { Lean = "lean", Toksvig = "toksvig" }
}

/// What a roughness map of mip levels is to hold.
///
/// The default: what LEAN mapping adds to a mirror, in 8 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RoughnessOptions {
    /// What widens the lobe.
    pub method: RoughnessMethod,
    /// Roughness of the surface where it is flat, from 0 to 1: that of level 0. Its square is alpha.
    pub base: Rational,
    /// How it is stored.
    pub format: RoughnessFormat,
}

impl Default for RoughnessOptions {
    fn default() -> Self {
        Self { method: RoughnessMethod::default(), base: 0.into(), format: RoughnessFormat::default() }
    }
}

impl RoughnessOptions {
    /// Alpha's square root where the surface is flat.
    fn base(&self) -> f64 {
        self.base.numerator() as f64 / self.base.denominator() as f64
    }

    /// Fails for a base beyond 0 and 1.
    pub(crate) fn check(&self) -> Result<()> {
        if (0.0..=1.0).contains(&self.base()) {
            return Ok(());
        }
        Err(Error::parameter("base-roughness", self.base, "from 0 to 1"))
    }
}

/// Planes that are summed up for either method.
pub(super) const PLANES: usize = 3;

/// Variances, and what lengths are short of 1, count as none below this share of what they are the difference of: the
/// sums of 2^16 rows and as many columns are off by less.
const NOTHING: f64 = 1.0 / (1u64 << 36) as f64;

/// The options resolved for one map.
#[derive(Debug, Clone, Copy)]
pub(super) struct Roughness {
    method: RoughnessMethod,
    /// Square of the base's alpha.
    alpha_squared: f64,
    base: f64,
    greatest: f64,
    /// From stencil sums to slopes.
    factors: [f64; 2],
}

impl Roughness {
    /// Resolves the options for the slopes of a plan.
    pub fn new(options: &RoughnessOptions, plan: &BakePlan) -> Self {
        let (RoughnessOptions { method, format, .. }, base) = (*options, options.base());
        let factors = match plan.slope {
            Slope::Integer(slope) => [slope.px, slope.py].map(|part| f64::from(part) / slope.z as f64),
            Slope::Float(slope) => [slope.kx, slope.ky].map(|per_sum| f64::from(per_sum) * 2f64.powi(64)),
        };
        let greatest = f64::from(Encoding::Unorm.greatest_code(format.depth).unwrap_or(255));
        Self { method, alpha_squared: (base * base) * (base * base), base, greatest, factors }
    }

    /// What is summed up of a row of a strip, plane after plane: dx, dy and dx^2 + dy^2, or the unit normal.
    pub fn samples<T: LevelHeight<Sum: Into<f64>>>(
        &self,
        plan: &BakePlan,
        strip: &Band<'_, T>,
        row: usize,
        samples: &mut [f64],
    ) {
        let sums = sums_of_row(plan, strip, row);
        let (first, rest) = samples.split_at_mut(strip.width);
        let (second, third) = rest.split_at_mut(strip.width);
        for (x, [gx, gy]) in sums.enumerate() {
            let (dx, dy) = (gx.into() * self.factors[0], gy.into() * self.factors[1]);
            let square = dx * dx + dy * dy;
            [first[x], second[x], third[x]] = match self.method {
                RoughnessMethod::Lean => [dx, dy, square],
                RoughnessMethod::Toksvig => {
                    let length = (square + 1.0).sqrt();
                    [dx / length, dy / length, 1.0 / length]
                }
            };
        }
    }

    /// The codes of texels of a level, from their sums with weights that add up to `weight`.
    pub fn codes(&self, weight: u64, sums: &[&[f64]], codes: CodesMut<'_>) {
        let weight = weight as f64;
        let code = |at: usize| self.code(self.widened([0, 1, 2].map(|plane| sums[plane][at] / weight)));
        match codes {
            CodesMut::U8(codes) => codes.iter_mut().enumerate().for_each(|(at, stored)| *stored = code(at) as u8),
            CodesMut::U16(codes) => codes.iter_mut().enumerate().for_each(|(at, stored)| *stored = code(at) as u16),
            CodesMut::F16(_) | CodesMut::F32(_) => unreachable!("checked with the plan"),
        }
    }

    /// The code of level 0.
    pub fn base_code(&self) -> u32 {
        self.code(self.base)
    }

    /// The roughness of a texel from the means of its planes.
    fn widened(&self, [x, y, z]: [f64; 3]) -> f64 {
        let alpha_squared = match self.method {
            RoughnessMethod::Lean => {
                let variance = z - (x * x + y * y);
                self.alpha_squared + if variance < z * NOTHING { 0.0 } else { variance }
            }
            RoughnessMethod::Toksvig => {
                let length = (x * x + y * y + z * z).sqrt();
                let lost = if 1.0 - length < NOTHING { 0.0 } else { (1.0 - length) / length };
                if lost == 0.0 || self.alpha_squared >= 1.0 {
                    self.alpha_squared
                } else {
                    // Twice 1/s', of which 2/s = alpha^2 / (1 - alpha^2) is the base's.
                    let twice = self.alpha_squared / (1.0 - self.alpha_squared) + 2.0 * lost;
                    twice / (1.0 + twice)
                }
            }
        };
        if alpha_squared == self.alpha_squared { self.base } else { alpha_squared.min(1.0).sqrt().sqrt() }
    }

    fn code(&self, roughness: f64) -> u32 {
        (roughness * self.greatest + 0.5).floor() as u32
    }
}
