//! Two normal maps to one.
//!
//! In slope space (FGED2 section 7.6.3) the result is the normal map of the sum of the two height maps, each with its
//! weight; other published methods are there to compare with. The kernel is `kernels/blend.wgsl`.

mod formula;
mod options;
mod plan;
mod reference;

pub(crate) use formula::{Number, blended};
pub use options::{BlendInputs, BlendMethod, BlendOptions};
pub(crate) use plan::BlendPlan;
pub(crate) use reference::{blend_floats, blend_integers, codes_of_layers};
