//! The shader library: each function's twin within a derived bound of f64, and each device within one of the same.

mod decode_normal;
mod examined;
mod lighting;
pub mod plane_offset;
mod real;
mod tangent_frame;
