//! Files baked side by side.

use super::targets;
use crate::baker::{Baked, Baker};
use crate::error::{Error, Result};
use crate::io::{ReadOptions, create_normals, open_heights};
use crate::map::Size;
use crate::ops::bake::NormalOptions;
use crate::stream::Monitor;
use std::any::Any;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// One file to bake.
#[derive(Clone)]
pub struct Job {
    /// The height map file.
    pub input: PathBuf,
    /// The normal map file; its folders are created.
    pub output: PathBuf,
    /// How the input is read.
    pub read: ReadOptions,
    /// What is baked.
    pub options: NormalOptions,
    /// Where it runs.
    pub baker: Arc<Baker>,
}

/// What became of a job.
#[derive(Debug)]
pub struct Outcome {
    /// How it ran; [`Error::Cancelled`] if it was stopped or never begun, [`Error::File`] if its output would overwrite
    /// an input, or is the output of another job too.
    pub result: Result<Baked>,
    /// What the user should know about the file.
    pub warnings: Vec<String>,
    /// From opening the input to closing the output; `None` if the input was never opened.
    pub time: Option<Duration>,
    /// Bytes of the input file.
    pub bytes_in: u64,
    /// Bytes of the output file; zero if there is none.
    pub bytes_out: u64,
}

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
/// A job whose output would overwrite an input fails unopened, and so do all jobs that share one output.
///
/// Each is a stream of its own: its file is read, baked and written at the same time. `watch` is called from many
/// threads. The outcomes come back in the order of the jobs.
pub fn run(jobs: &[Job], at_once: usize, monitor: &Monitor, watch: &(dyn Fn(Event<'_>) + Sync)) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let unopened = |error| OnceLock::from(Outcome::unopened(error));
    let refusals = targets::refusals(jobs).into_iter();
    let outcomes: Vec<OnceLock<Outcome>> =
        refusals.map(|refusal| refusal.map_or_else(OnceLock::new, unopened)).collect();
    let work = || {
        while !monitor.is_cancelled() {
            let index = next.fetch_add(1, Relaxed);
            let Some(job) = jobs.get(index) else { break };
            let run = || job.run(monitor, &|size| watch(Event::Opened { job: index, size }));
            watch(Event::Ended { job: index, outcome: outcomes[index].get_or_init(run) });
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..at_once.min(jobs.len()) {
            scope.spawn(work);
        }
        work();
    });
    outcomes
        .into_iter()
        .map(|outcome| outcome.into_inner().unwrap_or_else(|| Outcome::unopened(Error::Cancelled)))
        .collect()
}

impl Job {
    /// Why it failed, with the name of the file; `None` if it did not.
    pub fn failure(&self, outcome: &Outcome) -> Option<String> {
        match outcome.result.as_ref().err()? {
            Error::Cancelled => None,
            error @ (Error::Io { .. } | Error::File { .. } | Error::TooLarge { .. }) => Some(error.to_string()),
            error => Some(format!("{}: {error}", self.input.display())),
        }
    }

    fn run(&self, monitor: &Monitor, opened: &dyn Fn(Size)) -> Outcome {
        let start = Instant::now();
        let warnings = RefCell::new(Vec::new());
        let open = || {
            let file = open_heights(&self.input, &self.read)?;
            *warnings.borrow_mut() = file.warnings;
            opened(file.rows.size());
            Ok(file.rows)
        };
        let create = |size| {
            let folder = self.output.parent().unwrap_or(Path::new(""));
            std::fs::create_dir_all(folder).map_err(Error::io(folder))?;
            create_normals(&self.output, size, self.options.format)
        };
        // A fault in the code for one file must not take the other files with it.
        let result = catch_unwind(AssertUnwindSafe(|| self.baker.normal_rows(&open, &create, &self.options, monitor)))
            .unwrap_or_else(|panic| Err(fault(&self.input, panic.as_ref())));
        let mut warnings = warnings.take();
        warnings.extend(result.as_ref().ok().and_then(inexact_scale));
        let bytes = |path: &Path| std::fs::metadata(path).map_or(0, |file| file.len());
        let bytes_out = if result.is_ok() { bytes(&self.output) } else { 0 };
        Outcome { result, warnings, time: Some(start.elapsed()), bytes_in: bytes(&self.input), bytes_out }
    }
}

impl Outcome {
    fn unopened(error: Error) -> Self {
        Self { result: Err(error), warnings: Vec::new(), time: None, bytes_in: 0, bytes_out: 0 }
    }
}

/// Says so if the scale had to be rounded.
fn inexact_scale(baked: &Baked) -> Option<String> {
    let scale = baked.scale;
    (!scale.exact).then(|| format!("the scale has too many digits: {scale}, the nearest one that fits, was used"))
}

/// A panic as an error of the file that caused it.
fn fault(input: &Path, panic: &(dyn Any + Send)) -> Error {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
    Error::file(input, format!("a fault in texbake: {text}"), "please report it with this file")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_names_the_file_that_caused_it() {
        let text = |panic: Box<dyn Any + Send>| fault(Path::new("wall_height.png"), panic.as_ref()).to_string();
        let said = |message| format!("wall_height.png: a fault in texbake: {message}; please report it with this file");
        assert_eq!(text(Box::new("index out of range")), said("index out of range"));
        assert_eq!(text(Box::new(String::from("no row 3"))), said("no row 3"));
        assert_eq!(text(Box::new(3)), said("no message"));
    }
}
