//! Files baked side by side.

use super::fresh::Written;
use super::heights::HeightWatch;
use super::neighbours::Neighbours;
use super::normals::NormalInput;
use super::outcome::Outcome;
use super::role::{Role, check_same_size};
use super::targets::{self, Files, Refusal};
use crate::baker::{Baked, Baker};
use crate::error::{Error, Result};
use crate::exact::Scale;
use crate::io::{Cropped, ReadOptions, SeamWarnings, WriteOptions, create_codes};
use crate::map::{Edge, Edges, Maps, Size, TexelFormat};
use crate::ops::bake::BakeOptions;
use crate::stream::{HeightRows, MapOut, Monitor, RowsOut};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, OnceLock, PoisonError};

/// One height map to bake.
#[derive(Clone)]
pub struct Job {
    /// The height map file.
    pub input: PathBuf,
    /// The files of its maps, those that `options` ask for; their folders are created.
    pub outputs: Maps<PathBuf>,
    /// A normal map from which a parallax map, baked alone, takes its normals; `None`: those of the heights.
    pub normals: Option<NormalInput>,
    /// The tiles around the input, if it is one of a larger map; `None`: the edges are those of the map itself.
    pub neighbours: Option<Neighbours>,
    /// How the input is read, and by which factor it is reduced.
    pub read: ReadOptions,
    /// What is baked. A scale in texels is one of texels of the file, whatever it is reduced by. Filter and edges do not matter to a parallax map with a given normal map.
    pub options: BakeOptions,
    /// How the outputs are written.
    pub write: WriteOptions,
    /// Where it runs.
    pub baker: Arc<Baker>,
}

/// What happens while jobs run.
#[derive(Debug)]
pub enum Event<'a> {
    /// A job's input was opened.
    Opened {
        /// Its place in the list of jobs.
        job: usize,
        /// Size of its map.
        size: Size,
    },
    /// A job has ended, or was refused; not sent for jobs that an interrupt kept from their turn.
    Ended {
        /// Its place in the list of jobs.
        job: usize,
        /// How.
        outcome: &'a Outcome,
    },
}

