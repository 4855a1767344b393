//! What is stale is baked, and remembered.

use super::KERNEL_VERSION;
use super::key::Key;
use super::line::{BakedLine, Line, Output};
use super::plan::{Decision, FreshPlan};
use super::reader::Reader;
use super::written::Written;
use crate::batch::queue::{Queued, run_queue};
use crate::batch::{Event, Files, Job, Outcome};
use crate::error::Error;
use crate::stream::Monitor;
use std::path::Path;

/// Bytes of an input that are read after its bake in spite of an interrupt: what is complete is worth the tenth of a
/// second for which the program goes on.
const PATIENCE: u64 = 64 << 20;

impl FreshPlan<'_> {
    /// Runs the jobs that are stale as [`run`](crate::batch::run) does, `at_once` of them at a time; the others come out
    /// as they were baked then. Jobs that fail do not stop others, and nothing is remembered of them.
    ///
    /// Each job that is complete is remembered at once, in the record of the plan's folder. So a run that is killed, or
    /// whose `monitor` is cancelled, goes on where it stopped; only of a job with an input of more than 64 MiB that would
    /// still have to be read at that moment is nothing remembered. A record that cannot be written is a warning of
    /// [`FreshPlan::warnings`], and no job's error.
    ///
    /// `watch` is told of all jobs by their place in the list of all, first of those that are not begun.
    pub fn run(&self, at_once: usize, monitor: &Monitor, watch: &(dyn Fn(Event<'_>) + Sync)) -> Vec<Outcome> {
        self.renew();
        let mut outcomes = self.unbaked();
        let places: Vec<usize> = (0..self.jobs.len()).filter(|&job| outcomes[job].is_none()).collect();
        for (job, outcome) in outcomes.iter().enumerate() {
            outcome.iter().for_each(|outcome| watch(Event::Ended { job, outcome }));
        }
        let queued = |place: &usize| Queued { written: Some(Written::default()), ..Queued::new(&self.jobs[*place]) };
        let queue: Vec<Queued<'_>> = places.iter().map(queued).collect();
        let baked = run_queue(&queue, at_once, monitor, &|event| match event {
            Event::Opened { job, size } => watch(Event::Opened { job: places[job], size }),
            Event::Ended { job, outcome } => {
                self.remember(places[job], outcome, queue[job].written.as_ref(), monitor);
                watch(Event::Ended { job: places[job], outcome });
            }
        });
        for (place, outcome) in places.into_iter().zip(baked) {
            outcomes[place] = Some(Outcome { freshness: Some(self.decisions[place].freshness()), ..outcome });
        }
        outcomes.into_iter().flatten().collect()
    }

    /// What comes out without a bake: that of what is stale is not begun, or fails as its input is missing. Nothing is
    /// written.
    pub fn dry_run(&self) -> Vec<Outcome> {
        let unbaked = |(job, decision): (&Job, &Decision)| Outcome {
            freshness: Some(decision.freshness()),
            ..Outcome::unopened(job.check_input().err().unwrap_or(Error::Cancelled))
        };
        let outcomes = self.unbaked().into_iter().zip(self.jobs.iter().zip(&self.decisions));
        outcomes.map(|(outcome, job)| outcome.unwrap_or_else(|| unbaked(job))).collect()
    }

    /// The outcomes of jobs that are fresh, or refused; `None` for those to bake.
    fn unbaked(&self) -> Vec<Option<Outcome>> {
        let outcome = |(job, decision): (&Job, &Decision)| match decision {
            Decision::Fresh { line, .. } => {
                let BakedLine(baked) = line.baked.clone();
                Some(Outcome::fresh(&job.files(), baked, line.warnings.clone()))
            }
            Decision::Refused(refusal) => {
                Some(Outcome { freshness: Some(decision.freshness()), ..Outcome::unopened(refusal.error()) })
            }
            Decision::Stale { .. } => None,
        };
        self.jobs.iter().zip(&self.decisions).map(outcome).collect()
    }

    /// Brings the record into order, with the new states of files that are the same.
    fn renew(&self) {
        let renewed = self.decisions.iter().filter_map(|decision| match decision {
            Decision::Fresh { renewed, .. } => renewed.clone(),
            Decision::Stale { .. } | Decision::Refused(_) => None,
        });
        let renewed: Vec<Line> = renewed.collect();
        let done = self.record.tidy().and_then(|()| self.record.add(&renewed));
        done.unwrap_or_else(|error| self.warn(format!("{error}: what is baked may be baked again the next time")));
    }

    /// Remembers how a job was baked, unless an input changed in the meantime.
    fn remember(&self, place: usize, outcome: &Outcome, written: Option<&Written>, monitor: &Monitor) {
        let (Ok(baked), Decision::Stale { inputs, .. }) = (&outcome.result, &self.decisions[place]) else { return };
        let job = &self.jobs[place];
        let Files { inputs: files, outputs } = job.files();
        let reader = Reader { seen: &self.seen, monitor, patience: PATIENCE };
        let inputs = files.iter().zip(inputs).map(|(input, before)| before.unchanged(input, reader));
        let inputs = inputs.collect::<Option<Vec<_>>>().filter(|inputs| inputs.len() == files.len());
        let output = |path: &&Path| Some(Output { name: self.record.name(path), content: written?.content(path)? });
        let outputs = outputs.iter().map(output).collect::<Option<Vec<_>>>();
        let Some((inputs, outputs)) = inputs.zip(outputs) else { return };
        let line = Line {
            outputs,
            kernel: KERNEL_VERSION,
            options: Key::of(job, Some(&baked.ran)),
            inputs,
            baked: BakedLine(baked.clone()),
            warnings: outcome.warnings.clone(),
        };
        self.record.add(&[line]).unwrap_or_else(|error| {
            self.warn(format!("{error}: what is baked may be baked again the next time"));
        });
    }
}
