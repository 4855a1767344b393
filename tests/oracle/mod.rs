//! The oracle: what the codes of a map are, from the equations alone.
//!
//! It shares the crate's words (filters, edges, formats) but none of its arithmetic: its own neighbours, stencils and
//! scales, its own reading of codes, square roots of big integers for the codes of integer maps. The normals of float
//! heights come from f64; blends and parallax maps of floats from f32 in the order that the documentation gives.

mod blend;
mod floats;
mod integer;
mod mips;
mod nearest_float;
mod parallax;
mod real;
mod roughness;
mod rounding;
mod slopes;
mod tangents;
mod texels;

pub use blend::{blend, renormalised};
pub use floats::{float_blend, float_parallax, float_parallax_with_normals};
pub use integer::{image, ties};
pub use mips::{
    float_levels, float_parallax_levels, integer_levels, integer_parallax_levels, level_sizes, mean_normals,
};
pub use parallax::{parallax, parallax_with_normals};
pub use real::{RealNormal, real_normals};
pub use roughness::{SCATTERED, roughness};
pub use slopes::slope_sums;
pub use tangents::{TangentFormula, real_tangents};
pub use texels::{UnormZero, components};

use crate::support::Image;

/// The codes of a map.
pub struct Exact<F> {
    pub image: Image<F>,
    /// How many of them stand for values exactly half-way between two codes.
    pub ties: usize,
}
