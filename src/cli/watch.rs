//! `texbake bake --watch`: bakes again what was saved.

use super::args::BakeArguments;
use super::bake::{Round, Session};
use super::config::SETTINGS_NAME;
use super::exit::{Exit, Failure};
use super::print::{put, say};
use notify::event::{AccessKind, AccessMode};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher, recommended_watcher};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};
use texbake::batch::{Job, TileTemplate, with_real_folder};
use texbake::io::INPUT_EXTENSIONS;
use texbake::stream::Monitor;

/// Bakes in rounds: at once, and whenever something changed that a bake depends on, until it is interrupted.
pub fn watch(session: &Session<'_>) -> Result<Exit, Failure> {
    let is_quiet = session.arguments.reporting.quiet;
    let mut known = Known::new(session.arguments);
    let (mut is_first, mut has_begun) = (true, false);
    loop {
        // Before the files are looked at, so that no change falls in between.
        let changes = Changes::new(session.arguments)?;
        match session.round(is_first) {
            Ok(round) => {
                if !is_first && !is_quiet {
                    round.summary.iter().for_each(put);
                }
                known.take(round);
                is_first = false;
            }
            Err(failure @ Failure::Usage(_)) if !has_begun => return Err(failure),
            // A file that is half written, settings with a mistake: the next save mends them.
            Err(failure) => say(format_args!("error: {failure}")),
        }
        if !has_begun && !is_quiet && !session.monitor()?.is_cancelled() {
            say("watching for changes; interrupt (Ctrl-C) to end");
        }
        has_begun = true;
        if !changes.wait(&known, session.monitor()?) {
            return Ok(Exit::Interrupted);
        }
    }
}

/// Word of what changes in the folders.
struct Changes {
    events: Receiver<notify::Result<Event>>,
    _watcher: RecommendedWatcher,
}

/// Programs save in several steps: a round begins once nothing changed for so long.
const QUIET: Duration = Duration::from_millis(200);

/// Where something changes all the time, a round begins nevertheless.
const LONGEST: Duration = Duration::from_secs(5);

/// Between two looks for an interrupt.
const LOOK: Duration = Duration::from_millis(50);

impl Changes {
    /// From now on, in the folders that are searched, and in those in which they, files and settings lie: folders go and
    /// come back, and files are replaced by others of their name.
    fn new(arguments: &BakeArguments) -> Result<Self, Failure> {
        let failure = |error: notify::Error| Failure::Failed(format!("changes cannot be watched: {error}"));
        let (send, events) = channel();
        // Nobody listens any more once the round is over.
        let mut watcher = recommended_watcher(move |event| _ = send.send(event)).map_err(failure)?;
        let settings = PathBuf::from(SETTINGS_NAME);
        let files = arguments.paths.iter().chain(&arguments.config).chain([&settings]);
        let around =
            files.filter_map(|path| existing_folder_above(path)).map(|path| (path, RecursiveMode::NonRecursive));
        let searched =
            arguments.paths.iter().filter(|path| path.is_dir()).map(|path| (path.as_path(), RecursiveMode::Recursive));
        for (folder, mode) in around.chain(searched) {
            // One that went meanwhile is watched from above.
            watcher.watch(folder, mode).or_else(|error| if folder.is_dir() { Err(failure(error)) } else { Ok(()) })?;
        }
        Ok(Self { events, _watcher: watcher })
    }

    /// Waits until something changed, and for a pause after that; false if `monitor` was cancelled before.
    fn wait(&self, known: &Known, monitor: &Monitor) -> bool {
        let mut changed: Option<[Instant; 2]> = None;
        while !monitor.is_cancelled() {
            if changed.is_some_and(|[first, last]| last.elapsed() >= QUIET || first.elapsed() >= LONGEST) {
                return true;
            }
            if self.events.recv_timeout(LOOK).is_ok_and(|event| known.concerns(&event)) {
                let now = Instant::now();
                changed = Some([changed.map_or(now, |[first, _]| first), now]);
            }
        }
        false
    }
}

/// The folder in which a file lies or would lie, or the next one above it that there is.
fn existing_folder_above(path: &Path) -> Option<&Path> {
    let above =
        path.ancestors().skip(1).map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
    above.into_iter().find(|folder| folder.is_dir())
}

/// The files of which word may come.
struct Known {
    settings: Option<PathBuf>,
    /// What tiles are called, by the command line.
    template: Option<TileTemplate>,
    /// And by the settings.
    templates: Vec<TileTemplate>,
    inputs: HashSet<PathBuf>,
    outputs: HashSet<PathBuf>,
}

impl Known {
    fn new(arguments: &BakeArguments) -> Self {
        let settings = arguments.config.as_deref().map(with_real_folder);
        let template = arguments.each.settings.tiles.neighbours.clone();
        Self { settings, template, templates: Vec::new(), inputs: HashSet::new(), outputs: HashSet::new() }
    }

    /// Takes the files of a round's jobs, and what others would be called.
    fn take(&mut self, round: Round) {
        let files = Job::all_files(&round.jobs);
        self.templates = round.templates;
        self.inputs = files.iter().flat_map(|files| &files.inputs).map(|path| with_real_folder(path)).collect();
        self.outputs = files.iter().flat_map(|files| &files.outputs).map(|path| with_real_folder(path)).collect();
    }

    /// Whether it may be about something that a bake reads; a round in which that turns out wrong is a short one.
    fn concerns(&self, event: &notify::Result<Event>) -> bool {
        match event {
            Ok(event) if event.need_rescan() => true,
            // Reading a file is word of it too.
            Ok(Event { kind: EventKind::Access(kind), .. }) if *kind != AccessKind::Close(AccessMode::Write) => false,
            Ok(event) => event.paths.iter().any(|path| self.is_of_interest(path)),
            Err(_) => true,
        }
    }

    fn is_of_interest(&self, path: &Path) -> bool {
        let name = path.file_name().unwrap_or_default();
        let place = with_real_folder(path);
        if name.as_encoded_bytes().starts_with(b".texbake-") || self.outputs.contains(&place) {
            return false;
        }
        let extension = path.extension();
        let is_image = extension.is_some_and(|it| INPUT_EXTENSIONS.iter().any(|known| it.eq_ignore_ascii_case(known)));
        let is_settings = name == SETTINGS_NAME || self.settings.as_ref() == Some(&place);
        // What is gone without having had an extension may have been a folder; a file without one may be a log of this.
        let is_folder = path.is_dir() || (extension.is_none() && !path.exists());
        let is_tile = self.templates.iter().chain(&self.template).any(|template| template.fits(path));
        is_image || is_tile || is_settings || is_folder || self.inputs.contains(&place)
    }
}