/// Runs `jobs`, `at_once` of them at a time, in their order; one that fails does not stop the others.
///
/// A job with an output that would overwrite an input fails unopened, and so do all jobs that share one output.
///
/// Each is a stream of its own: its file is read, baked and written at the same time. `watch` is called from many
/// threads. The outcomes come back in the order of the jobs.
pub fn run(jobs: &[Job], at_once: usize, monitor: &Monitor, watch: &(dyn Fn(Event<'_>) + Sync)) -> Vec<Outcome> {
    let refusals = targets::refusals(&Job::all_files(jobs)).into_iter();
    let queue = jobs.iter().zip(refusals).map(|(job, refusal)| Queued { refusal, ..Queued::new(job) });
    run_queue(&queue.collect::<Vec<_>>(), at_once, monitor, watch)
}

/// A job that waits for its turn.
pub(super) struct Queued<'a> {
    pub job: &'a Job,
    /// Why it must not run.
    pub refusal: Option<Refusal>,
    /// What it wrote, if somebody wants to know.
    pub written: Option<Written>,
    /// Whether its input was there when the run began.
    pub was_there: bool,
}

impl<'a> Queued<'a> {
    pub fn new(job: &'a Job) -> Self {
        Self { job, refusal: None, written: None, was_there: job.input.exists() }
    }

    fn run(&self, monitor: &Monitor, opened: &dyn Fn(Size)) -> Outcome {
        let outcome = self.job.run(self.written.as_ref(), monitor, opened);
        if self.was_there { say_if_it_went(&self.job.input, outcome) } else { outcome }
    }
}

/// Runs jobs as [`run`] does, whose places are those in the queue.
pub(super) fn run_queue(
    queue: &[Queued<'_>],
    at_once: usize,
    monitor: &Monitor,
    watch: &(dyn Fn(Event<'_>) + Sync),
) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let refused = |refusal: &Refusal| OnceLock::from(Outcome::unopened(refusal.error()));
    let outcomes: Vec<OnceLock<Outcome>> =
        queue.iter().map(|queued| queued.refusal.as_ref().map_or_else(OnceLock::new, refused)).collect();
    let work = || {
        while !monitor.is_cancelled() {
            let index = next.fetch_add(1, Relaxed);
            let Some(queued) = queue.get(index) else { break };
            let run = || queued.run(monitor, &|size| watch(Event::Opened { job: index, size }));
            watch(Event::Ended { job: index, outcome: outcomes[index].get_or_init(run) });
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..at_once.min(queue.len()) {
            scope.spawn(work);
        }
        work();
    });
    outcomes
        .into_iter()
        .map(|outcome| outcome.into_inner().unwrap_or_else(|| Outcome::unopened(Error::Cancelled)))
        .collect()
}

/// Of an input that was there when the run began the path is written rightly.
fn say_if_it_went(input: &Path, outcome: Outcome) -> Outcome {
    let is_missing = matches!(
        &outcome.result,
        Err(Error::Io { path, source }) if path == input && source.kind() == ErrorKind::NotFound
    );
    if !is_missing {
        return outcome;
    }
    let went = Error::file(input, "it went after it was found", "put it back, or run again without it");
    Outcome { result: Err(went), ..outcome }
}

impl Job {
    /// What it reads and writes.
    pub fn files(&self) -> Files<'_> {
        let normals = self.normals.iter().map(|normals| normals.path.as_path());
        let neighbours = self.neighbours.iter().flat_map(Neighbours::files);
        let inputs = [self.input.as_path()].into_iter().chain(normals).chain(neighbours).collect();
        Files { inputs, outputs: self.outputs.iter().map(PathBuf::as_path).collect() }
    }

    /// What each of `jobs` reads and writes.
    pub fn all_files(jobs: &[Self]) -> Vec<Files<'_>> {
        jobs.iter().map(Self::files).collect()
    }

    /// Fails as the bake would if there is no input.
    pub(super) fn check_input(&self) -> Result<()> {
        std::fs::metadata(&self.input).map(drop).map_err(Error::io(&self.input))
    }

    /// Why it failed, with the name of the file; `None` if it did not.
    pub fn failure(&self, outcome: &Outcome) -> Option<String> {
        outcome.failure(self.input.display())
    }

    /// `written` is told what becomes of the outputs.
    fn run(&self, written: Option<&Written>, monitor: &Monitor, opened: &dyn Fn(Size)) -> Outcome {
        let create = |size| self.create(size, written);
        Outcome::of(&self.files(), |warnings| match &self.normals {
            None => self.bake(&create, monitor, opened, warnings),
            Some(normals) => self.bake_with(normals, &create, monitor, opened, warnings),
        })
    }

    fn bake(
        &self,
        create: Create<'_>,
        monitor: &Monitor,
        opened: &dyn Fn(Size),
        warnings: &mut Vec<String>,
    ) -> Result<Baked> {
        let heights = HeightWatch::new(&self.input, &self.read);
        let open = || {
            let rows = heights.open(self.options.parallax.is_some())?;
            opened(rows.size());
            Ok(rows)
        };
        let options = BakeOptions { scale: self.scale()?, ..self.options };
        let baked = match &self.neighbours {
            None => self.baker.bake_rows(&open, create, &options, monitor),
            Some(neighbours) => self.bake_tile(neighbours, &open, create, &options, monitor, warnings),
        };
        warnings.extend(heights.warnings(baked.is_ok()));
        warnings.extend(baked.as_ref().ok().and_then(inexact_scale));
        baked
    }

    /// Bakes a tile with its halo, and writes the tile.
    fn bake_tile(
        &self,
        neighbours: &Neighbours,
        open: &dyn Fn() -> Result<HeightRows>,
        create: Create<'_>,
        options: &BakeOptions,
        monitor: &Monitor,
        warnings: &mut Vec<String>,
    ) -> Result<Baked> {
        neighbours.check(&self.read, options, &self.write)?;
        let size = {
            // As every file is opened: what its header takes is held by one that waits for memory.
            let _turn = monitor.turn();
            open()?.size()
        };
        let whole = Size::new(size.width() + 2, size.height() + 2)?;
        let options =
            BakeOptions { scale: options.scale.over(size, whole)?, edges: Edges::both(Edge::Clamp), ..*options };
        let told = SeamWarnings::default();
        let open = || Ok(Box::new(neighbours.around(&self.input, open()?, &self.read, monitor, &told)?) as HeightRows);
        let cropped = |(map, format): (MapOut, _)| (Box::new(Cropped::new(map.rows, size, format)) as RowsOut).into();
        let create_cropped = |_| {
            let Maps { normal, parallax, .. } = create(size)?;
            let normal = normal.zip(options.normal.map(|format| format.texel())).map(cropped);
            let parallax = parallax.zip(options.parallax.map(|format| format.texel())).map(cropped);
            Ok(Maps { normal, parallax, roughness: None })
        };
        let baked = self.baker.bake_rows(&open, &create_cropped, &options, monitor)?;
        warnings.append(&mut told.lock().unwrap_or_else(PoisonError::into_inner));
        Ok(Baked { size, ..baked })
    }

    fn bake_with(
        &self,
        normals: &NormalInput,
        create: Create<'_>,
        monitor: &Monitor,
        opened: &dyn Fn(Size),
        warnings: &mut Vec<String>,
    ) -> Result<Baked> {
        let (Maps { normal: None, parallax: Some(_), roughness: None }, Some(format), None) =
            (&self.outputs, self.options.parallax, self.options.normal)
        else {
            return Err(Error::parameter("maps", "other maps", "parallax alone, where a normal map is given"));
        };
        if self.neighbours.is_some() {
            return Err(Error::parameter("neighbours", "given", "left out, where a normal map is given"));
        }
        if self.write.mips {
            return Err(Error::parameter("mips", "on", "left out where a normal map is given: levels are of slopes"));
        }
        let given = &normals.path;
        let (heights, normals) = (HeightWatch::new(&self.input, &self.read), normals.watch(Role::GivenNormals));
        let open = || {
            let (rows, normals) = (heights.open(true)?, normals.open()?);
            let remedy = "give the normal map of these heights";
            check_same_size((&self.input, rows.size()), (given, normals.size()), remedy)?;
            opened(rows.size());
            Ok((rows, normals))
        };
        let create = |size| {
            // A scale out of range is told before there is a file.
            self.scale()?.resolve(size)?;
            let Maps { parallax, .. } = create(size)?;
            parallax.map(|map| map.rows).ok_or_else(|| Error::parameter("maps", "none", "parallax"))
        };
        let ran = self.baker.parallax_with_normals_rows(&open, &create, format, self.options.precision, monitor);
        warnings.extend(heights.warnings(ran.is_ok()));
        warnings.extend(normals.warnings(ran.is_ok()).into_iter().map(|text| format!("the normal map {text}")));
        let (ran, size) = ran?;
        let scale = self.scale()?.resolve(size)?;
        let baked = Baked { ran, size, height_type: heights.height_type(), scale };
        warnings.extend(inexact_scale(&baked));
        Ok(baked)
    }

    /// The scale over the map as it is read.
    fn scale(&self) -> Result<Scale> {
        self.options.scale.shrunk(self.read.shrink)
    }

    /// A sink for each output, of whose file `written` is told.
    fn create(&self, size: Size, written: Option<&Written>) -> Result<Maps<MapOut>> {
        self.outputs.iter().try_for_each(|path| create_folder_of(path))?;
        let create = |path: &Option<PathBuf>, format: Option<TexelFormat>| {
            let Some((path, format)) = path.as_ref().zip(format) else { return Ok(None) };
            let witness = written.map(|written| written.witness(path));
            create_codes(path, size, format, &self.write, witness).map(Some)
        };
        let BakeOptions { normal, parallax, roughness, .. } = &self.options;
        Ok(Maps {
            normal: create(&self.outputs.normal, normal.map(|format| format.texel()))?,
            parallax: create(&self.outputs.parallax, parallax.map(|format| format.texel()))?,
            roughness: create(&self.outputs.roughness, roughness.map(|options| options.format.texel()))?,
        })
    }
}

/// Makes the sinks of a job's outputs.
type Create<'a> = &'a dyn Fn(Size) -> Result<Maps<MapOut>>;

/// Makes the folders above a file.
pub(super) fn create_folder_of(file: &Path) -> Result<()> {
    let folder = file.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder).map_err(Error::io(folder))
}

/// Says so if the scale had to be rounded.
fn inexact_scale(baked: &Baked) -> Option<String> {
    let scale = baked.scale;
    (!scale.exact).then(|| format!("the scale has too many digits: {scale}, the nearest one that fits, was used"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::NormalReadOptions;

    #[test]
    fn a_given_normal_map_is_for_a_parallax_map_alone() {
        let given = NormalInput { path: "given.png".into(), read: NormalReadOptions::default() };
        let job = Job {
            input: "h.png".into(),
            outputs: Maps { normal: Some("n.png".into()), parallax: None, roughness: None },
            normals: Some(given),
            neighbours: None,
            read: ReadOptions::default(),
            options: BakeOptions::default(),
            write: WriteOptions::default(),
            baker: Arc::new(Baker::reference()),
        };
        let failure = job.failure(&job.run(None, &Monitor::default(), &|_| ())).unwrap();
        assert_eq!(failure, "h.png: maps is other maps: it must be parallax alone, where a normal map is given");
    }
}
