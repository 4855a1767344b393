//! CPU and GPU held against each other.

#[cfg(all(test, feature = "gpu"))]
mod page;
