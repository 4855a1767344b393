//! What was done, for other programs: JSON.

use super::fresh::Freshness;
use super::offsets::ParallaxNumbers;
use super::targets::{self, Files};
use super::{Job, MapKind, Neighbours, Outcome};
use crate::baker::{Baker, Ran};
use crate::error::{Error, Result};
use crate::io::replace::{Replacement, open_stream};
use crate::io::{ReadOptions, WriteOptions};
use crate::map::Size;
use crate::ops::bake::BakeOptions;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A run and its files. The default is a run of no file.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of texbake.
    pub version: &'static str,
    /// The settings file that was used.
    pub settings: Option<String>,
    /// Sums over the files.
    pub totals: Totals,
    /// Why folders could not be searched, or nothing be baked at all.
    pub errors: Vec<String>,
    /// What looks wrong with more than one file: tiles that are missing.
    pub warnings: Vec<String>,
    /// The files, in the order in which they were found; then those that were refused.
    pub files: Vec<FileReport>,
    /// Height maps that get no map, as the settings say.
    pub left_out: Vec<String>,
}

/// Sums over the files of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Totals {
    /// Height maps.
    pub files: usize,
    /// Those that were baked.
    pub baked: usize,
    /// Those whose outputs were fresh.
    pub fresh: usize,
    /// Those that could not be baked.
    pub failed: usize,
    /// Those that were being baked when the run was interrupted; they left no output.
    pub stopped: usize,
    /// Those that had not been begun then.
    pub not_begun: usize,
    /// Texels of the baked files.
    pub texels: u64,
    /// From the first file's opening to the last one's closing.
    pub seconds: f64,
    /// Millions of texels in a second.
    pub megatexels_per_second: f64,
    /// Bytes of the baked files' inputs.
    pub bytes_in: u64,
    /// Bytes of the outputs.
    pub bytes_out: u64,
}

/// What became of one file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FileResult {
    /// Every map is complete.
    Baked,
    /// Every map was what would have been baked.
    Fresh,
    /// There is an error, and no output.
    Failed,
    /// The run was interrupted meanwhile; there is no output.
    Stopped,
    /// The run was interrupted before.
    NotBegun,
}

/// One file of a run.
#[derive(Debug, Clone, Serialize)]
pub struct FileReport {
    /// The height map file.
    #[serde(serialize_with = "as_text")]
    pub input: PathBuf,
    /// The normal map from which the normals came, where they are not the heights' own.
    pub normals: Option<String>,
    /// The files of the maps that were asked for.
    pub outputs: Outputs,
    /// What was asked for, by the names of the command line; null if the file was refused.
    pub options: Option<Options>,
    /// Type of the heights that were baked: `u8`, `u16`, `f32`; reduced ones are `u16` or `f32`.
    pub depth: Option<String>,
    /// The scale that was used, in texels of the map as it was baked.
    pub scale: Option<UsedScale>,
    /// What a shader needs to know of the parallax map, if there is one.
    pub parallax: Option<ParallaxNumbers>,
    /// Why the outputs were not fresh; not there if they were, or nobody asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stale: Option<String>,
    /// How it went.
    #[serde(flatten)]
    pub run: RunReport,
}

/// The files of a height map's maps.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Outputs {
    /// The normal map.
    pub normal: Option<String>,
    /// The parallax map.
    pub parallax: Option<String>,
    /// The roughness map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness: Option<String>,
}

/// How the work on some files went.
#[derive(Debug, Clone, Serialize)]
pub struct RunReport {
    /// What became of it.
    pub result: FileResult,
    /// Why it failed.
    pub error: Option<String>,
    /// What looks wrong, although it was done.
    pub warnings: Vec<String>,
    /// What ran it: `cpu` or `gpu`.
    pub backend: Option<&'static str>,
    /// The device and how it was used.
    pub adapter: Option<String>,
    /// Why this backend was chosen; empty if none was.
    pub reason: String,
    /// Why another backend failed before.
    pub fallback: Option<String>,
    /// The size of its maps; not there for work on meshes.
    #[serde(flatten)]
    pub size: Option<SizeReport>,
    /// From opening the inputs to closing the outputs; null if the inputs were never opened.
    pub milliseconds: Option<f64>,
    /// Bytes of the inputs.
    pub bytes_in: u64,
    /// Bytes of the outputs.
    pub bytes_out: u64,
}

