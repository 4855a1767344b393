//! The shader library: each function's twin within a derived bound of f64, and each device within one of the same.

mod cotangent_frame;
mod decode_normal;
mod examined;
#[cfg(feature = "cli")]
mod export;
mod filtered;
mod lighting;
#[cfg(feature = "gpu")]
mod pixels;
pub mod plane_offset;
mod real;
mod relief_offset;
mod stepped_offset;
mod tangent_frame;
mod welsh_offset;
