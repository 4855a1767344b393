//! From a job that fails to the smallest one, in words.

use super::agreement::Difference;
use super::answer::{Answer, Meaning};
use super::cases::Case;
use super::job::Job;
use super::options::Options;
use super::report::{Mismatch, OracleAnswer, Stored};
use super::shrink::{Try, shrink};
use crate::baker::Baker;
use crate::ops::Precision;

/// Who gives the answers that are wrong.
pub(super) struct Origin<'a> {
    pub baker: &'a Baker,
    /// `None` for the CPU.
    pub adapter: Option<String>,
    pub is_sabotaged: bool,
}

/// A job that fails, and where.
pub(super) struct Failing {
    job: Job,
    difference: Difference,
}

/// The smallest job that fails as `check` says, from one that does.
pub(super) fn smallest(job: Job, difference: Difference, check: impl FnMut(&Job) -> Option<Difference>) -> Failing {
    let smaller = |job: &Job, difference: &Difference, try_: Try<'_, Job>| {
        job.smaller(difference.map, difference.index).into_iter().try_for_each(try_)
    };
    let (job, difference) = shrink((job, difference), smaller, check);
    Failing { job, difference }
}

impl Failing {
    /// What everybody says of it.
    pub fn describe(&self, origin: &Origin<'_>, case: &Case, options: &Options) -> Mismatch {
        let Difference { map, index } = self.difference;
        let exact = self.job.with_precision(Precision::Exact);
        let reference = exact.run(&Baker::reference()).unwrap_or_default();
        let answer = reference.get(map);
        let stored = |answer: &Answer| Stored { number: answer.number(index), bits: answer.bits(index) };
        let said_by = |baker: &Baker| self.job.run(baker).ok()?.get(map).map(stored);
        Mismatch {
            case: case.name.clone(),
            input: self.job.input(),
            place: answer.map(|answer| place(answer, index)).unwrap_or_default(),
            device: said_by(origin.baker),
            cpu: said_by(&Baker::cpu()),
            specification: answer.map(stored),
            oracle: self.job.real(map, index).map(|real| OracleAnswer {
                component: real.to_string(),
                bits: answer.and_then(|answer| real.code(answer.format)),
            }),
            command: command(origin, case, options),
        }
    }
}

fn place(answer: &Answer, index: usize) -> String {
    let texel = index / answer.format.channels;
    let channel = answer.channel(index);
    match answer.meaning {
        Meaning::Tangent => format!("triangle {}, corner {}, {channel}", texel / 3, texel % 3),
        _ => format!("column {}, row {}, {channel}", texel % answer.width, texel / answer.width),
    }
}

/// What repeats a case.
fn command(origin: &Origin<'_>, case: &Case, options: &Options) -> String {
    let place = match &origin.adapter {
        None => "--backend cpu".to_owned(),
        Some(name) => format!("--adapter {}", quoted(name)),
    };
    let full = if options.full { " --full" } else { "" };
    let sabotage = if origin.is_sabotaged { " --sabotage" } else { "" };
    format!("texbake verify {place} --seed {}{full}{sabotage} --only {}", options.seed, quoted(&case.name))
}

/// A text as a shell takes it for one word.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace(['\\', '"', '$', '`'], ""))
}
