//! Every kernel, in every precision, format, edge mode and encoding, on inputs of every kind.

mod bake;
mod blend;
mod inputs;
mod parallax;
mod tangents;

use super::chance::Chance;
use super::job::Job;
use crate::error::Result;
use crate::map::{Depth, Edge, Edges, Encoding, HeightType};
use crate::ops::Precision;

/// One job to verify, made when it is asked for.
pub(crate) struct Case {
    /// What the job is, in words: one of its kind, and its chance comes from it.
    pub name: String,
    /// The line of the report in which it counts.
    pub operation: &'static str,
    pub precision: Precision,
    make: Box<Make>,
}

/// Makes a job of chance.
type Make = dyn Fn(&mut Chance) -> Result<Job>;

/// How much is verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Every kernel on inputs of every kind, under options that are drawn for each case.
    Quick,
    /// Besides, every filter under every edge mode and convention, and every pair of formats that are blended.
    Full,
}

impl Case {
    fn new(
        operation: &'static str,
        precision: Precision,
        choices: &[&dyn std::fmt::Display],
        make: impl Fn(&mut Chance) -> Result<Job> + 'static,
    ) -> Self {
        let words = choices.iter().map(|choice| format!(", {choice}")).collect::<String>();
        Self { name: format!("{operation}, {precision}{words}"), operation, precision, make: Box::new(make) }
    }

    /// The job, whose inputs come from the seed and the case's name.
    pub fn job(&self, seed: u64) -> Result<Job> {
        (self.make)(&mut Chance::named(seed, &self.name))
    }
}

/// All cases.
pub(crate) fn cases(extent: Extent) -> Vec<Case> {
    [bake::cases(extent), parallax::cases(extent), blend::cases(extent), tangents::cases(extent)]
        .into_iter()
        .flatten()
        .collect()
}

const PRECISIONS: [Precision; 2] = [Precision::Exact, Precision::Fast];
const HEIGHT_TYPES: [HeightType; 3] = [HeightType::U8, HeightType::U16, HeightType::F32];

/// Every encoding at every depth that it goes with.
const CODES: [(Encoding, Depth); 8] = [
    (Encoding::Unorm, Depth::Bits8),
    (Encoding::Unorm, Depth::Bits16),
    (Encoding::Snorm, Depth::Bits8),
    (Encoding::Snorm, Depth::Bits16),
    (Encoding::Biased, Depth::Bits8),
    (Encoding::Biased, Depth::Bits16),
    (Encoding::Float, Depth::Float16),
    (Encoding::Float, Depth::Float32),
];

/// All nine edges of two axes.
fn every_edges() -> Vec<Edges> {
    let edges = [Edge::Wrap, Edge::Clamp, Edge::Mirror];
    edges.into_iter().flat_map(|x| edges.map(|y| Edges { x, y })).collect()
}

/// All choices in full runs; in quick ones one that is drawn.
fn some<T: Copy>(extent: Extent, draw: &mut Chance, choices: &[T]) -> Vec<T> {
    match extent {
        Extent::Quick => vec![draw.of(choices)],
        Extent::Full => choices.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_case_has_a_name_of_its_own_and_a_job() {
        for extent in [Extent::Quick, Extent::Full] {
            let cases = cases(extent);
            let names: HashSet<_> = cases.iter().map(|case| &case.name).collect();
            assert_eq!(names.len(), cases.len());
        }
        for case in cases(Extent::Quick).iter().step_by(7) {
            assert_eq!(case.job(1).unwrap(), case.job(1).unwrap(), "{}", case.name);
        }
    }

    /// How many pairs of these words no case of an operation has.
    fn missing(operation: &str, first: &[&str], second: &[&str]) -> Vec<String> {
        let names: Vec<String> = cases(Extent::Quick).into_iter().map(|case| case.name).collect();
        let has = |name: &str, word: &str| name.split(", ").any(|it| it == word);
        let pairs = first.iter().flat_map(|a| second.iter().map(move |b| (a, b)));
        pairs
            .filter(|(a, b)| !names.iter().any(|name| name.starts_with(operation) && has(name, a) && has(name, b)))
            .map(|(a, b)| format!("{operation}: {a} with {b}"))
            .collect()
    }

    #[test]
    fn quick_runs_have_every_pair_of_choices() {
        let kinds = ["random", "small", "extreme", "boundaries"];
        let filters = ["central", "sobel", "scharr", "prewitt"];
        let edges =
            ["wrap", "clamp", "mirror", "wrap/clamp", "clamp/wrap", "mirror/wrap", "wrap/mirror", "clamp/mirror"];
        let heights = ["u8", "u16", "f32"];
        let formats = ["unorm 8 xyz gl", "unorm 8 xyz dx", "snorm 16 xy gl", "biased 8 xy dx", "float 16f xyz gl"];
        let none: [String; 0] = [];
        for operation in ["normal map, exact", "both in one pass, exact"] {
            assert_eq!(missing(operation, &kinds[..3], &filters), none);
            assert_eq!(missing(operation, &heights, &edges), none);
            assert_eq!(missing(operation, &filters, &edges), none);
        }
        assert_eq!(missing("normal map, exact", &kinds[..3], &edges), none);
        assert_eq!(missing("normal map, exact", &heights, &formats), none);
        assert_eq!(missing("normal map, fast", &heights, &filters[..1]), none);
        assert_eq!(missing("parallax map, exact", &kinds[..3], &heights), none);
        assert_eq!(missing("parallax map of given normals, exact", &kinds[..3], &formats[..2]), none);
        let methods = ["weighted 1 and 1", "weighted 0 and 0", "masked by f32", "linear", "overlay", "udn", "rnm"];
        assert_eq!(missing("blend, exact", &methods, &kinds[..3]), none);
        let tangents = ["tangents of mikktspace, exact", "tangents of lengyel, exact", "tangents of hegde, exact"];
        for operation in tangents {
            assert_eq!(missing(operation, &["gl", "dx"], &["hills", "mirrored", "soup", "extreme"]), none);
        }
    }
}
