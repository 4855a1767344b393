//! Mip levels.

mod closed_forms;
mod floats;
mod integers;
mod roughness;
mod rows;
#[cfg(all(feature = "cli", target_os = "linux"))]
mod wide;

use crate::support::{Format, Image, differences};
use texbake::CodeMap;

/// Every level has exactly the expected codes.
fn check_levels<F: Format>(what: &str, levels: &[CodeMap<F>], expected: &[Image<F>]) -> Result<(), String> {
    if levels.len() != expected.len() {
        return Err(format!("{what}: {} levels, expected {}", levels.len(), expected.len()));
    }
    levels.iter().zip(expected).enumerate().try_for_each(|(level, (got, expected))| {
        differences(&Image::from(got), expected).map_err(|report| format!("{what}, level {level}: {report}"))
    })
}

/// Fails with the first codes that differ.
fn assert_levels<F: Format>(what: &str, levels: &[CodeMap<F>], expected: &[Image<F>]) {
    if let Err(report) = check_levels(what, levels, expected) {
        panic!("{report}");
    }
}
