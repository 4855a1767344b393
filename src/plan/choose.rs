//! The cheapest maps of one height map that keep within the tolerances.

use super::decision::{Decision, Rejected, bytes_per_texel, sides};
use super::normals::{self, NormalChoice};
use super::parallax::{self, ParallaxChoice};
use super::prediction::TangentSpace;
use super::subject::{Reduced, Subject};
use super::unmet::Unmet;
use super::{frames, precision};
use crate::error::{Error, Result};
use crate::measure::digits;
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
    pub tangent_space: TangentSpace,
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
    match (normals.format.is_some(), parallax.map.is_some()) {
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
    let (mut rejected, mut unmet) = (Vec::new(), Vec::new());
    let mut best: Option<Candidate> = None;
    for &by in &factors {
        let reduced = match subject.reduced(by) {
            // A scale of many digits, of which a part has too many.
            Err(error @ Error::Parameter { .. }) if by > 1 => {
                rejected.push(Rejected::new(resolution_name(by), error.to_string()));
                continue;
            }
            reduced => reduced?,
        };
        if best.as_ref().is_some_and(|best| best.bytes() <= least_bytes(subject, &reduced)) {
            break;
        }
        match attempt(subject, &reduced)? {
            Ok(candidate) if best.as_ref().is_none_or(|best| candidate.bytes() < best.bytes()) => {
                best = Some(candidate)
            }
            Ok(_) => {}
            Err(failure) => {
                rejected.push(Rejected::new(resolution_name(by), failure.why()));
                unmet.push(failure.at(&resolution_name(by)));
            }
        }
    }
    match best {
        Some(best) => decide(subject, best, &factors, rejected).map(Ok),
        None => Ok(Err(Unmet::nearest(unmet).unwrap_or_else(|| unreachable!("there is the factor 1")))),
    }
}

/// What the smallest maps of a resolution take, over texels of the whole map.
fn least_bytes(subject: &Subject<'_>, reduced: &Reduced<'_>) -> f64 {
    let smallest = normals::formats(&subject.material.format, subject.facts().convention)[0];
    smallest.texel().bytes() as f64 * reduced.share()
}

fn attempt(subject: &Subject<'_>, reduced: &Reduced<'_>) -> Result<Result<Candidate, Unmet>> {
    let normals = match normals::choose(subject, reduced)? {
        Ok(normals) => normals,
        Err(unmet) => return Ok(Err(unmet)),
    };
    let parallax = parallax::choose(subject, reduced, &normals)?;
    Ok(parallax.map(|parallax| Candidate { by: reduced.by, normals, parallax }))
}

/// The decisions that are left once the maps are chosen.
fn decide(subject: &Subject<'_>, best: Candidate, factors: &[u32], rejected: Vec<Rejected>) -> Result<Chosen> {
    let reduced = subject.reduced(best.by)?;
    let (maps_text, bytes) = (best.maps(), best.bytes());
    let Candidate { by, mut normals, mut parallax } = best;
    let (precision, precision_decision) = precision::choose(subject, &reduced, &mut normals, &mut parallax)?;
    let baked = normals.format.map(|format| normals::bake(subject.baker, &reduced, format, precision)).transpose()?;
    let (tangent_space, frames) = frames::choose(subject, normals.error, baked.as_ref())?;
    let mut decisions = vec![maps_decision(subject, maps_text, bytes, &normals, &parallax)];
    decisions.push(resolution(subject, by, factors, rejected));
    decisions.push(normals.decision.clone());
    decisions.extend(parallax.decisions.iter().cloned());
    decisions.push(precision_decision);
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
    reasons.push(match (parallax.map, parallax.method.fetches()) {
        (Some(_), _) => format!("{} reads a parallax map", parallax.method),
        (None, 0) => "offsets are within theirs".to_owned(),
        (None, _) => format!("{} reads the height map as it is", parallax.method),
    });
    let mut reason = format!("{}; in all {} of the height map", reasons.join(", "), bytes_per_texel(bytes));
    if let Some(bound) = subject.tolerance().bytes_per_texel {
        reason += &format!(", of {} allowed", digits(bound));
    }
    Decision::new("maps", maps, reason)
}

fn resolution(subject: &Subject<'_>, by: u32, factors: &[u32], rejected: Vec<Rejected>) -> Decision {
    let size = subject.heights.size();
    let (width, height) = (size.width() / by as usize, size.height() / by as usize);
    let covers = subject.seen.pixels_per_texel.map(|pixels| pixels * f64::from(by));
    let mut reason = format!("{width} x {height}: a texel covers {} at the nearest view", sides(covers));
    if by == 1 && subject.seen.longer_side() > 1.0 {
        reason += ", so that no texel can be spared";
    } else if Some(&by) == factors.first() {
        reason += "; no coarser one divides the map and covers at most one";
    } else if rejected.is_empty() {
        reason += "; coarser ones need larger codes";
    }
    Decision::new("resolution", resolution_name(by), reason).without(rejected)
}

fn resolution_name(by: u32) -> String {
    if by == 1 { "full resolution".into() } else { format!("shrink {by}") }
}
