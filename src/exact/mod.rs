//! What `exact` precision stands on: exact scales and correct rounding of A / sqrt(S).

mod float;
mod rational;
mod round;
mod scale;

pub(crate) use float::{nearest_f16, nearest_f32};
pub use rational::Rational;
pub(crate) use round::CodeRounding;
pub use scale::{AxisScale, Scale};
