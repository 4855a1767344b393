//! A height map to its normal map, its parallax map, or both in one pass.
//!
//! The slope of the heights by a 3 x 3 stencil (FGED2 eq. 7.41), the normal from the two slopes (eq. 7.42, 7.43;
//! listing 7.5 without its power-of-two limit), n_z (2h - 1) (section 7.7), and their codes. The kernel is
//! `kernels/bake.wgsl`.

mod options;
mod plan;
mod reference;

pub use options::{BakeOptions, Filter, NormalOptions, ParallaxOptions};
pub(crate) use plan::{BakePlan, FloatSlope, IntegerSlope, Slope, Stencil};
pub(crate) use reference::{codes_of_band, float_parallax, float_sums, integer_sums, unit, zero_below};
