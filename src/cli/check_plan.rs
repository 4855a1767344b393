//! `texbake bake --check-plan`: what was baked beside what was predicted.

use super::config::Config;
use super::exit::{Exit, Failure};
use super::print::{put, say};
use std::path::PathBuf;
use texbake::batch::{Found, Job};
use texbake::plan::{Checked, Prediction};
use texbake::stream::Monitor;
use texbake::{Error, Maps};

/// The predictions of a settings file, each with what is there of it.
pub struct PlanCheck {
    files: Vec<Planned>,
    /// Height maps that are baked without a prediction.
    unplanned: Vec<PathBuf>,
    /// Height maps that are not baked, and have no prediction.
    unknown: Vec<PathBuf>,
}

/// A prediction.
struct Planned {
    prediction: Prediction,
    there: Option<There>,
}

/// A height map that was predicted.
struct There {
    input: PathBuf,
    /// Its maps as the settings have them.
    outputs: Maps<PathBuf>,
    /// What the settings bake otherwise than predicted.
    other: Vec<String>,
}

impl PlanCheck {
    /// Fails if there is nothing to check.
    pub fn new(config: Option<&Config>, found: &[Found], jobs: &[Job]) -> Result<Self, Failure> {
        let predictions = config.map_or(&[][..], |config| &config.predictions);
        if predictions.is_empty() {
            let reason = match config {
                Some(config) => format!("{} has no predictions", config.path.display()),
                None => "there is no settings file".to_owned(),
            };
            return Err(Failure::Usage(format!(
                "--check-plan: {reason}; give one that texbake plan wrote, with --config"
            )));
        }
        let job_of = |map: &Found| jobs.iter().find(|job| job.input == map.path);
        let files = predictions.iter().map(|prediction| {
            let map = found.iter().find(|map| prediction.is_of(&map.relative()));
            Planned { prediction: prediction.clone(), there: map.map(|map| There::new(prediction, map, job_of(map))) }
        });
        let is_planned = |map: &&Found| predictions.iter().any(|prediction| prediction.is_of(&map.relative()));
        let others = found.iter().filter(|map| !is_planned(map));
        let (unplanned, unknown): (Vec<_>, Vec<_>) = others.partition(|map| job_of(map).is_some());
        let paths = |maps: Vec<&Found>| maps.into_iter().map(|map| map.path.clone()).collect();
        Ok(Self { files: files.collect(), unplanned: paths(unplanned), unknown: paths(unknown) })
    }

    /// Measures, and says what is broken.
    pub fn run(&self, is_quiet: bool, monitor: &Monitor) -> Result<Exit, Failure> {
        let mut broken = 0;
        let mut fail = |line: String| {
            broken += 1;
            say(format_args!("error: plan broken: {line}"));
        };
        for Planned { prediction, there } in &self.files {
            let Some(There { input, outputs, other }) = there else {
                fail(format!("{}: the plan has this height map, and it was not found", prediction.file));
                continue;
            };
            other.iter().for_each(|line| fail(format!("{}: {line}", prediction.file)));
            let checked = match prediction.check(input, outputs, monitor) {
                Err(Error::Cancelled) => {
                    say("interrupted: the plan was not checked");
                    return Ok(Exit::Interrupted);
                }
                checked => checked.map_err(|error| Failure::Failed(error.to_string()))?,
            };
            let Checked { measured, broken } = checked;
            broken.into_iter().for_each(&mut fail);
            if !is_quiet {
                measured.iter().for_each(put);
            }
        }
        for input in &self.unplanned {
            fail(format!("{}: it is baked, and the plan does not have it", input.display()));
        }
        for input in self.unknown.iter().filter(|_| !is_quiet) {
            say(format_args!("warning: {}: the plan does not have it, and it gets no map", input.display()));
        }
        if !is_quiet {
            put(match (broken, self.files.len()) {
                (0, 1) => "the plan holds: 1 height map".to_owned(),
                (0, files) => format!("the plan holds: {files} height maps"),
                (1, _) => "the plan is broken: 1 prediction".to_owned(),
                (broken, _) => format!("the plan is broken: {broken} predictions"),
            });
        }
        Ok(if broken == 0 { Exit::Success } else { Exit::Failed })
    }
}

impl There {
    fn new(prediction: &Prediction, map: &Found, job: Option<&Job>) -> Self {
        let outputs = job.map_or(Maps::default(), |job| job.outputs.clone());
        let other = job.map_or_else(Vec::new, |job| prediction.other_settings(&job.read, &job.options));
        Self { input: map.path.clone(), outputs, other }
    }
}
