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
    make: Box<dyn Fn(&mut Chance) -> Result<Job>>,
}

/// How much is verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Each choice of each option with each kernel, not every mix of them.
    Quick,
    /// Every mix.
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

/// Some of all mixes: of quick runs one for each turn, which goes round all choices; of full ones all.
fn turns<T: Copy>(extent: Extent, turn: usize, choices: &[T]) -> Vec<T> {
    match extent {
        Extent::Quick => vec![choices[turn % choices.len()]],
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
        for case in cases(Extent::Quick) {
            assert_eq!(case.job(1).unwrap(), case.job(1).unwrap(), "{}", case.name);
        }
    }

    /// What a quick run must not leave out.
    #[test]
    fn quick_runs_have_every_choice() {
        let names: Vec<String> = cases(Extent::Quick).into_iter().map(|case| case.name).collect();
        let has = |operation: &str, word: &str| {
            names.iter().any(|name| name.starts_with(operation) && name.split(", ").any(|it| it == word))
        };
        let edges = every_edges().into_iter().map(|edges| edges.to_string()).collect::<Vec<_>>();
        for precision in ["exact", "fast"] {
            for operation in ["normal map", "parallax map"] {
                let operation = format!("{operation}, {precision}");
                let fixed = ["u8", "u16", "f32", "central", "sobel", "scharr", "prewitt"].map(str::to_owned);
                for word in fixed.iter().chain(&edges) {
                    assert!(has(&operation, &word.replace(',', "/")), "{operation}: {word}");
                }
            }
        }
    }
}
