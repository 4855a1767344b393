//! What `exact` precision stands on: exact scales and correct rounding of A / sqrt(S).

mod acos;
mod float;
mod rational;
mod read;
mod round;
mod scale;
mod weights;
mod wide;

pub(crate) use acos::acos;
#[cfg(all(test, feature = "gpu"))]
pub(crate) use acos::nearest_acos;
pub(crate) use acos::{acos_estimate, is_in_doubt};
pub(crate) use float::{nearest_f16, nearest_f32};
pub use rational::Rational;
pub(crate) use read::CodeReading;
pub(crate) use round::CodeRounding;
pub use scale::{AxisScale, Scale};
pub use weights::Weights;
pub(crate) use wide::{Radicand, Wide};