/// The size of maps; null if they were never opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SizeReport {
    /// Texels in a row.
    pub width: Option<usize>,
    /// Rows.
    pub height: Option<usize>,
}

/// The options of a file as text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Options {
    /// The scale as it was given: `7/3`, or `2 x 2 by 0.1 high`.
    pub scale: String,
    /// The slope stencil.
    pub filter: String,
    /// The edge mode, or those of x and y.
    pub edge: String,
    /// The maps that were asked for: `normal,parallax`.
    pub maps: String,
    /// How a component of the normal map becomes a code.
    pub encoding: Option<String>,
    /// How a code of the normal map is stored.
    pub bits: Option<String>,
    /// Which components the normal map has.
    pub channels: Option<String>,
    /// Which way green points.
    pub convention: Option<String>,
    /// How a value of the parallax map becomes a code.
    pub parallax_encoding: Option<String>,
    /// How a code of the parallax map is stored.
    pub parallax_bits: Option<String>,
    /// Steps towards the eye that the numbers of a parallax map are for.
    pub iterations: Option<u32>,
    /// Exact or fast.
    pub precision: String,
    /// How hard files are compressed.
    pub compression: String,
    /// Whether there are all mip levels.
    pub mips: bool,
    /// How the roughness of levels grows.
    pub roughness_method: Option<String>,
    /// Roughness of the largest level.
    pub base_roughness: Option<String>,
    /// How a code of the roughness map is stored.
    pub roughness_bits: Option<String>,
    /// The blocks of texels, if any.
    pub block_compression: Option<String>,
    /// The tiles around the input, if it is one of a larger map, by the sides at which they lie.
    pub neighbours: Option<BTreeMap<&'static str, String>>,
    /// The channel that was read.
    pub channel: Option<String>,
    /// What the height codes mean.
    pub color_space: String,
    /// The layout of a file without a header.
    pub raw: Option<String>,
    /// The factor by which the map was reduced.
    pub shrink: u32,
    /// The limit on the decoded size.
    pub max_bytes: u64,
}

/// The scale that a bake used, in texels.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UsedScale {
    /// Along the rows: an integer, a short decimal or a ratio.
    pub x: String,
    /// Down the rows.
    pub y: String,
    /// Whether it is the one that was asked for.
    pub exact: bool,
}

impl Report {
    /// What `jobs` came to in `time`, nothing left out, beside `errors`; the numbers of parallax maps are for
    /// `iterations` steps.
    pub fn new(
        jobs: &[Job],
        outcomes: &[Outcome],
        time: Duration,
        errors: &[String],
        settings: Option<&Path>,
        iterations: NonZeroU32,
    ) -> Self {
        let file = |(job, outcome): (&Job, &Outcome)| FileReport::new(job, outcome, iterations);
        Self {
            settings: settings.map(|path| path.display().to_string()),
            totals: Totals::new(outcomes, time),
            errors: errors.to_vec(),
            files: jobs.iter().zip(outcomes).map(file).collect(),
            ..Self::default()
        }
    }

    /// Adds a file that was refused: it cannot be baked as its settings say.
    pub fn add_refused(&mut self, input: &Path, reason: &str) {
        self.totals.files += 1;
        self.totals.failed += 1;
        self.files.push(FileReport::refused(input, reason));
    }
}

impl Default for Report {
    fn default() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            settings: None,
            totals: Totals::default(),
            errors: Vec::new(),
            warnings: Vec::new(),
            files: Vec::new(),
            left_out: Vec::new(),
        }
    }
}

/// A JSON file about jobs. It is opened before the run, since a long one shall not end without its report.
pub struct JsonFile {
    path: PathBuf,
    place: JsonPlace,
}

/// Where JSON goes.
enum JsonPlace {
    File(Replacement),
    /// A device or a pipe, such as `/dev/stdout`.
    Stream(File),
}

