//! How two answers agree.

use super::answer::Answer;
use crate::inspect::angle::degrees;
use crate::map::Depth;
use serde::Serialize;

/// Errors of one unit, over all that was compared.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Errors {
    /// The largest one.
    pub largest: f64,
    /// The mean of all, those of 0 too.
    pub mean: f64,
    /// Values that were compared.
    pub count: u64,
}

impl Errors {
    fn add(&mut self, error: f64) {
        // A difference from NaN or infinity is larger than any.
        let error = if error.is_finite() { error } else { f64::INFINITY };
        self.count += 1;
        self.mean += (error - self.mean) / self.count as f64;
        self.largest = self.largest.max(error);
    }

    /// Takes in those of another comparison.
    fn merge(&mut self, other: &Self) {
        let count = self.count + other.count;
        if other.count > 0 {
            self.mean += (other.mean - self.mean) * (other.count as f64 / count as f64);
        }
        self.count = count;
        self.largest = self.largest.max(other.largest);
    }
}

/// How answers agree: bits, and by how much values differ.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Agreement {
    /// Codes that were compared.
    pub values: u64,
    /// Codes of the specification that the formula in whole numbers judged.
    pub judged: u64,
    /// Those whose bits differ.
    pub differing: u64,
    /// Differences of integer codes.
    pub codes: Errors,
    /// Differences of floats in units in the last place of 1: 2^-10 for 16f, 2^-23 for 32f.
    pub ulps: Errors,
    /// Angles between directions, in degrees: of tangents, and of normals in 32f with three components. Those of codes,
    /// of 16f and of two components say more about the format.
    pub degrees: Errors,
}

/// The most that `fast` may differ from `exact`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bound {
    /// Of integer codes.
    pub codes: f64,
    /// Of floats, as [`Agreement::ulps`].
    pub ulps: f64,
    /// Of directions, as [`Agreement::degrees`].
    pub degrees: f64,
}

/// Where an answer is not what it should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Difference {
    /// The answer, counted from 0.
    pub map: usize,
    /// The code in it.
    pub index: usize,
}

impl Agreement {
    pub(super) fn merge(&mut self, other: &Self) {
        self.judged += other.judged;
        self.values += other.values;
        self.differing += other.differing;
        self.codes.merge(&other.codes);
        self.ulps.merge(&other.ulps);
        self.degrees.merge(&other.degrees);
    }
}

/// Compares what a device answered with what it should; without a bound every bit must agree. Gives the first
/// difference beyond the bound.
///
/// # Panics
/// If the answers have another shape: backends are given the same job.
pub(crate) fn compare(expected: &[Answer], got: &[Answer], bound: Option<&Bound>) -> (Agreement, Option<Difference>) {
    assert_eq!(expected.len(), got.len(), "one answer for each map");
    let mut agreement = Agreement::default();
    let mut first = None;
    for (map, (expected, got)) in expected.iter().zip(got).enumerate() {
        assert_eq!((expected.len(), expected.format), (got.len(), got.format), "answers of one shape");
        let index = compare_map(expected, got, bound, &mut agreement);
        first = first.or(index.map(|index| Difference { map, index }));
    }
    (agreement, first)
}

fn compare_map(expected: &Answer, got: &Answer, bound: Option<&Bound>, agreement: &mut Agreement) -> Option<usize> {
    let mut first = None;
    let channels = expected.format.channels;
    for texel in 0..expected.texels() {
        let codes = texel * channels..(texel + 1) * channels;
        agreement.values += channels as u64;
        // Most texels agree.
        if codes.clone().all(|index| expected.bits(index) == got.bits(index)) {
            continue;
        }
        for index in codes.clone() {
            if expected.bits(index) == got.bits(index) {
                continue;
            }
            agreement.differing += 1;
            let (errors, most) = match ulps_of_1(expected.format.depth) {
                Some(_) => (&mut agreement.ulps, bound.map(|bound| bound.ulps)),
                None => (&mut agreement.codes, bound.map(|bound| bound.codes)),
            };
            let error = error_of(expected, got, index);
            errors.add(error);
            // NaN is beyond any bound.
            if most.is_none_or(|most| error.is_nan() || error > most) {
                first = first.or(Some(index));
            }
        }
        if let Some(angle) = expected.has_fine_directions().then(|| angle(expected, got, texel)).flatten() {
            agreement.degrees.add(angle);
            if bound.is_some_and(|bound| angle > bound.degrees) {
                let error = |index: &usize| error_of(expected, got, *index);
                first = first.or(codes.max_by(|a, b| error(a).total_cmp(&error(b))));
            }
        }
    }
    settle(expected, agreement);
    first
}

