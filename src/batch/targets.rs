//! No output may overwrite an input, nor another output; nor may the report.

use super::place::place;
use crate::error::{Error, Result};
use crate::io::file_state::Identity;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The files that a job reads and writes.
#[derive(Debug, Clone)]
pub struct Files<'a> {
    /// What it reads; the first one gives it its name.
    pub inputs: Vec<&'a Path>,
    /// What it writes.
    pub outputs: Vec<&'a Path>,
}

/// Why a job must not run.
#[derive(Debug, Clone)]
pub(super) struct Refusal {
    file: PathBuf,
    reason: String,
    remedy: &'static str,
}

impl Refusal {
    /// The same as an error.
    pub fn error(&self) -> Error {
        Error::file(&self.file, &self.reason, self.remedy)
    }
}

const REMEDY: &str = "choose another output";

/// Why each job must not run, or `None`: an output of it is an input, or another output too.
///
/// All jobs of a clash are refused, so that their order decides nothing.
pub(super) fn refusals(jobs: &[Files<'_>]) -> Vec<Option<Refusal>> {
    let inputs = inputs(jobs);
    let places: Vec<Vec<PathBuf>> =
        jobs.iter().map(|job| job.outputs.iter().map(|path| place(path)).collect()).collect();
    let mut of_place: HashMap<&Path, Vec<&Files>> = HashMap::new();
    for (job, places) in jobs.iter().zip(&places) {
        places.iter().for_each(|place| of_place.entry(place).or_default().push(job));
    }
    let refused = |file: &Path, reason, remedy| Some(Refusal { file: file.into(), reason, remedy });
    let refusal = |job: &Files, output: &Path, place: &PathBuf| {
        let name = job.inputs[0].display();
        if let Some(input) = Identity::at(place).and_then(|output| inputs.get(&output)) {
            return refused(input, format!("the output of {name} would overwrite this input"), REMEDY);
        }
        let there = &of_place[place.as_path()];
        if let Some(other) = there.iter().find(|other| !std::ptr::eq(**other, job)) {
            let reason = format!("both {name} and {} would be baked into it", other.inputs[0].display());
            return refused(output, reason, "bake them into different folders, or change --name");
        }
        match there.len() {
            1 => None,
            _ => refused(output, format!("it would take two maps of {name}"), REMEDY),
        }
    };
    let first = |(job, places): (&Files, &Vec<PathBuf>)| {
        job.outputs.iter().zip(places).find_map(|(output, place)| refusal(job, output, place))
    };
    jobs.iter().zip(&places).map(first).collect()
}

/// Fails if a file about `jobs`, `what` in words, would overwrite an input, an output or the settings.
pub(super) fn check_report(what: &str, path: &Path, jobs: &[Files<'_>], settings: Option<&Path>) -> Result<()> {
    let refused = |kind: &str, file: &Path| {
        let reason = format!("the {what} would overwrite the {kind} {}", file.display());
        Err(Error::file(path, reason, format!("choose another name for the {what}")))
    };
    let place_of_report = place(path);
    if let Some(input) = Identity::at(&place_of_report).and_then(|report| inputs(jobs).remove(&report)) {
        return refused("input", input);
    }
    if let Some(settings) = settings.filter(|settings| place(settings) == place_of_report) {
        return refused("settings file", settings);
    }
    match jobs.iter().flat_map(|job| &job.outputs).find(|output| place(output) == place_of_report) {
        Some(output) => refused("output", output),
        None => Ok(()),
    }
}

fn inputs<'a>(jobs: &[Files<'a>]) -> HashMap<Identity, &'a Path> {
    jobs.iter().flat_map(|job| &job.inputs).filter_map(|input| Some((Identity::at(input)?, *input))).collect()
}