impl JsonFile {
    /// Opens a file about `jobs`, `what` in words: the report, say. Its folders are created, and it appears under its
    /// name when it is complete. A device or a pipe, such as `/dev/stdout`, is written as it is.
    ///
    /// # Errors
    /// [`Error::File`] if it is the input or output of a job or the settings file, or cannot be replaced; [`Error::Io`].
    pub fn create(what: &str, path: &Path, jobs: &[Files<'_>], settings: Option<&Path>) -> Result<Self> {
        targets::check_report(what, path, jobs, settings)?;
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).map_err(Error::io(path))?;
        let is_stream = std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir());
        let place = match is_stream {
            true => JsonPlace::Stream(open_stream(path)?),
            false => JsonPlace::File(Replacement::create(path)?),
        };
        Ok(Self { path: path.into(), place })
    }

    /// Writes a report of what went wrong before it was known which files are inputs: only another report is replaced,
    /// as it would stand for this run.
    ///
    /// # Errors
    /// As [`JsonFile::create`]; [`Error::File`] for any other file.
    pub fn replace_report(path: &Path, report: &Report) -> Result<()> {
        let is_file = std::fs::metadata(path).is_ok_and(|there| there.is_file());
        if is_file && !is_report(path) {
            return Err(Error::file(path, "it is no report", "choose another name for the report"));
        }
        Self::create("report", path, &[], None)?.write(report)
    }

    /// Writes `content` and closes the file.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be written.
    pub fn write(self, content: &impl Serialize) -> Result<()> {
        let mut json = serde_json::to_vec_pretty(content).map_err(|error| Error::io(&self.path)(error.into()))?;
        json.push(b'\n');
        match self.place {
            JsonPlace::File(file) => {
                file.output()?.write_all(&json).map_err(Error::io(&self.path))?;
                file.commit()
            }
            JsonPlace::Stream(mut stream) => stream.write_all(&json).map_err(Error::io(&self.path)),
        }
    }
}

/// Whether a file is a report of files.
fn is_report(path: &Path) -> bool {
    let keys = ["version", "totals", "errors", "files"];
    let content = File::open(path).ok().and_then(|file| serde_json::from_reader(BufReader::new(file)).ok());
    content.is_some_and(|content: serde_json::Value| keys.iter().all(|key| content.get(key).is_some()))
}

impl Totals {
    /// Sums over `outcomes`, which took `time` together.
    pub fn new(outcomes: &[Outcome], time: Duration) -> Self {
        let mut totals = Self { files: outcomes.len(), seconds: time.as_secs_f64(), ..Self::default() };
        for outcome in outcomes {
            match FileResult::of(outcome) {
                FileResult::Baked => totals.baked += 1,
                FileResult::Fresh => totals.fresh += 1,
                FileResult::Failed => totals.failed += 1,
                FileResult::Stopped => totals.stopped += 1,
                FileResult::NotBegun => totals.not_begun += 1,
            }
            if let Some(baked) = outcome.baked() {
                totals.texels += baked.size.texels() as u64;
                totals.bytes_in += outcome.bytes_in;
                totals.bytes_out += outcome.bytes_out;
            }
        }
        totals.megatexels_per_second = totals.texels as f64 / 1e6 / totals.seconds.max(1e-9);
        totals
    }
}

impl FileResult {
    /// What `outcome` amounts to.
    pub fn of<T>(outcome: &Outcome<T>) -> Self {
        match &outcome.result {
            Ok(_) if outcome.freshness == Some(Freshness::Fresh) => Self::Fresh,
            Ok(_) => Self::Baked,
            Err(Error::Cancelled) if outcome.time.is_none() => Self::NotBegun,
            Err(Error::Cancelled) => Self::Stopped,
            Err(_) => Self::Failed,
        }
    }
}

impl RunReport {
    /// What `outcome` of work on maps says; how it ran and their size are there if it went well.
    pub(super) fn of_maps<T>(
        outcome: &Outcome<T>,
        done: Option<(&Ran, Size)>,
        baker: &Baker,
        failure: Option<String>,
    ) -> Self {
        let (ran, size) = done.unzip();
        let size = SizeReport { width: size.map(Size::width), height: size.map(Size::height) };
        Self { size: Some(size), ..Self::new(outcome, ran, baker, failure) }
    }

    /// What `outcome` says; how it ran is there if it went well.
    pub(super) fn new<T>(outcome: &Outcome<T>, ran: Option<&Ran>, baker: &Baker, failure: Option<String>) -> Self {
        Self {
            result: FileResult::of(outcome),
            error: failure,
            warnings: outcome.warnings.clone(),
            backend: ran.map(|ran| ran.backend),
            adapter: ran.map(|ran| ran.device.clone()),
            reason: baker.reason().to_owned(),
            fallback: ran.and_then(|ran| ran.fallback.clone()),
            size: None,
            milliseconds: outcome.time.map(|time| (time.as_secs_f64() * 1e6).round() / 1e3),
            bytes_in: outcome.bytes_in,
            bytes_out: outcome.bytes_out,
        }
    }
}