/// Counts those that agree into the means.
fn settle(expected: &Answer, agreement: &mut Agreement) {
    let (codes, directions) = (expected.len() as u64, expected.texels() as u64);
    let fill = |errors: &mut Errors, count: u64| {
        let missing = Errors { count: count.saturating_sub(errors.count), ..Errors::default() };
        errors.merge(&missing);
    };
    match ulps_of_1(expected.format.depth) {
        Some(_) => fill(&mut agreement.ulps, codes),
        None => fill(&mut agreement.codes, codes),
    }
    if expected.has_fine_directions() {
        fill(&mut agreement.degrees, directions);
    }
}

/// Units in the last place of 1 in 1; `None` for integer codes.
fn ulps_of_1(depth: Depth) -> Option<f64> {
    match depth {
        Depth::Bits8 | Depth::Bits16 => None,
        Depth::Float16 => Some(1024.0),
        Depth::Float32 => Some(8_388_608.0),
    }
}

fn error_of(expected: &Answer, got: &Answer, index: usize) -> f64 {
    let unit = ulps_of_1(expected.format.depth).unwrap_or(1.0);
    unit * (got.number(index) - expected.number(index)).abs()
}

/// The angle between the directions of a texel, in degrees; `None` for numbers, and where either has no direction.
fn angle(expected: &Answer, got: &Answer, texel: usize) -> Option<f64> {
    let (a, b) = (expected.direction(texel)?, got.direction(texel)?);
    (a != [0.0; 3] && b != [0.0; 3]).then(|| degrees(a, b))
}

#[cfg(test)]
mod tests {
    use super::super::answer::Meaning;
    use super::*;
    use crate::map::{Codes, Encoding, TexelFormat};
    use std::slice;

    fn floats(components: &[f32]) -> Answer {
        let format = TexelFormat { encoding: Encoding::Float, depth: Depth::Float32, channels: 3 };
        let codes = Codes::F32(components.into());
        Answer { meaning: Meaning::Normal, format, width: components.len() / 3, codes }
    }

    fn snorm(codes: &[u8]) -> Answer {
        let format = TexelFormat { encoding: Encoding::Snorm, depth: Depth::Bits8, channels: 3 };
        Answer { meaning: Meaning::Normal, format, width: codes.len() / 3, codes: Codes::U8(codes.into()) }
    }

    #[test]
    fn the_same_codes_agree() {
        let map = snorm(&[0, 0, 127, 90, 0, 90]);
        let (agreement, first) = compare(slice::from_ref(&map), slice::from_ref(&map), None);
        assert_eq!((agreement.values, agreement.differing, first), (6, 0, None));
        assert_eq!((agreement.codes.count, agreement.degrees.count), (6, 0));
    }

    #[test]
    fn directions_are_measured_in_degrees() {
        let (expected, got) = (floats(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0]), floats(&[0.0, 0.0, 1.0, 1.0, 1e-4, 0.0]));
        let bound = |degrees| Bound { codes: 0.0, ulps: 1e9, degrees };
        let compare = |degrees| compare(slice::from_ref(&expected), slice::from_ref(&got), Some(&bound(degrees)));
        let (agreement, first) = compare(1e-2);
        assert!((agreement.degrees.largest - 1e-4f64.to_degrees()).abs() < 1e-7, "{agreement:?}");
        assert_eq!((agreement.degrees.count, first), (2, None));
        assert_eq!(compare(5e-3).1, Some(Difference { map: 0, index: 4 }));
    }

    #[test]
    fn a_code_that_differs_is_found_and_measured() {
        // -1 is one below 0.
        let (expected, got) = (snorm(&[0, 0, 127, 90, 0, 90]), snorm(&[0, 0, 127, 90, 0xff, 90]));
        let maps = (&[expected][..], &[got][..]);
        let (agreement, first) = compare(maps.0, maps.1, None);
        assert_eq!((agreement.differing, first), (1, Some(Difference { map: 0, index: 4 })));
        assert!(agreement.codes.largest == 1.0 && (agreement.codes.mean - 1.0 / 6.0).abs() < 1e-15, "{agreement:?}");
        let bound = |codes| Bound { codes, ulps: 0.0, degrees: 0.0 };
        assert_eq!(compare(maps.0, maps.1, Some(&bound(1.0))).1, None);
        assert_eq!(compare(maps.0, maps.1, Some(&bound(0.9))).1, Some(Difference { map: 0, index: 4 }));
    }

    #[test]
    fn nan_is_beyond_every_bound() {
        let format = TexelFormat { encoding: Encoding::Float, depth: Depth::Float32, channels: 1 };
        let of = |value| Answer { meaning: Meaning::Parallax, format, width: 1, codes: Codes::F32(vec![value]) };
        let bound = Bound { codes: 1e9, ulps: 1e9, degrees: 1e9 };
        let (agreement, first) = compare(&[of(0.0)], &[of(f32::NAN)], Some(&bound));
        assert!(first.is_some() && agreement.ulps.largest == f64::INFINITY);
    }
}
