//! The shader library: each function's twin within a derived bound of f64, and each device within one of the same.

pub mod plane_offset;
