//! Two normal maps to one.
//!
//! In slope space (FGED2 section 7.6.3) the result is the normal map of the sum of the two height maps, each with its
//! weight; other published methods are there to compare with. The kernel is `kernels/blend.wgsl`.

mod options;
mod plan;
mod reference;

pub use options::{BlendInputs, BlendMethod, BlendOptions};
pub(crate) use plan::BlendPlan;
#[cfg(test)]
pub(crate) use reference::blend_integers;
pub(crate) use reference::codes_of_layers;
