//! Files baked side by side.

use super::Job;
use super::fresh::Written;
use super::outcome::Outcome;
use super::targets::{self, Refusal};
use crate::error::Error;
use crate::map::Size;
use crate::stream::Monitor;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::thread::{self, Builder};

/// What happens while jobs run.
#[derive(Debug)]
pub enum Event<'a> {
    /// A job's input was opened.
    Opened {
        /// Its place in the list of jobs.
        job: usize,
        /// Size of its map.
        size: Size,
    },
    /// A job has ended, or was refused; not sent for jobs that an interrupt kept from their turn.
    Ended {
        /// Its place in the list of jobs.
        job: usize,
        /// How.
        outcome: &'a Outcome,
    },
}

/// Runs `jobs`, `at_once` of them at a time, in their order; one that fails does not stop the others.
///
/// A job with an output that would overwrite an input fails unopened, and so do all jobs that share one output.
///
/// Each is a stream of its own: its file is read, baked and written at the same time. `watch` is called from many
/// threads. The outcomes come back in the order of the jobs.
pub fn run(jobs: &[Job], at_once: usize, monitor: &Monitor, watch: &(dyn Fn(Event<'_>) + Sync)) -> Vec<Outcome> {
    let refusals = targets::refusals(&Job::all_files(jobs)).into_iter();
    let queue = jobs.iter().zip(refusals).map(|(job, refusal)| Queued { refusal, ..Queued::new(job) });
    run_queue(&queue.collect::<Vec<_>>(), at_once, monitor, watch)
}

/// A job that waits for its turn.
pub(super) struct Queued<'a> {
    pub job: &'a Job,
    /// Why it must not run.
    pub refusal: Option<Refusal>,
    /// What it wrote, if somebody wants to know.
    pub written: Option<Written>,
    /// Whether its input was there when the run began.
    pub was_there: bool,
}

impl<'a> Queued<'a> {
    pub fn new(job: &'a Job) -> Self {
        Self { job, refusal: None, written: None, was_there: job.input.exists() }
    }

    fn run(&self, monitor: &Monitor, opened: &dyn Fn(Size)) -> Outcome {
        let outcome = self.job.run(self.written.as_ref(), monitor, opened);
        if self.was_there { say_if_it_went(&self.job.input, outcome) } else { outcome }
    }
}

/// Runs jobs as [`run`] does, whose places are those in the queue.
pub(super) fn run_queue(
    queue: &[Queued<'_>],
    at_once: usize,
    monitor: &Monitor,
    watch: &(dyn Fn(Event<'_>) + Sync),
) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let refused = |refusal: &Refusal| OnceLock::from(Outcome::unopened(refusal.error()));
    let outcomes: Vec<OnceLock<Outcome>> =
        queue.iter().map(|queued| queued.refusal.as_ref().map_or_else(OnceLock::new, refused)).collect();
    let work = || {
        while !monitor.is_cancelled() {
            let index = next.fetch_add(1, Relaxed);
            let Some(queued) = queue.get(index) else { break };
            let run = || queued.run(monitor, &|size| watch(Event::Opened { job: index, size }));
            watch(Event::Ended { job: index, outcome: outcomes[index].get_or_init(run) });
        }
    };
    on_threads(at_once.min(queue.len()), &Builder::new, &work);
    outcomes
        .into_iter()
        .map(|outcome| outcome.into_inner().unwrap_or_else(|| Outcome::unopened(Error::Cancelled)))
        .collect()
}

/// Does `work` on so many threads at once, this one among them, or on as many as the system gives.
fn on_threads(count: usize, thread: &dyn Fn() -> Builder, work: &(dyn Fn() + Sync)) {
    thread::scope(|scope| {
        for _ in 1..count {
            if thread().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
}

/// Of an input that was there when the run began the path is written rightly.
fn say_if_it_went(input: &Path, outcome: Outcome) -> Outcome {
    let is_missing = matches!(
        &outcome.result,
        Err(Error::Io { path, source }) if path == input && source.kind() == ErrorKind::NotFound
    );
    if !is_missing {
        return outcome;
    }
    let went = Error::file(input, "it went after it was found", "put it back, or run again without it");
    Outcome { result: Err(went), ..outcome }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many threads do the work, of four with so many bytes of stack.
    fn threads(stack: usize) -> usize {
        let count = AtomicUsize::new(0);
        let thread = || Builder::new().stack_size(stack);
        on_threads(4, &thread, &|| _ = count.fetch_add(1, Relaxed));
        count.into_inner()
    }

    #[test]
    fn threads_that_the_system_refuses_are_not_missed() {
        assert_eq!(threads(1 << 20), 4);
        // No machine has so much room for a stack.
        assert_eq!(threads(1 << (usize::BITS - 2)), 1);
    }
}
