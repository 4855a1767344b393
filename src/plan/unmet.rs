//! Tolerances that cannot be met.

use super::prediction::ErrorOf;
use crate::error::Error;
use crate::measure::digits;
use std::path::{Path, PathBuf};

/// A tolerance that no candidate keeps within, and the best that can be had.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unmet {
    /// Its name in the scene.
    tolerance: &'static str,
    /// What it is.
    wanted: f64,
    unit: &'static str,
    /// The least that can be had.
    best: f64,
    /// With what.
    with: String,
    /// Another tolerance that can be met in its place.
    instead: Option<String>,
    /// How far the candidates came: what is right but too large is nearer than what is not right.
    kind: Kind,
}

/// What is not kept, the nearest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Cost,
    Parallax,
    Normal,
}

impl Unmet {
    /// `instead` is another format than that of the scene, if there are finer ones.
    pub fn normal(wanted: f64, best: f64, with: String, instead: Option<String>) -> Self {
        Self { tolerance: "normal", wanted, unit: "degrees", best, with, instead, kind: Kind::Normal }
    }

    /// `most`: the best by 99 of 100 pixels, where all of them count.
    pub fn parallax(wanted: f64, of: ErrorOf, best: f64, with: String, most: Option<f64>) -> Self {
        let tolerance = match of {
            ErrorOf::All => "parallax",
            ErrorOf::Most => "parallax-99",
        };
        let instead = most.filter(|most| *most < best).map(|most| {
            format!("leave silhouettes out of the account, as parallax-99 = {}", short_above(most.max(wanted)))
        });
        Self { tolerance, wanted, unit: "pixels", best, with, instead, kind: Kind::Parallax }
    }

    pub fn bytes(wanted: f64, best: f64, with: String) -> Self {
        let (tolerance, unit) = ("bytes-per-texel", "bytes per texel");
        Self { tolerance, wanted, unit, best, with, instead: None, kind: Kind::Cost }
    }

    pub fn milliseconds(wanted: f64, best: f64, with: String) -> Self {
        let (tolerance, unit) = ("milliseconds", "milliseconds");
        Self { tolerance, wanted, unit, best, with, instead: None, kind: Kind::Cost }
    }

    /// The same at this resolution.
    pub fn at(self, resolution: &str) -> Self {
        Self { with: format!("{} at {resolution}", self.with), ..self }
    }

    /// The one that is nearest to its tolerance.
    pub fn nearest(all: Vec<Self>) -> Option<Self> {
        all.into_iter().min_by(|a, b| {
            let beyond = |unmet: &Self| unmet.best / unmet.wanted;
            a.kind.cmp(&b.kind).then(beyond(a).total_cmp(&beyond(b)))
        })
    }

    /// Why a resolution is not fit.
    pub fn why(&self) -> String {
        let Self { wanted, unit, best, with, .. } = self;
        format!("the best is {} {unit}, of {} allowed, with {with}", digits(*best), digits(*wanted))
    }

    /// Of all height maps that cannot be planned.
    pub fn error(scene: &Path, unmet: Vec<(PathBuf, Self)>) -> Error {
        let (reasons, remedies): (Vec<String>, Vec<String>) =
            unmet.iter().map(|(map, unmet)| (unmet.reason(map), unmet.remedy())).unzip();
        match &remedies[..] {
            [remedy] => Error::file(scene, reasons.concat(), remedy),
            _ => {
                let both = reasons.iter().zip(&remedies).map(|(reason, remedy)| format!("{reason}: {remedy}"));
                Error::file(scene, both.collect::<Vec<_>>().join("; "), "a material may have a tolerance of its own")
            }
        }
    }

    fn reason(&self, map: &Path) -> String {
        let Self { tolerance, wanted, unit, best, with, .. } = self;
        format!(
            "{}: the tolerance {tolerance} of {} {unit} cannot be met: the best is {} {unit}, with {with}",
            map.display(),
            digits(*wanted),
            short_above(*best),
        )
    }

    fn remedy(&self) -> String {
        let instead = self.instead.as_deref().unwrap_or("change what limits it");
        format!("allow {} = {}, or {instead}", self.tolerance, short_above(self.best))
    }
}

/// A number of as many digits as are written, at or above this one, so that what it allows is enough.
fn short_above(number: f64) -> String {
    if number <= 0.0 {
        return "0".into();
    }
    let written = if number < 1e-4 { 2 } else { 3 };
    let digit = 10f64.powi(number.log10().floor() as i32 + 1 - written);
    digits((number / digit).ceil() * digit)
}
