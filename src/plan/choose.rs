//! The cheapest maps of one height map that keep within the tolerances.

use super::decision::{Decision, Rejected, bytes_a_texel, degrees, pixels, short};
use super::normals::{self, NoNormals, NormalChoice};
use super::parallax::{self, ParallaxChoice};
use super::subject::{Reduced, Subject};
use super::unmet::Unmet;
use super::{frames, precision};
use crate::error::Result;
use crate::ops::Precision;

/// What was chosen for a height map.
#[derive(Debug)]
pub(super) struct Chosen {
    pub shrink: u32,
    pub normals: NormalChoice,
    pub parallax: ParallaxChoice,
    pub precision: Precision,
    /// All decisions, in the order in which they are told.
    pub decisions: Vec<Decision>,
    /// `tangents`, `cotangent frame` or `none`.
    pub tangent_space: String,
}

/// Maps at one resolution that keep within the tolerances.
struct Candidate {
    by: u32,
    normals: NormalChoice,
    parallax: ParallaxChoice,
}

impl Candidate {
    fn bytes(&self) -> f64 {
        self.normals.bytes + self.parallax.bytes
    }

    fn maps(&self) -> &'static str {
        maps(&self.normals, &self.parallax)
    }
}

/// What `bake` is to make.
fn maps(normals: &NormalChoice, parallax: &ParallaxChoice) -> &'static str {
    match (normals.format.is_some(), parallax.format.is_some()) {
        (true, true) => "normal,parallax",
        (true, false) => "normal",
        (false, true) => "parallax",
        (false, false) => "none",
    }
}

impl Chosen {
    /// What `bake` is to make: `normal`, `parallax`, `normal,parallax` or `none`.
    pub fn maps(&self) -> &'static str {
        maps(&self.normals, &self.parallax)
    }
}

/// Chooses for one height map.
///
/// Every resolution is tried, coarsest first, until a finer one can be no cheaper.
pub(super) fn choose(subject: &Subject<'_>) -> Result<Result<Chosen, Unmet>> {
    let factors = subject.factors();
    let offset = parallax::largest_offset(&subject.heights, &subject.facts().bake(), subject.seen)?;
    let mut rejected = Vec::new();
    let mut best: Option<Candidate> = None;
    let mut unmet = None;
    for &by in &factors {
        let reduced = subject.reduced(by)?;
        if best.as_ref().is_some_and(|best| best.bytes() <= least_bytes(subject, &reduced)) {
            break;
        }
        match attempt(subject, &reduced, offset)? {
            Ok(candidate) if best.as_ref().is_none_or(|best| candidate.bytes() < best.bytes()) => {
                best = Some(candidate)
            }
            Ok(_) => {}
            Err(failure) => {
                rejected.push(Rejected::new(shrink(by), failure.why(subject)));
                unmet = Some(failure.unmet(subject));
            }
        }
    }
    let Some(best) = best else {
        return Ok(Err(unmet.unwrap_or_else(|| unreachable!("there is the factor 1"))));
    };
    decide(subject, best, &factors, rejected).map(Ok)
}

/// What the smallest maps of a resolution take, over texels of the whole map.
fn least_bytes(subject: &Subject<'_>, reduced: &Reduced<'_>) -> f64 {
    let smallest = normals::formats(&subject.material.format, subject.facts().convention)[0];
    smallest.texel().bytes() as f64 * reduced.share()
}

/// Why a resolution is not fit.
enum Failure {
    Normals(NoNormals),
    Other(Unmet),
}

impl Failure {
    fn why(&self, subject: &Subject<'_>) -> String {
        match self {
            Self::Normals(NoNormals { best: (error, format) }) => {
                let allowed = short(subject.tolerance().normal);
                let format = normals::describe(*format);
                format!("normals are off by up to {}, of {allowed} allowed, in {format}", degrees(*error))
            }
            Self::Other(unmet) => {
                format!("its best is {} {}, of {} allowed", short(unmet.best), unmet.unit, short(unmet.wanted))
            }
        }
    }

    fn unmet(self, subject: &Subject<'_>) -> Unmet {
        match self {
            Self::Normals(none) => none.unmet(subject),
            Self::Other(unmet) => unmet,
        }
    }
}

