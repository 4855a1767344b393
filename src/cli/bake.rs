//! `texbake bake`: folders.

use super::args::{BakeArguments, CheckPlan, PerFile};
use super::check_plan::PlanCheck;
use super::config::Config;
use super::exit::{Exit, Failure};
use super::print::{file_table, plan_table, put, say, summary};
use super::progress::{Progress, Verbosity};
use super::settings::{CodeChoice, Place, open_baker};
use super::stopped_by_interrupts;
use super::values::MapChoice;
use super::watch::watch;
use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use texbake::batch::{Found, FreshPlan, Job, JsonFile, MapKind, Neighbours, Report, Search, TileFolders};
use texbake::io::{ReadOptions, WriteOptions, check_roughness};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, Error, Maps, ParallaxFormat};

/// Bakes folders, once or until interrupted.
pub fn bake(arguments: &BakeArguments) -> Result<Exit, Failure> {
    arguments.resources.start_threads()?;
    let session = Session { arguments, bakers: RefCell::default(), monitor: OnceCell::new() };
    if arguments.watch { watch(&session) } else { session.round(true).map(|round| round.exit) }
}

/// What stays from one round of a watch to the next.
pub struct Session<'a> {
    pub arguments: &'a BakeArguments,
    bakers: RefCell<HashMap<Place, Arc<Baker>>>,
    monitor: OnceCell<Arc<Monitor>>,
}

/// What a bake of folders came to.
pub struct Round {
    pub exit: Exit,
    /// What was read and written.
    pub jobs: Vec<Job>,
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
        let (arguments, reporting) = (self.arguments, &self.arguments.reporting);
        let config = Config::find(arguments.config.as_deref(), &arguments.paths).map_err(Failure::settings)?;
        let search = search(arguments, config.as_ref())?;
        let (found, errors) = search.find(&arguments.paths);
        errors.iter().for_each(|error| say(format_args!("error: {error}")));
        if found.is_empty() && errors.is_empty() {
            return Err(nothing_found(&arguments.paths, &search));
        }
        if let Some(config) = config.as_ref().filter(|_| is_first && !reporting.quiet) {
            describe(config, &found);
        }
        let (jobs, left_out) = self.jobs(config.as_ref(), &found)?;
        let check = arguments.check_plan.map(|_| PlanCheck::new(config.as_ref(), &found, &jobs)).transpose()?;
        let monitor = self.monitor()?;
        if let (Some(check), Some(CheckPlan::Only)) = (&check, arguments.check_plan) {
            let exit = check.run(reporting.quiet, monitor)?;
            return Ok(Round { exit, jobs, summary: None });
        }
        let settings = config.as_ref().map(|config| config.path.as_path());
        let files = Job::all_files(&jobs);
        let report_file = reporting.report.as_deref().map(|path| JsonFile::create("report", path, &files, settings));
        let report_file = report_file.transpose()?;

        let start = Instant::now();
        let plan = FreshPlan::new(&jobs, &arguments.out, arguments.force && is_first, monitor);
        let outcomes = match arguments.dry_run {
            true => plan.dry_run(),
            false => {
                let at_once = arguments.jobs.map_or_else(usual_jobs, NonZeroUsize::get);
                let inputs: Vec<&Path> = jobs.iter().map(|job| job.input.as_path()).collect();
                let progress = Progress::new(&inputs, monitor, Verbosity::of(reporting, Verbosity::Files));
                progress.during(|| plan.run(at_once, monitor, &|event| progress.watch(&jobs, event)))
            }
        };
        let time = start.elapsed();
        if !reporting.quiet {
            plan.warnings().iter().for_each(|text| say(format_args!("warning: {text}")));
        }
        let report = Report {
            left_out: left_out.iter().map(|map| map.path.display().to_string()).collect(),
            ..Report::new(&jobs, &outcomes, time, &errors, settings, arguments.iterations)
        };
        let summary = summary(&report, &jobs, &outcomes);
        let is_told = arguments.dry_run && !monitor.is_cancelled();
        if !reporting.quiet && is_first {
            match is_told {
                true => put(plan_table(&jobs, &plan.files().collect::<Vec<_>>())),
                false => put(format_args!("{}\n{summary}", file_table(&jobs, &outcomes, &report.left_out))),
            }
        }
        if let Some(file) = report_file {
            file.write(&report)?;
        }
        let exit = match (report.totals, &check) {
            (totals, _) if is_told => {
                if totals.failed > 0 {
                    Exit::Failed
                } else {
                    exit_of_search(&errors)
                }
            }
            (totals, _) if totals.stopped + totals.not_begun > 0 => Exit::Interrupted,
            (totals, _) if totals.failed > 0 => Exit::Failed,
            (_, Some(check)) => match check.run(reporting.quiet, monitor)? {
                Exit::Success => exit_of_search(&errors),
                checked => checked,
            },
            _ => exit_of_search(&errors),
        };
        let is_idle = report.totals.fresh == report.totals.files;
        Ok(Round { exit, jobs, summary: (!is_idle).then_some(summary) })
    }
}

