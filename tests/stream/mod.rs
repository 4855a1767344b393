//! Rows in, rows out: banding changes no byte, and what fails on the way is reported.

mod rows;
mod several;

pub use rows::MemorySource;
