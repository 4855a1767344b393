//! Faults of the program's surroundings: each ends with correct files or a clear error.

#[cfg(feature = "gpu")]
mod gpu;
