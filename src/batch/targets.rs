//! No output may overwrite an input, nor another output; nor may the report.

use super::Job;
use crate::error::{Error, Result};
use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

const REMEDY: &str = "choose another output";

/// Why each job must not run, or `None`: its output is an input, or the output of another job too.
///
/// All jobs of a clash are refused, so that their order decides nothing.
pub(super) fn refusals(jobs: &[Job]) -> Vec<Option<Error>> {
    let inputs = inputs(jobs);
    let places: Vec<PathBuf> = jobs.iter().map(|job| place(&job.output)).collect();
    let mut of_place: HashMap<&Path, Vec<&Job>> = HashMap::new();
    for (job, place) in jobs.iter().zip(&places) {
        of_place.entry(place).or_default().push(job);
    }
    let refusal = |(job, place): (&Job, &PathBuf)| {
        if let Some(input) = identity(place).and_then(|output| inputs.get(&output)) {
            let reason = format!("the output of {} would overwrite this input", job.input.display());
            return Some(Error::file(*input, reason, REMEDY));
        }
        let other = of_place[place.as_path()].iter().find(|other| !std::ptr::eq(**other, job))?;
        let reason = format!("both {} and {} would be baked into it", job.input.display(), other.input.display());
        Some(Error::file(&job.output, reason, "bake them into different folders, or change --name"))
    };
    jobs.iter().zip(&places).map(refusal).collect()
}

/// Fails if the report would overwrite an input, an output or the settings.
pub(super) fn check_report(report: &Path, jobs: &[Job], settings: Option<&Path>) -> Result<()> {
    let refused = |what: &str, file: &Path| {
        let reason = format!("the report would overwrite the {what} {}", file.display());
        Err(Error::file(report, reason, "choose another name for the report"))
    };
    let place_of_report = place(report);
    if let Some(input) = identity(&place_of_report).and_then(|report| inputs(jobs).remove(&report)) {
        return refused("input", input);
    }
    if let Some(settings) = settings.filter(|settings| place(settings) == place_of_report) {
        return refused("settings file", settings);
    }
    match jobs.iter().find(|job| place(&job.output) == place_of_report) {
        Some(job) => refused("output", &job.output),
        None => Ok(()),
    }
}

fn inputs(jobs: &[Job]) -> HashMap<Identity, &Path> {
    jobs.iter().filter_map(|job| Some((identity(&job.input)?, job.input.as_path()))).collect()
}

/// Where a file is written: links are resolved as far as there is something, the rest is as the file system compares
/// it.
fn place(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let resolved = |ancestor: &Path| Some((ancestor.canonicalize().ok()?, path.strip_prefix(ancestor).ok()?));
    let place = path.ancestors().find_map(resolved).map(|(existing, rest)| append(existing, rest));
    let place = place.unwrap_or_else(|| path.clone());
    if cfg!(any(windows, target_os = "macos")) { place.to_string_lossy().to_lowercase().into() } else { place }
}

/// A path below a folder in which nothing of it exists yet, and so no link.
fn append(folder: PathBuf, below: &Path) -> PathBuf {
    below.components().fold(folder, |mut path, part| {
        match part {
            Component::ParentDir => _ = path.pop(),
            part => path.push(part),
        }
        path
    })
}

/// What is the same for all names of one file, hard links included.
#[cfg(unix)]
type Identity = (u64, u64);

/// `None` if there is no such file.
#[cfg(unix)]
fn identity(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    std::fs::metadata(path).ok().map(|file| (file.dev(), file.ino()))
}

/// What is the same for all names of one file but hard links.
#[cfg(not(unix))]
type Identity = PathBuf;

/// `None` if there is no such file.
#[cfg(not(unix))]
fn identity(path: &Path) -> Option<Identity> {
    path.canonicalize().ok()
}
