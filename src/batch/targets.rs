//! No output may overwrite an input, nor another output.

use super::Job;
use crate::error::{Error, Result};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Fails if the jobs cannot all run without harm: two of them have one output, or an output, or the report, is an
/// input.
///
/// # Errors
/// [`Error::File`] names the output and the inputs that are concerned.
pub fn check_targets(jobs: &[Job], report: Option<&Path>) -> Result<()> {
    let overwritten = "choose another output";
    let mut outputs = HashMap::new();
    for job in jobs {
        if let Some(other) = outputs.insert(spelling(&job.output), &job.input) {
            let reason = format!("both {} and {} would be baked into it", other.display(), job.input.display());
            return Err(Error::file(&job.output, reason, "bake them into different folders, or change --name"));
        }
    }
    let inputs: HashMap<_, _> = jobs.iter().filter_map(|job| Some((identity(&job.input)?, &job.input))).collect();
    for job in jobs {
        if let Some(input) = identity(&job.output).and_then(|output| inputs.get(&output)) {
            let reason = format!("the output of {} would overwrite this input", job.input.display());
            return Err(Error::file(*input, reason, overwritten));
        }
    }
    if let Some(report) = report
        && let Some(input) = identity(report).and_then(|report| inputs.get(&report))
    {
        return Err(Error::file(
            report,
            format!("the report would overwrite the input {}", input.display()),
            overwritten,
        ));
    }
    Ok(())
}

/// A path as the file system compares it.
fn spelling(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    if cfg!(any(windows, target_os = "macos")) { path.to_string_lossy().to_lowercase().into() } else { path }
}

/// What is the same for all names of one file, hard links included; `None` if there is no such file.
#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    std::fs::metadata(path).ok().map(|file| (file.dev(), file.ino()))
}

/// What is the same for all names of one file but hard links; `None` if there is no such file.
#[cfg(not(unix))]
fn identity(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok()
}
