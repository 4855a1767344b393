//! The operations: their options, their kernels' parameters and their CPU reference, one stem for each.
//!
//! `bake` looks at a height and its neighbours; `blend` and `parallax` look at the texels of several maps that lie
//! over each other; `tangents` at the triangles of a mesh.

pub mod bake;
pub mod blend;
mod layer;
pub mod parallax;
mod precision;
mod store;
pub mod tangents;

pub(crate) use layer::{LayerReading, Vector, float_of_integers};
pub use precision::Precision;
