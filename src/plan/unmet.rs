//! Tolerances that cannot be met.

use super::decision::short;
use crate::error::Error;
use std::path::Path;

/// A tolerance that no candidate keeps within, and the best that can be had.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unmet {
    /// Its name in the scene.
    pub tolerance: &'static str,
    /// What it is.
    pub wanted: f64,
    pub unit: &'static str,
    /// The least that can be had.
    pub best: f64,
    /// With what.
    pub with: String,
}

impl Unmet {
    pub fn error(self, scene: &Path, material: &Path) -> Error {
        let Self { tolerance, wanted, unit, best, with } = self;
        let reason = format!(
            "{}: the tolerance {tolerance} of {} {unit} cannot be met: the best is {} {unit}, with {with}",
            material.display(),
            short(wanted),
            short_above(best),
        );
        Error::file(scene, reason, format!("allow {tolerance} = {}, or change what limits it", short_above(best)))
    }
}

/// A number of three digits at or above this one, so that what it allows is enough.
fn short_above(number: f64) -> String {
    if number <= 0.0 {
        return "0".into();
    }
    let digit = 10f64.powi(number.log10().floor() as i32 - 2);
    short((number / digit).ceil() * digit)
}
