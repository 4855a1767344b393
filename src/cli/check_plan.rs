//! `texbake bake --check-plan`: what was baked beside what was predicted.

use super::bake::relative;
use super::config::Config;
use super::exit::{Exit, Failure};
use super::print::{put, say};
use std::path::PathBuf;
use texbake::Maps;
use texbake::batch::{Found, Job};
use texbake::plan::{Checked, Prediction};

/// The predictions of a settings file, each with what is there of it.
pub struct PlanCheck {
    files: Vec<Planned>,
    /// Height maps that are baked without a prediction.
    unplanned: Vec<PathBuf>,
}

/// A prediction.
struct Planned {
    prediction: Prediction,
    /// The height map, and its maps as the settings have them.
    there: Option<(PathBuf, Maps<PathBuf>)>,
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
        let file_of = |map: &Found| relative(map).to_string_lossy().replace('\\', "/");
        let maps_of = |map: &Found| {
            let job = jobs.iter().find(|job| job.input == map.path);
            job.map_or(Maps { normal: None, parallax: None }, |job| job.outputs.clone())
        };
        let files = predictions.iter().map(|prediction| {
            let map = found.iter().find(|map| file_of(map) == prediction.file);
            Planned { prediction: prediction.clone(), there: map.map(|map| (map.path.clone(), maps_of(map))) }
        });
        let is_planned = |job: &&Job| {
            let map = found.iter().find(|map| map.path == job.input);
            map.is_some_and(|map| predictions.iter().any(|prediction| prediction.file == file_of(map)))
        };
        let unplanned = jobs.iter().filter(|job| !is_planned(job)).map(|job| job.input.clone()).collect();
        Ok(Self { files: files.collect(), unplanned })
    }

    /// Measures, and says what is broken.
    pub fn run(&self, is_quiet: bool) -> Result<Exit, Failure> {
        let mut broken = 0;
        let mut fail = |line: String| {
            broken += 1;
            say(format_args!("error: plan broken: {line}"));
        };
        for Planned { prediction, there } in &self.files {
            let Some((input, maps)) = there else {
                fail(format!("{}: the plan has this height map, and it was not found", prediction.file));
                continue;
            };
            let checked = prediction.check(input, maps).map_err(|error| Failure::Failed(error.to_string()))?;
            let Checked { measured, broken } = checked;
            broken.into_iter().for_each(&mut fail);
            if !is_quiet {
                measured.iter().for_each(put);
            }
        }
        for input in &self.unplanned {
            fail(format!("{}: it is baked, and the plan does not have it", input.display()));
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
