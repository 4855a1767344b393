//! What is stale is baked, and remembered.

use super::KERNEL_VERSION;
use super::content::Content;
use super::key;
use super::line::{BakedLine, Line, Output};
use super::plan::{Before, Decision, FreshPlan};
use super::reason::{Freshness, Reason};
use crate::baker::Baked;
use crate::batch::{Event, Files, Job, Outcome, run, targets};
use crate::error::Error;
use crate::stream::Monitor;
use std::path::Path;

impl FreshPlan<'_> {
    /// Runs the jobs that are stale as [`run`] does. Each that is complete is remembered at once, so that a run that is
    /// killed goes on where it stopped; the others come out as they were baked then.
    ///
    /// `watch` is told of all jobs by their place in the list of all, first of those that are not begun.
    pub fn run(&self, at_once: usize, monitor: &Monitor, watch: &(dyn Fn(Event<'_>) + Sync)) -> Vec<Outcome> {
        self.renew();
        let mut outcomes = self.unbaked();
        let places: Vec<usize> = (0..self.jobs.len()).filter(|&job| outcomes[job].is_none()).collect();
        for (job, outcome) in outcomes.iter().enumerate() {
            outcome.iter().for_each(|outcome| watch(Event::Ended { job, outcome }));
        }
        let stale: Vec<Job> = places.iter().map(|&place| self.jobs[place].clone()).collect();
        let baked = run(&stale, at_once, monitor, &|event| match event {
            Event::Opened { job, size } => watch(Event::Opened { job: places[job], size }),
            Event::Ended { job, outcome } => {
                self.remember(places[job], outcome);
                watch(Event::Ended { job: places[job], outcome });
            }
        });
        for (place, outcome) in places.into_iter().zip(baked) {
            outcomes[place] = Some(Outcome { freshness: Some(self.decisions[place].freshness()), ..outcome });
        }
        outcomes.into_iter().flatten().collect()
    }

    /// What comes out without a bake: that of what is stale is not begun. Nothing is written.
    pub fn dry_run(&self) -> Vec<Outcome> {
        let not_begun = |decision: &Decision| Outcome {
            freshness: Some(decision.freshness()),
            ..Outcome::unopened(Error::Cancelled)
        };
        let outcomes = self.unbaked().into_iter().zip(&self.decisions);
        outcomes.map(|(outcome, decision)| outcome.unwrap_or_else(|| not_begun(decision))).collect()
    }

    /// The outcomes of jobs that are fresh, or refused; `None` for those to bake.
    fn unbaked(&self) -> Vec<Option<Outcome>> {
        let is_refused = |decision: &Decision| matches!(decision, Decision::Stale { reason: Reason::Refused(_), .. });
        let refusals = match self.decisions.iter().any(is_refused) {
            true => targets::refusals(&Job::all_files(self.jobs)),
            false => self.jobs.iter().map(|_| None).collect(),
        };
        let outcomes = self.jobs.iter().zip(&self.decisions).zip(refusals);
        let outcome = |((job, decision), refusal): ((&Job, &Decision), Option<Error>)| match (decision, refusal) {
            (_, Some(error)) => {
                let freshness = Some(Freshness::Stale(Reason::Refused(error.to_string())));
                Some(Outcome { freshness, ..Outcome::unopened(error) })
            }
            (Decision::Fresh { line, .. }, None) => {
                let BakedLine(baked) = line.baked.clone();
                Some(Outcome::fresh(&job.files(), baked, line.warnings.clone()))
            }
            (Decision::Stale { .. }, None) => None,
        };
        outcomes.map(outcome).collect()
    }

    /// Brings the record into order, with the new states of files that are the same.
    fn renew(&self) {
        let renewed = self.decisions.iter().filter_map(|decision| match decision {
            Decision::Fresh { renewed, .. } => renewed.clone(),
            Decision::Stale { .. } => None,
        });
        let renewed: Vec<Line> = renewed.collect();
        let done = self.record.tidy().and_then(|()| self.record.add(&renewed));
        done.unwrap_or_else(|error| self.warn(format!("{error}: what is baked may be baked again the next time")));
    }

    /// Remembers how a job was baked, unless an input changed in the meantime.
    fn remember(&self, place: usize, outcome: &Outcome) {
        let (Ok(baked), Decision::Stale { inputs, .. }) = (&outcome.result, &self.decisions[place]) else { return };
        let Some(line) = self.line(&self.jobs[place], inputs, baked, &outcome.warnings) else { return };
        self.record.add(&[line]).unwrap_or_else(|error| {
            self.warn(format!("{error}: what is baked may be baked again the next time"));
        });
    }

    /// `None` if a file is not what the job read or wrote any more.
    fn line(&self, job: &Job, before: &[Before], baked: &Baked, warnings: &[String]) -> Option<Line> {
        let Files { inputs, outputs } = job.files();
        let known = inputs.iter().zip(before).map(|(input, before)| before.unchanged(input));
        let inputs: Vec<Content> = known.collect::<Option<_>>().filter(|_| before.len() == inputs.len())?;
        let output = |path: &&Path| {
            let content = Content::now(path)?;
            Some(Output { name: self.record.name(path), content })
        };
        Some(Line {
            outputs: outputs.iter().map(output).collect::<Option<_>>()?,
            kernel: KERNEL_VERSION,
            options: key::of(job, &baked.ran.name()),
            inputs,
            baked: BakedLine(baked.clone()),
            warnings: warnings.to_vec(),
        })
    }
}

impl Before {
    /// The content of an input that is as it was before the bake.
    fn unchanged(&self, input: &Path) -> Option<Content> {
        // What is complete is remembered, interrupted or not.
        let content = Content::read(input, &self.look, &Monitor::default()).ok()?;
        let was_same = self.content.as_ref().is_none_or(|before| before.hash == content.hash);
        was_same.then_some(content)
    }
}
