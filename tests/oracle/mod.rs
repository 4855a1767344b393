//! The oracle: what the codes of a normal map are, from the equations alone.
//!
//! It shares the crate's words (filters, edges, formats) but none of its arithmetic: its own neighbours, stencils and
//! scales, square roots of big integers for the codes of integer heights, f64 for those of floats.

mod integer;
mod nearest_float;
mod real;
mod slopes;

pub use integer::{image, ties};
pub use real::{RealNormal, real_normals};
pub use slopes::slope_sums;
