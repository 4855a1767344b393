//! Which of many files are to be baked, and why.

use super::check::check;
use super::content::{Content, Look, PIECE};
use super::line::Line;
use super::reader::{Reader, Seen};
use super::reason::{Freshness, Reason};
use super::record::Record;
use crate::batch::targets::{self, Refusal};
use crate::batch::{Files, Job};
use crate::stream::Monitor;
use rayon::prelude::*;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Files to bake, and those that need not be baked: their outputs are what a bake would make of them.
///
/// ```no_run
/// use texbake::batch::{FreshPlan, Job};
/// use texbake::stream::Monitor;
///
/// # let jobs: Vec<Job> = Vec::new();
/// let monitor = Monitor::default();
/// // The folder of the outputs; what was baked is remembered there, in `.texbake-baked`.
/// let plan = FreshPlan::new(&jobs, "baked".as_ref(), false, &monitor);
/// for (job, freshness) in jobs.iter().zip(plan.files()) {
///     // wall_height.png: scale 8 -> 24
///     println!("{}: {freshness}", job.input.display());
/// }
/// let outcomes = plan.run(8, &monitor, &|_| ());
/// # let _ = outcomes;
/// for warning in plan.warnings() {
///     eprintln!("{warning}");
/// }
/// ```
pub struct FreshPlan<'a> {
    pub(super) jobs: &'a [Job],
    pub(super) decisions: Vec<Decision>,
    pub(super) record: Record,
    pub(super) seen: Seen,
    warnings: Mutex<Vec<String>>,
}

/// What is to be done with one file.
pub(super) enum Decision {
    /// Nothing.
    Fresh {
        /// How it was baked.
        line: Arc<Line>,
        /// The same with new states of its files, if they have others since.
        renewed: Option<Line>,
    },
    /// It is to be baked.
    Stale {
        /// Why.
        reason: Reason,
        /// Empty if one of them cannot be read: then the bake fails, and there is nothing to remember.
        inputs: Vec<Before>,
    },
    /// It must not be baked.
    Refused(Refusal),
}

/// An input before it is baked.
pub(super) struct Before {
    pub look: Look,
    /// What is in it, if that was known already, or it could be written to again without getting another state.
    pub content: Option<Content>,
}

impl<'a> FreshPlan<'a> {
    /// Decides about `jobs`, whose outputs lie below `folder`; all are to be baked if that `is_forced`.
    ///
    /// Files are read where nothing else can tell, several at a time, until `monitor` is cancelled: what is not known by
    /// then is [`Reason::Interrupted`]. Nothing is written.
    pub fn new(jobs: &'a [Job], folder: &Path, is_forced: bool, monitor: &Monitor) -> Self {
        let (record, warning) = Record::read(folder);
        let seen = Seen::default();
        let reader = Reader { seen: &seen, monitor, patience: PIECE as u64 };
        let decide = |(job, refusal): (&Job, Option<Refusal>)| match refusal {
            Some(refusal) => Decision::Refused(refusal),
            None => Decision::about(job, &record, is_forced, reader),
        };
        let refusals = targets::refusals(&Job::all_files(jobs));
        let decisions = jobs.par_iter().zip(refusals).map(decide).collect();
        Self { jobs, decisions, record, seen, warnings: Mutex::new(warning.into_iter().collect()) }
    }

    /// What was decided about each job, in their order.
    pub fn files(&self) -> impl Iterator<Item = Freshness> {
        self.decisions.iter().map(Decision::freshness)
    }

    /// What is wrong with the file that remembers what was baked.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Adds a warning; what is wrong with each of many files is told once.
    pub(super) fn warn(&self, text: String) {
        let mut warnings = self.warnings.lock().unwrap_or_else(PoisonError::into_inner);
        if !warnings.contains(&text) {
            warnings.push(text);
        }
    }
}

impl Decision {
    fn about(job: &Job, record: &Record, is_forced: bool, reader: Reader<'_>) -> Self {
        let reason = match is_forced {
            true => Reason::Forced,
            false => match check(job, record, reader) {
                Ok(fresh) => return fresh,
                Err(reason) => reason,
            },
        };
        if reader.monitor.is_cancelled() {
            return Self::Stale { reason, inputs: Vec::new() };
        }
        let Files { inputs, outputs } = job.files();
        let line = outputs.first().and_then(|output| record.line(output));
        let then = |place: usize| line.as_ref()?.inputs.get(place);
        let inputs = inputs.iter().enumerate().map(|(place, input)| Before::of(input, then(place), reader));
        Self::Stale { reason, inputs: inputs.collect::<Option<_>>().unwrap_or_default() }
    }

    pub fn freshness(&self) -> Freshness {
        match self {
            Self::Fresh { .. } => Freshness::Fresh,
            Self::Stale { reason, .. } => Freshness::Stale(reason.clone()),
            Self::Refused(refusal) => Freshness::Stale(Reason::Refused(refusal.error().to_string())),
        }
    }
}

impl Before {
    /// Looks at an input, and reads it if it was written to just now; `None` if it cannot be read. `then` is what was in
    /// it when its output was baked before.
    fn of(input: &Path, then: Option<&Content>, reader: Reader<'_>) -> Option<Self> {
        let look = Look::at(input).ok()?;
        let content = match then.filter(|then| then.is_known_by(&look)) {
            Some(then) => Some(then.clone()),
            None if look.is_settled => reader.seen.content(input, &look),
            None => Some(reader.content(input, &look).ok()??),
        };
        Some(Self { look, content })
    }

    /// The content of an input that is as it was before the bake; `None` if it is not, or there was an interrupt.
    pub fn unchanged(&self, input: &Path, reader: Reader<'_>) -> Option<Content> {
        let look = Look::at(input).ok().filter(|now| now.state == self.look.state)?;
        match &self.content {
            Some(content) if content.is_known_by(&look) => Some(content.clone()),
            // A write in the same tick of the clock has left no trace in the state.
            Some(content) => reader.content(input, &look).ok()?.filter(|now| now.hash == content.hash),
            None => reader.content(input, &look).ok()?,
        }
    }
}