fn attempt(subject: &Subject<'_>, reduced: &Reduced<'_>, offset: f64) -> Result<Result<Candidate, Failure>> {
    let normals = match normals::choose(subject, reduced)? {
        Ok(normals) => normals,
        Err(none) => return Ok(Err(Failure::Normals(none))),
    };
    let bound = subject.tolerance().bytes_per_texel;
    if let Some(wanted) = bound.filter(|bound| normals.bytes > *bound) {
        let with = normals.decision.choice.clone();
        let (tolerance, unit) = ("bytes-per-texel", "bytes a texel");
        return Ok(Err(Failure::Other(Unmet { tolerance, wanted, unit, best: normals.bytes, with })));
    }
    let bytes_left = bound.map_or(f64::INFINITY, |bound| bound - normals.bytes);
    let parallax = match parallax::none(subject, offset) {
        Some(none) => Ok(none),
        None => parallax::choose(subject, reduced, normals.format, offset, bytes_left)?,
    };
    Ok(match parallax {
        Ok(parallax) => Ok(Candidate { by: reduced.by, normals, parallax }),
        Err(unmet) => Err(Failure::Other(unmet)),
    })
}

/// The decisions that are left once the maps are chosen.
fn decide(subject: &Subject<'_>, best: Candidate, factors: &[u32], rejected: Vec<Rejected>) -> Result<Chosen> {
    let reduced = subject.reduced(best.by)?;
    let (maps_text, bytes) = (best.maps(), best.bytes());
    let Candidate { by, mut normals, mut parallax } = best;
    let (precision, precision_decision) = precision::choose(subject, &reduced, &mut normals, &mut parallax)?;
    let baked = normals.format.map(|format| normals::bake(subject.baker, &reduced, format, precision)).transpose()?;
    let frames = frames::choose(subject, baked.as_ref())?;
    let mut decisions = vec![maps_decision(subject, maps_text, bytes, &normals, &parallax)];
    decisions.push(resolution(subject, by, factors, rejected));
    decisions.push(normals.decision.clone());
    decisions.extend(parallax.decisions.iter().cloned());
    decisions.push(precision_decision);
    let tangent_space = frames.choice.clone();
    decisions.push(frames);
    Ok(Chosen { shrink: by, normals, parallax, precision, decisions, tangent_space })
}

fn maps_decision(
    subject: &Subject<'_>,
    maps: &str,
    bytes: f64,
    normals: &NormalChoice,
    parallax: &ParallaxChoice,
) -> Decision {
    let mut reasons = vec![match normals.format {
        Some(_) => "normals lean by more than the tolerance".to_owned(),
        None => "normals are flat to within the tolerance".to_owned(),
    }];
    reasons.push(match (parallax.format, parallax.method.fetches()) {
        (Some(_), _) => format!("{} reads a parallax map", parallax.method),
        (None, 0) => "no offset is seen".to_owned(),
        (None, _) => format!("{} reads the height map as it is", parallax.method),
    });
    let mut reason = format!("{}; in all {} of the height map", reasons.join(", "), bytes_a_texel(bytes));
    if let Some(bound) = subject.tolerance().bytes_per_texel {
        reason += &format!(", of {} allowed", short(bound));
    }
    Decision::new("maps", maps, reason)
}

fn resolution(subject: &Subject<'_>, by: u32, factors: &[u32], rejected: Vec<Rejected>) -> Decision {
    let size = subject.heights.size();
    let (width, height) = (size.width() / by as usize, size.height() / by as usize);
    let covers = f64::from(by) * subject.seen.pixels_per_texel;
    let mut reason = format!("{width} x {height}: a texel covers {} at the nearest view", pixels(covers));
    if by == 1 && covers > 1.0 {
        reason += ", and there are no finer ones";
    } else if Some(&by) == factors.first() {
        reason += "; no coarser one divides the map and covers no more than one";
    } else if rejected.is_empty() {
        reason += "; coarser ones need larger codes";
    }
    Decision::new("resolution", shrink(by), reason).without(rejected)
}

fn shrink(by: u32) -> String {
    if by == 1 { "whole".into() } else { format!("shrink {by}") }
}
