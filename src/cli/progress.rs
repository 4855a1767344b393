//! What is seen while files are baked: a bar on a terminal, a line for each file elsewhere.

use super::args::Reporting;
use super::print::{file_line, say};
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use texbake::batch::{Event, Freshness, Job};
use texbake::stream::Monitor;
use texbake::{Ran, Size};

/// Shows how the work gets on, on stderr.
pub struct Progress<'a> {
    monitor: &'a Monitor,
    verbosity: Verbosity,
    bar: Option<ProgressBar>,
    start: Instant,
    /// Texels that the monitor counted before.
    texels_before: u64,
    state: Mutex<State>,
}

/// What is printed besides errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verbosity {
    /// Nothing.
    Quiet,
    /// Warnings.
    Warnings,
    /// Warnings, and without a terminal a line for each file.
    Files,
}

/// What is known of the work.
struct State {
    ended: usize,
    /// Bytes of each input; zero once it is known that they give no texels.
    bytes: Vec<u64>,
    /// Texels of each input, once it was opened.
    texels: Vec<Option<u64>>,
}

/// What became of an input, in words.
pub struct Ending {
    /// The line of a file that is one of many; `None` if it is alone.
    pub line: Option<String>,
    /// Why it failed, if it did.
    pub failure: Option<String>,
    /// What looks wrong, with the names of the files.
    pub warnings: Vec<String>,
    /// Whether its texels were worked on.
    pub succeeded: bool,
}

/// What is said of work that a GPU left to the CPU.
pub fn fallback(ran: &Ran) -> Option<String> {
    ran.fallback.as_ref().map(|reason| format!("{reason}; the CPU did it instead"))
}

impl Verbosity {
    /// Quiet if that was asked for.
    pub fn of(reporting: &Reporting, otherwise: Self) -> Self {
        if reporting.quiet { Self::Quiet } else { otherwise }
    }
}

impl<'a> Progress<'a> {
    /// For work on `inputs`, which the indices of files count through.
    pub fn new(inputs: &[&Path], monitor: &'a Monitor, verbosity: Verbosity) -> Self {
        let shows_bar = verbosity != Verbosity::Quiet && std::io::stderr().is_terminal();
        let bytes = |input: &&Path| std::fs::metadata(input).map_or(0, |file| file.len());
        let bytes = if shows_bar { inputs.iter().map(bytes).collect() } else { vec![0; inputs.len()] };
        let state = Mutex::new(State { ended: 0, bytes, texels: vec![None; inputs.len()] });
        let bar = shows_bar.then(bar);
        Self { monitor, verbosity, bar, start: Instant::now(), texels_before: monitor.texels(), state }
    }

    /// Does `work` while the bar moves.
    pub fn during<T>(&self, work: impl FnOnce() -> T) -> T {
        let Some(bar) = &self.bar else { return work() };
        let result = std::thread::scope(|scope| {
            let (done, wait) = channel::<()>();
            scope.spawn(move || {
                while wait.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout) {
                    self.redraw(bar);
                }
            });
            let result = work();
            drop(done);
            result
        });
        bar.finish_and_clear();
        result
    }

    /// Takes note of what happened to one of `jobs`.
    pub fn watch(&self, jobs: &[Job], event: Event<'_>) {
        match event {
            Event::Opened { job, size } => self.opened(job, size),
            Event::Ended { job: index, outcome } if outcome.freshness == Some(Freshness::Fresh) => self.passed(index),
            Event::Ended { job: index, outcome } => {
                let job = &jobs[index];
                let ran = outcome.result.as_ref().ok().map(|baked| &baked.ran);
                let fallback = ran.and_then(fallback);
                let warnings = outcome.warnings.iter().chain(&fallback);
                let ending = Ending {
                    line: Some(file_line(job, outcome)),
                    failure: job.failure(outcome),
                    warnings: warnings.map(|text| format!("{}: {text}", job.input.display())).collect(),
                    succeeded: ran.is_some(),
                };
                self.ended(index, ending);
            }
        }
    }

    /// Takes note of the size of an input.
    pub fn opened(&self, index: usize, size: Size) {
        self.state().texels[index] = Some(size.texels() as u64);
    }

    /// Takes note of an input that needs no work.
    fn passed(&self, index: usize) {
        let mut state = self.state();
        state.ended += 1;
        (state.bytes[index], state.texels[index]) = (0, Some(0));
    }

    /// Takes note of the end of the work on an input, and says so.
    pub fn ended(&self, index: usize, ending: Ending) {
        let mut state = self.state();
        state.ended += 1;
        if !ending.succeeded {
            (state.bytes[index], state.texels[index]) = (0, Some(0));
        }
        let files = state.texels.len();
        let place = format!("{:>1$}/{files}", state.ended, files.to_string().len());
        let shows_line = self.verbosity == Verbosity::Files && self.bar.is_none();
        let mut lines: Vec<String> = match (shows_line, ending.line, ending.failure) {
            (true, Some(line), _) => vec![format!("[{place}] {line}")],
            (_, _, failure) => failure.map(|reason| format!("error: {reason}")).into_iter().collect(),
        };
        if self.verbosity != Verbosity::Quiet {
            lines.extend(ending.warnings.iter().map(|text| format!("warning: {text}")));
        }
        let print = || lines.iter().for_each(say);
        self.bar.as_ref().map_or_else(print, |bar| bar.suspend(print));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn redraw(&self, bar: &ProgressBar) {
        let state = self.state();
        let done = self.monitor.texels().saturating_sub(self.texels_before);
        let rate = done as f64 / 1e6 / self.start.elapsed().as_secs_f64();
        bar.set_length(state.expected_texels().max(done));
        bar.set_position(done);
        let left = if done == 0 { String::new() } else { format!(", {:#} left", HumanDuration(bar.eta())) };
        bar.set_message(format!("{}/{} files, {rate:.0} Mtexel/s{left}", state.ended, state.texels.len()));
    }
}

impl State {
    /// Texels of all files; those not opened yet count as many for a byte as the others.
    fn expected_texels(&self) -> u64 {
        let known = self.texels.iter().zip(&self.bytes).filter_map(|(texels, bytes)| Some(((*texels)?, *bytes)));
        let (texels, bytes) = known.fold((0, 0), |sum, file| (sum.0 + file.0, sum.1 + file.1));
        let all: u64 = self.bytes.iter().sum();
        if bytes == 0 { texels } else { (texels as f64 * (all as f64 / bytes as f64)) as u64 }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:32} {percent:>3} %  {msg}");
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}
