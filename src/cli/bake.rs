//! `texbake bake`: folders.

use super::args::{BakeArguments, CheckPlan};
use super::check_plan::PlanCheck;
use super::config::Config;
use super::exit::{Exit, Failure};
use super::jobs::{Jobs, Refused, blame, missing_tiles, settings_in};
use super::print::{file_table, plan_table, put, say, summary};
use super::progress::{Progress, Verbosity};
use super::settings::Place;
use super::stopped_by_interrupts;
use super::watch::watch;
use std::cell::{OnceCell, RefCell};
use std::collections::{HashMap, HashSet};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use texbake::batch::{Found, FreshPlan, Job, JsonFile, Report, Search, TileTemplate};
use texbake::stream::Monitor;
use texbake::{Baker, Error};

/// Bakes folders, once or until interrupted.
pub fn bake(arguments: &BakeArguments) -> Result<Exit, Failure> {
    arguments.resources.start_threads()?;
    let session = Session { arguments, bakers: RefCell::default(), monitor: OnceCell::new() };
    if arguments.watch { watch(&session) } else { session.round(true).map(|round| round.exit) }
}

/// What stays from one round of a watch to the next.
pub struct Session<'a> {
    pub arguments: &'a BakeArguments,
    pub bakers: RefCell<HashMap<Place, Arc<Baker>>>,
    monitor: OnceCell<Arc<Monitor>>,
}

/// What a bake of folders came to.
pub struct Round {
    pub exit: Exit,
    /// What was read and written.
    pub jobs: Vec<Job>,
    /// What tiles are called, by the settings file.
    pub templates: Vec<TileTemplate>,
    /// One line about it, if a file was worked on.
    pub summary: Option<String>,
}

impl Session<'_> {
    /// What bounds the memory of all rounds, and what an interrupt cancels; before it is first asked for, an interrupt
    /// ends the program.
    ///
    /// # Errors
    /// As [`Resources::monitor`](super::resources::Resources::monitor).
    pub fn monitor(&self) -> Result<&Monitor, Failure> {
        if let Some(monitor) = self.monitor.get() {
            return Ok(monitor);
        }
        let monitor = self.arguments.resources.monitor()?;
        Ok(self.monitor.get_or_init(|| stopped_by_interrupts(monitor)))
    }

    /// Bakes what is stale. The first of several rounds is forced, if that was asked for, and told in full.
    pub fn round(&self, is_first: bool) -> Result<Round, Failure> {
        let work = Work::new(self, is_first).inspect_err(|failure| self.report(failure))?;
        match (&work.check, self.arguments.check_plan) {
            (Some(check), Some(CheckPlan::Only)) => {
                let exit = check.run(self.arguments.reporting.quiet, self.monitor()?)?;
                Ok(Round { exit, templates: work.templates(), jobs: work.jobs, summary: None })
            }
            _ => {
                let report = work.report_file(self)?;
                work.bake(self, report, is_first)
            }
        }
    }

    /// Reports why nothing is baked; what cannot be reported so is left as it is.
    fn report(&self, failure: &Failure) {
        let Some(path) = &self.arguments.reporting.report else { return };
        let report = Report { errors: vec![failure.to_string()], ..Report::default() };
        let _ = JsonFile::replace_report(path, &report);
    }
}

/// What there is to do, and what is known of it before any file is opened.
struct Work {
    config: Option<Config>,
    jobs: Vec<Job>,
    /// Height maps that get no map.
    left_out: Vec<PathBuf>,
    /// Those that cannot be baked as their settings say.
    refused: Vec<Refused>,
    /// What could not be searched.
    errors: Vec<String>,
    /// What looks wrong with more than one height map.
    warnings: Vec<String>,
    check: Option<PlanCheck>,
}

impl Work {
    fn new(session: &Session<'_>, is_first: bool) -> Result<Self, Failure> {
        let (arguments, reporting) = (session.arguments, &session.arguments.reporting);
        let config = Config::find(arguments.config.as_deref(), &arguments.paths).map_err(Failure::settings)?;
        let search = search(arguments, config.as_ref())?;
        let given = &arguments.each.settings.tiles.neighbours;
        let in_settings = |path: &Path| settings_in(config.as_ref(), path).settings.tiles.neighbours;
        let template_of = |path: &Path| given.clone().or_else(|| in_settings(path));
        let (found, unreadable) = search.find_with_tiles(&arguments.paths, &template_of);
        let errors: Vec<String> = unreadable.iter().map(ToString::to_string).collect();
        if found.is_empty() && errors.is_empty() {
            return Err(nothing_found(arguments, &search));
        }
        if let Some(config) = config.as_ref().filter(|_| is_first && !reporting.quiet) {
            describe(config, &found);
        }
        let Jobs { jobs, left_out, refused } = session.jobs(config.as_ref(), &found)?;
        // What is wrong with a tile is wrong for each one beside it.
        let mut told = HashSet::new();
        let reasons = refused.iter().map(|refused| &refused.reason).filter(|reason| told.insert(*reason));
        errors.iter().chain(reasons).for_each(|error| say(format_args!("error: {error}")));
        let warnings = missing_tiles(&jobs);
        if !reporting.quiet {
            warnings.iter().for_each(|text| say(format_args!("warning: {text}")));
        }
        let check = arguments.check_plan.map(|_| PlanCheck::new(config.as_ref(), &found, &jobs)).transpose()?;
        // What bounds memory is known once devices are open.
        session.monitor()?;
        Ok(Self { jobs, left_out, refused, errors, warnings, check, config })
    }