/// A folder that could not be searched is a failure, whatever became of the others.
fn exit_of_search(errors: &[Error]) -> Exit {
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

/// An error of the settings file `config`, or else of the command line.
fn blame(error: Error, config: Option<&Config>) -> Failure {
    match (error, config) {
        (error @ Error::Parameter { .. }, Some(config)) => {
            Failure::Usage(format!("{}: {error}", config.path.display()))
        }
        (error, _) => error.into(),
    }
}

/// What the settings of one file say.
struct Chosen {
    outputs: Maps<PathBuf>,
    place: Place,
    neighbours: Option<Neighbours>,
    options: BakeOptions,
    read: ReadOptions,
    write: WriteOptions,
}

impl Chosen {
    /// `None` if the file gets no map.
    fn new(each: &PerFile, map: &Found, out: &Path, folders: &mut TileFolders) -> texbake::Result<Option<Self>> {
        let settings = &each.settings;
        let maps = MapChoice::kinds(each.maps.as_deref().unwrap_or(&[MapChoice::Map(MapKind::Normal)]))?;
        if maps.is_empty() {
            return Ok(None);
        }
        let (name, format) = (each.name.clone().unwrap_or_default(), each.format.as_deref().unwrap_or("png"));
        let outputs = name.outputs(map, &maps, out, format)?;
        let place = settings.device.place()?;
        let write = settings.mips.write(settings.file.write());
        let normal = outputs.normal.as_ref().map(|path| settings.normal.format(path, &write)).transpose()?;
        let parallax = outputs.parallax.as_ref().map(|path| parallax(each.parallax(), path, &write)).transpose()?;
        let roughness = outputs.roughness.as_ref().map(|path| {
            let options = settings.roughness.options();
            check_roughness(path, options.format, &write).map(|()| options)
        });
        let options = settings.slope.bake(normal, parallax, roughness.transpose()?)?;
        let neighbours = settings.tiles.around_in(folders, &map.path, &options)?;
        Ok(Some(Self { outputs, place, neighbours, options, read: settings.input.read(), write }))
    }
}

/// The format of a parallax map; here its options have longer names.
fn parallax(codes: CodeChoice, output: &Path, write: &WriteOptions) -> texbake::Result<ParallaxFormat> {
    codes.parallax(output, write).map_err(|error| match error {
        Error::Parameter { parameter: "bits", value, range } => {
            Error::Parameter { parameter: "parallax-bits", value, range }
        }
        Error::Parameter { parameter: "encoding", value, range } => {
            Error::Parameter { parameter: "parallax-encoding", value, range }
        }
        error => error,
    })
}

impl Session<'_> {
    /// One job for each file, with its own settings, and the files that get no map; files that run at the same place share
    /// a baker.
    fn jobs<'f>(&self, config: Option<&Config>, found: &'f [Found]) -> Result<(Vec<Job>, Vec<&'f Found>), Failure> {
        let (arguments, mut bakers) = (self.arguments, self.bakers.borrow_mut());
        let mut folders = TileFolders::default();
        let (mut jobs, mut left_out) = (Vec::new(), Vec::new());
        for map in found {
            let below = config.map_or_else(PerFile::default, |config| config.settings(&map.relative()));
            let mut choose = |settings| Chosen::new(settings, map, &arguments.out, &mut folders);
            let chosen = choose(&arguments.each.clone().or(&below)).map_err(|error| {
                // Where the command line alone would do, the mistake is in the file.
                blame(error, config.filter(|_| choose(&arguments.each).is_ok()))
            })?;
            let Some(Chosen { outputs, place, neighbours, options, read, write }) = chosen else {
                left_out.push(map);
                continue;
            };
            let baker = match bakers.get(&place) {
                Some(baker) => Arc::clone(baker),
                None => {
                    let baker = Arc::new(open_baker(&place)?);
                    bakers.insert(place, baker.clone());
                    baker
                }
            };
            let input = map.path.clone();
            jobs.push(Job { input, outputs, normals: None, neighbours, read, options, write, baker });
        }
        let asks_for_parallax = arguments.each.parallax() != CodeChoice::default();
        if asks_for_parallax && jobs.iter().all(|job| job.outputs.parallax.is_none()) {
            let reason = "--parallax-encoding and --parallax-bits are for parallax maps: ask for them with --maps";
            return Err(Failure::Usage(reason.into()));
        }
        Ok((jobs, left_out))
    }
}

/// Says which settings file is used, and which of its overrides are not.
fn describe(config: &Config, found: &[Found]) {
    say(format_args!("settings from {}", config.path.display()));
    let paths: Vec<PathBuf> = found.iter().map(Found::relative).collect();
    for glob in config.unused(&paths) {
        say(format_args!("warning: {}: no height map matches the override {glob:?}", config.path.display()));
    }
}

fn nothing_found(paths: &[PathBuf], search: &Search) -> Failure {
    let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    let (paths, suffixes) = (paths.join(", "), search.suffixes().join(", "));
    Failure::Failed(format!(
        "{paths}: no height map found; their names end in {suffixes} (or that and _2k or the like), and in .png, .tif, \
         .exr or another image format; change that with --suffix, or name the files"
    ))
}
