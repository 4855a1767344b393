//! From a job that fails to the smallest one, in words.

use super::agreement::Difference;
use super::answer::{Answer, Meaning};
use super::cases::Case;
use super::job::Job;
use super::report::Mismatch;
use super::shrink::shrink;
use super::subject::{Options, Subject};
use crate::baker::Baker;
use crate::ops::Precision;

/// A job that fails, and where.
pub(super) struct Failing {
    job: Job,
    difference: Difference,
}

/// The smallest job that fails as `check` says, from one that does.
pub(super) fn smallest(job: Job, difference: Difference, check: impl Fn(&Job) -> Option<Difference>) -> Failing {
    let smaller = |job: &Job, difference: &Difference| job.smaller(difference.map, difference.index);
    let (job, difference) = shrink((job, difference), smaller, check);
    Failing { job, difference }
}

impl Failing {
    /// What everybody says of it.
    pub fn describe(&self, subject: &Subject, case: &Case, options: &Options) -> Mismatch {
        let Difference { map, index } = self.difference;
        let exact = self.job.with_precision(Precision::Exact);
        let said = |job: &Job, baker: &Baker| match job.run(baker) {
            Ok(answers) => describe_code(&answers[map], index),
            Err(error) => error.to_string(),
        };
        let reference = exact.run(&Baker::reference()).unwrap_or_default();
        Mismatch {
            case: case.name.clone(),
            input: self.job.input(),
            place: reference.get(map).map(|answer| describe_place(answer, index)).unwrap_or_default(),
            device: said(&self.job, subject.baker()),
            cpu: said(&self.job, &Baker::cpu()),
            specification: said(&exact, &Baker::reference()),
            oracle: self.job.real(map, index).map(|real| {
                let code = reference.get(map).and_then(|answer| real.code(answer.format));
                code.map_or(format!("the component is {real}"), |code| {
                    format!("the component is {real}: code {code:#x}")
                })
            }),
            command: command(subject, case, options),
        }
    }
}

/// A code as the number that it stores, and its bits.
fn describe_code(answer: &Answer, index: usize) -> String {
    format!("{} ({:#x})", answer.number(index), answer.bits(index))
}

fn describe_place(answer: &Answer, index: usize) -> String {
    let texel = index / answer.format.channels;
    let channel = answer.channel(index);
    match answer.meaning {
        Meaning::Tangent => format!("triangle {}, corner {}, {channel}", texel / 3, texel % 3),
        _ => format!("column {}, row {}, {channel}", texel % answer.width, texel / answer.width),
    }
}

/// What repeats a case.
fn command(subject: &Subject, case: &Case, options: &Options) -> String {
    let place = match subject.adapter_name() {
        None => "--backend cpu".to_owned(),
        Some(name) => format!("--adapter {name:?}"),
    };
    let full = if options.full { " --full" } else { "" };
    let sabotage = if subject.is_sabotaged() { " --sabotage" } else { "" };
    format!("texbake verify {place} --seed {}{full}{sabotage} --only {:?}", options.seed, case.name)
}
