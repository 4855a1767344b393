//! What is seen while files are baked: a bar on a terminal, a line for each file elsewhere.

use super::print::{file_line, say};
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use texbake::batch::{Event, Job};
use texbake::stream::Monitor;

/// Shows how `jobs` get on, on stderr.
pub struct Progress<'a> {
    jobs: &'a [Job],
    monitor: &'a Monitor,
    verbosity: Verbosity,
    bar: Option<ProgressBar>,
    start: Instant,
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

impl<'a> Progress<'a> {
    pub fn new(jobs: &'a [Job], monitor: &'a Monitor, verbosity: Verbosity) -> Self {
        let shows_bar = verbosity != Verbosity::Quiet && std::io::stderr().is_terminal();
        let bytes = |job: &Job| std::fs::metadata(&job.input).map_or(0, |file| file.len());
        let bytes = if shows_bar { jobs.iter().map(bytes).collect() } else { vec![0; jobs.len()] };
        let state = Mutex::new(State { ended: 0, bytes, texels: vec![None; jobs.len()] });
        let bar = shows_bar.then(bar);
        Self { jobs, monitor, verbosity, bar, start: Instant::now(), state }
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

    /// Takes note of what happened to a job.
    pub fn watch(&self, event: Event<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            Event::Opened { job, size } => state.texels[job] = Some(size.texels() as u64),
            Event::Ended { job: index, outcome } => {
                let job = &self.jobs[index];
                state.ended += 1;
                if outcome.result.is_err() {
                    (state.bytes[index], state.texels[index]) = (0, Some(0));
                }
                let place = format!("{:>1$}/{2}", state.ended, self.jobs.len().to_string().len(), self.jobs.len());
                let shows_line = self.verbosity == Verbosity::Files && self.bar.is_none();
                let mut lines: Vec<String> = shows_line.then(|| file_line(&place, job, outcome)).into_iter().collect();
                if !shows_line {
                    lines.extend(job.failure(outcome).map(|reason| format!("error: {reason}")));
                }
                if self.verbosity != Verbosity::Quiet {
                    let fallback = outcome.result.as_ref().ok().and_then(|baked| baked.ran.fallback.as_ref());
                    let fallback = fallback.map(|reason| format!("{reason}; the CPU baked it instead"));
                    let warnings = outcome.warnings.iter().chain(fallback.as_ref());
                    lines.extend(warnings.map(|text| format!("warning: {}: {text}", job.input.display())));
                }
                let print = || lines.iter().for_each(say);
                self.bar.as_ref().map_or_else(print, |bar| bar.suspend(print));
            }
        }
    }

    fn redraw(&self, bar: &ProgressBar) {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let done = self.monitor.texels();
        let rate = done as f64 / 1e6 / self.start.elapsed().as_secs_f64();
        bar.set_length(state.expected_texels().max(done));
        bar.set_position(done);
        let left = if done == 0 { String::new() } else { format!(", {:#} left", HumanDuration(bar.eta())) };
        bar.set_message(format!("{}/{} files, {rate:.0} Mtexel/s{left}", state.ended, self.jobs.len()));
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