    /// What the report goes to, if it was asked for.
    fn report_file(&self, session: &Session<'_>) -> Result<Option<JsonFile>, Error> {
        let create = |path: &PathBuf| JsonFile::create("report", path, &Job::all_files(&self.jobs), self.settings());
        session.arguments.reporting.report.as_ref().map(create).transpose()
    }

    fn templates(&self) -> Vec<TileTemplate> {
        self.config.iter().flat_map(Config::templates).cloned().collect()
    }

    /// The settings file.
    fn settings(&self) -> Option<&Path> {
        self.config.as_ref().map(|config| config.path.as_path())
    }

    fn bake(self, session: &Session<'_>, report_file: Option<JsonFile>, is_first: bool) -> Result<Round, Failure> {
        let (arguments, reporting) = (session.arguments, &session.arguments.reporting);
        let Self { jobs, refused, errors, .. } = &self;
        let monitor = session.monitor()?;
        let start = Instant::now();
        let plan = FreshPlan::new(jobs, &arguments.out, arguments.force && is_first, monitor);
        let outcomes = match arguments.dry_run {
            true => plan.dry_run(),
            false => {
                let at_once = arguments.jobs.map_or_else(usual_jobs, NonZeroUsize::get);
                let inputs: Vec<&Path> = jobs.iter().map(|job| job.input.as_path()).collect();
                let progress = Progress::new(&inputs, monitor, Verbosity::of(reporting, Verbosity::Files));
                progress.during(|| plan.run(at_once, monitor, &|event| progress.watch(jobs, event)))
            }
        };
        let time = start.elapsed();
        if !reporting.quiet {
            plan.warnings().iter().for_each(|text| say(format_args!("warning: {text}")));
        }
        let mut report = Report {
            left_out: self.left_out.iter().map(|path| path.display().to_string()).collect(),
            warnings: self.warnings.clone(),
            ..Report::new(jobs, &outcomes, time, errors, self.settings(), arguments.iterations)
        };
        refused.iter().for_each(|refused| report.add_refused(&refused.input, &refused.reason));
        let summary = summary(&report, jobs, &outcomes);
        let is_told = arguments.dry_run && !monitor.is_cancelled();
        if !reporting.quiet && is_first {
            match is_told {
                true => put(plan_table(jobs, &outcomes, refused)),
                false => put(format_args!("{}\n{summary}", file_table(jobs, &outcomes, &report.left_out, refused))),
            }
        }
        if let Some(file) = report_file {
            file.write(&report)?;
        }
        let exit = match (report.totals, &self.check) {
            (totals, _) if totals.stopped + totals.not_begun > 0 && !is_told => Exit::Interrupted,
            (totals, _) if totals.failed > 0 => Exit::Failed,
            (_, Some(check)) => match check.run(reporting.quiet, monitor)? {
                Exit::Success => exit_without(errors),
                checked => checked,
            },
            _ => exit_without(errors),
        };
        let is_idle = report.totals.fresh == report.totals.files;
        Ok(Round { exit, templates: self.templates(), jobs: self.jobs, summary: (!is_idle).then_some(summary) })
    }
}

/// What was not even begun is a failure, whatever became of the rest.
fn exit_without(errors: &[String]) -> Exit {
    if errors.is_empty() { Exit::Success } else { Exit::Failed }
}

/// One more than the threads: while the disk takes one file (its bytes are there before it has its name), another is
/// baked. More jobs were no faster, and each holds its own rows.
fn usual_jobs() -> usize {
    1 + rayon::current_num_threads()
}

/// The suffixes of the command line, else of the settings, else the usual ones.
fn search(arguments: &BakeArguments, config: Option<&Config>) -> Result<Search, Failure> {
    let given = Some(arguments.suffix.clone()).filter(|suffixes| !suffixes.is_empty());
    let suffixes = given.or_else(|| config.and_then(|config| config.suffixes.clone()));
    let search = suffixes.map_or_else(|| Ok(Search::default()), Search::new);
    search.map_err(|error| blame(error, config.filter(|_| arguments.suffix.is_empty())))
}

/// Says which settings file is used, and which of its overrides are not.
fn describe(config: &Config, found: &[Found]) {
    say(format_args!("settings from {}", config.path.display()));
    let paths: Vec<PathBuf> = found.iter().map(Found::relative).collect();
    for glob in config.unused(&paths) {
        say(format_args!("warning: {}: no height map matches the override {glob:?}", config.path.display()));
    }
}

fn nothing_found(arguments: &BakeArguments, search: &Search) -> Failure {
    let paths: Vec<String> = arguments.paths.iter().map(|path| path.display().to_string()).collect();
    let (paths, suffixes) = (paths.join(", "), search.suffixes().join(", "));
    let template = arguments.each.settings.tiles.neighbours.as_ref();
    let tiles = template.map(|template| format!("are {template} with numbers for {{x}} and {{y}}, or "));
    Failure::Failed(format!(
        "{paths}: no height map found; their names {}end in {suffixes} (or that and _2k or the like), and in .png, \
         .tif, .exr or another image format; change that with --suffix, or name the files; tiles are found by \
         --neighbours",
        tiles.unwrap_or_default()
    ))
}
