//! What becomes of the work on some files.

use super::fresh::Freshness;
use super::targets::Files;
use crate::baker::Baked;
use crate::error::{Error, Result};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// What became of a job.
#[derive(Debug)]
pub struct Outcome<T = Baked> {
    /// How it ran; [`Error::Cancelled`] if it was stopped or never begun, [`Error::File`] if an output would overwrite
    /// an input, or another output.
    pub result: Result<T>,
    /// What the user should know about the files.
    pub warnings: Vec<String>,
    /// From opening the inputs to closing the outputs; `None` if the inputs were never opened.
    pub time: Option<Duration>,
    /// Bytes of the input files.
    pub bytes_in: u64,
    /// Bytes of the output files; zero if there is none.
    pub bytes_out: u64,
    /// Whether the outputs were what the job would have baked, or why not; `None` if nobody asked.
    pub freshness: Option<Freshness>,
}

impl<T> Outcome<T> {
    /// Does `work` on `files`, which adds to the warnings.
    pub(super) fn of(files: &Files<'_>, work: impl FnOnce(&mut Vec<String>) -> Result<T>) -> Self {
        let start = Instant::now();
        let mut warnings = Vec::new();
        // A fault in the code for one file must not take the other files with it.
        let result = catch_unwind(AssertUnwindSafe(|| work(&mut warnings)))
            .unwrap_or_else(|panic| Err(fault(files.inputs[0], panic.as_ref())));
        let bytes_out = if result.is_ok() { bytes(&files.outputs) } else { 0 };
        let (time, bytes_in) = (Some(start.elapsed()), bytes(&files.inputs));
        Self { result, warnings, time, bytes_in, bytes_out, freshness: None }
    }

    /// What needed no work: it was done before, with this result.
    pub(super) fn fresh(files: &Files<'_>, result: T, warnings: Vec<String>) -> Self {
        let (bytes_in, bytes_out) = (bytes(&files.inputs), bytes(&files.outputs));
        Self { result: Ok(result), warnings, time: None, bytes_in, bytes_out, freshness: Some(Freshness::Fresh) }
    }

    /// What was not begun.
    pub(super) fn unopened(error: Error) -> Self {
        let (warnings, freshness) = (Vec::new(), None);
        Self { result: Err(error), warnings, time: None, bytes_in: 0, bytes_out: 0, freshness }
    }

    /// What came of the work that was done; `None` if it failed, or none was needed.
    pub fn baked(&self) -> Option<&T> {
        self.result.as_ref().ok().filter(|_| self.freshness != Some(Freshness::Fresh))
    }

    /// Why it failed, with `what` it was about where the error names no file; `None` if it did not fail.
    pub(super) fn failure(&self, what: impl std::fmt::Display) -> Option<String> {
        match self.result.as_ref().err()? {
            Error::Cancelled => None,
            error @ (Error::Io { .. } | Error::File { .. } | Error::Unclear { .. } | Error::TooLarge { .. }) => {
                Some(error.to_string())
            }
            error => Some(format!("{what}: {error}")),
        }
    }
}

/// Bytes of those files that are there.
fn bytes(paths: &[&Path]) -> u64 {
    paths.iter().filter_map(|path| Some(std::fs::metadata(path).ok()?.len())).sum()
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
