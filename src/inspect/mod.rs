//! What is wrong with a normal map, and how two of them differ.
//!
//! [`check`] reads a map once and finds faults, [`repair`] mends those that arithmetic can mend, [`Difference`]
//! compares two maps, and [`heatmap`] paints where they differ. Maps are read row by row: a few bands of them are in
//! memory, and sums of 8 bytes for each row and column.

pub(crate) mod angle;
mod banding;
mod census;
mod check;
mod diff;
mod green;
mod heatmap;
pub(crate) mod ramp;
mod read;
mod repair;
mod seams;

pub use banding::Banding;
pub use census::{Census, Counted, Misreading, Tally, Texel};
pub use check::{CheckOptions, Finding, Findings, Problem, Severity, check, check_file};
pub use diff::{CodeDifference, Difference};
pub use green::Green;
pub use heatmap::heatmap;
pub use repair::{Repaired, repair};
pub use seams::{Seam, Seams};
