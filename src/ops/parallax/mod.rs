//! A parallax map from a height map and a normal map that is already there.
//!
//! n_z (2h - 1) (FGED2 section 7.7) with n from the map, of length one whatever its length there. Without a normal map
//! it is the heights' own: [`super::bake`]. The kernel is `kernels/parallax.wgsl`.

mod plan;
mod reference;

pub(crate) use plan::ParallaxPlan;
pub(crate) use reference::{codes_of_layers, parallax_of_floats, parallax_of_integers};
