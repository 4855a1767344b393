//! All tests that stand outside the crate, in one binary.

#[cfg(feature = "cli")]
mod cli;
mod io;
