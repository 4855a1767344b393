//! Height map to normal map.
//!
//! The slope of the heights by a 3 x 3 stencil (FGED2 eq. 7.41), the normal from the two slopes (eq. 7.42, 7.43;
//! listing 7.5 without its power-of-two limit), and its code. The kernel is `kernels/normal.wgsl`.

mod options;
mod plan;
mod reference;

pub use options::{Filter, NormalOptions, Precision};
pub(crate) use plan::{FloatSlope, IntegerSlope, NormalPlan, Slope, Stencil};
pub(crate) use reference::{codes_of_band, float_sums, integer_sums};