impl FileReport {
    fn refused(input: &Path, reason: &str) -> Self {
        Self {
            input: input.into(),
            normals: None,
            outputs: Outputs { normal: None, parallax: None, roughness: None },
            options: None,
            depth: None,
            scale: None,
            parallax: None,
            stale: None,
            run: RunReport {
                result: FileResult::Failed,
                error: Some(reason.into()),
                warnings: Vec::new(),
                backend: None,
                adapter: None,
                reason: String::new(),
                fallback: None,
                size: Some(SizeReport { width: None, height: None }),
                milliseconds: None,
                bytes_in: 0,
                bytes_out: 0,
            },
        }
    }

    fn new(job: &Job, outcome: &Outcome, iterations: NonZeroU32) -> Self {
        let baked = outcome.result.as_ref().ok();
        let ratio =
            |part: i32, q: u32| crate::Rational::new(part.into(), q.into()).map_or(String::new(), |r| r.to_string());
        let scale = baked.map(|baked| baked.scale);
        let text = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        Self {
            input: job.input.clone(),
            normals: job.normals.as_ref().map(|normals| normals.path.display().to_string()),
            outputs: Outputs {
                normal: text(&job.outputs.normal),
                parallax: text(&job.outputs.parallax),
                roughness: text(&job.outputs.roughness),
            },
            options: Some(Options::new(job, iterations)),
            depth: baked.map(|baked| baked.height_type.to_string()),
            scale: scale.map(|s| UsedScale { x: ratio(s.x, s.q), y: ratio(s.y, s.q), exact: s.exact }),
            parallax: ParallaxNumbers::of(job, outcome, iterations),
            stale: outcome.freshness.as_ref().filter(|it| **it != Freshness::Fresh).map(ToString::to_string),
            run: RunReport::of_maps(
                outcome,
                baked.map(|baked| (&baked.ran, baked.size)),
                &job.baker,
                job.failure(outcome),
            ),
        }
    }
}

impl Options {
    fn new(job: &Job, iterations: NonZeroU32) -> Self {
        // All fields by name, so that none can be forgotten.
        let BakeOptions { scale, filter, edges, normal, parallax, roughness, precision } = job.options;
        let ReadOptions { channel, color_space, raw, shrink, max_bytes } = &job.read;
        let WriteOptions { compression, mips, blocks } = job.write;
        let kinds = (MapKind::Normal, MapKind::Parallax, MapKind::Roughness);
        let maps = [normal.map(|_| kinds.0), parallax.map(|_| kinds.1), roughness.map(|_| kinds.2)];
        let maps: Vec<String> = maps.into_iter().flatten().map(|kind| kind.to_string()).collect();
        Self {
            scale: scale.to_string(),
            filter: filter.to_string(),
            edge: edges.to_string(),
            maps: maps.join(","),
            encoding: normal.map(|format| format.encoding.to_string()),
            bits: normal.map(|format| format.depth.to_string()),
            channels: normal.map(|format| format.channels.to_string()),
            convention: normal.map(|format| format.convention.to_string()),
            parallax_encoding: parallax.map(|format| format.encoding.to_string()),
            parallax_bits: parallax.map(|format| format.depth.to_string()),
            iterations: parallax.map(|_| iterations.get()),
            precision: precision.to_string(),
            compression: compression.to_string(),
            mips,
            roughness_method: roughness.map(|options| options.method.to_string()),
            base_roughness: roughness.map(|options| options.base.to_string()),
            roughness_bits: roughness.map(|options| options.format.depth.to_string()),
            block_compression: blocks.map(|blocks| blocks.to_string()),
            neighbours: job.neighbours.as_ref().map(Neighbours::sides),
            channel: channel.as_ref().map(ToString::to_string),
            color_space: color_space.to_string(),
            raw: raw.map(|layout| layout.to_string()),
            shrink: shrink.get(),
            max_bytes: *max_bytes,
        }
    }
}

/// A path as text; names that are no Unicode are no reason to lose a report.
pub(super) fn as_text<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}
