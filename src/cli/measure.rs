//! `texbake measure`: what each shortcut costs on the user's own map.

use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::settings::{HeightInput, Slope, max_bytes};
use super::values::{ByteSize, choice};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};
use texbake::io::{Model, ModelReadOptions};
use texbake::measure::{Figures, Input, Machine, MeasureOptions, Measured, Progress, Report, ReportFolder, measure};
use texbake::{BakeOptions, Baker, Convention, Error, HeightMap, Mesh, Result};

/// Measure on a height map what formats, precisions, blends, parallax methods and tangents cost, and what they buy
#[derive(Args, Debug)]
#[command(mut_arg("precision", |argument| argument.hide(true)))]
#[command(after_help = "\
Bakes the map in every precision, encoding, number of bits and of channels on
every device, blends it by every method, looks at it by every parallax method
from several elevations, and perturbs normals with tangents and without. Each
is compared with the truth in double precision: normals and parallax maps as a
shader decodes them with those of the heights, blends with the normals of the
sum of the heights, offsets with relief intersection, perturbed normals with
those of the surface. Then it says what each step buys and costs: the Pareto
fronts.

The folder gets report.json (every figure, with its unit), report.md (tables,
words and plots), and the plots as SVG and PNG: storage, bake-time, blend-time,
of parallax maps parallax-storage and parallax-bake-time, and of parallax
fetches, time, elevations and steps, by the 99th percentile and by the mean of
the errors. They are replaced when all are complete; an interrupt
leaves the old ones.

A map longer than 2048 texels on a side (256 with --quick) is measured in its
middle, which then is a map of its own. Errors are the same for the same input
and seed; times are what the machine gave, and the report says which.

Examples:
  texbake measure height.png --scale 24 -o report/
  texbake measure wall.png --size 2x2 --depth 0.1 -o report/ --adapter all
  texbake measure height.png --scale 24 -o report/ --quick --elevation 45
  texbake measure wall.png --scale 24 --detail grain.png --model house.glb \\
    -o report/

Exit status: 0 measured, 1 something failed, 2 wrong arguments, 130
interrupted.")]
pub struct MeasureArguments {
    /// Height map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or any file with --raw
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Folder for the report; it is made if it is missing
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,

    /// Height map that is blended with it, of the same scale in texels [default: INPUT turned by a quarter]
    #[arg(long, value_name = "FILE", help_heading = MEASURED)]
    pub detail: Option<PathBuf>,

    /// Model, .glb, .gltf or .obj, on whose meshes tangents are compared, besides a sphere, a torus, a sheared and a
    /// mirrored plane; may be repeated
    #[arg(long, value_name = "FILE", help_heading = MEASURED)]
    pub model: Vec<PathBuf>,

    /// Elevation of the view in degrees, 1 to below 90, that the fronts of parallax are for; 90 is straight from above
    #[arg(long, value_name = "DEGREES", default_value_t = MeasureOptions::default().elevation, help_heading = MEASURED)]
    pub elevation: f64,

    /// Less: 256 texels of the map on a side, 2048 pixels instead of 16384, three elevations, one run if --runs is not
    /// given
    #[arg(long, help_heading = MEASURED)]
    pub quick: bool,

    /// What pixels are drawn from
    #[arg(long, value_name = "NUMBER", default_value_t = MeasureOptions::default().seed, help_heading = MEASURED)]
    pub seed: u64,

    /// Runs of which each time is the median, after one that does not count, 1 to 1000 [default: 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000), help_heading = MEASURED)]
    pub runs: Option<u16>,

    /// Green of the normal maps: up (gl) or down (dx) [default: gl]
    #[arg(long, value_parser = choice::<Convention>(Convention::NAMES), help_heading = MEASURED)]
    pub convention: Option<Convention>,

    #[command(flatten)]
    pub slope: Slope,

    #[command(flatten)]
    pub heights: HeightInput,

    /// auto: the CPU, and a real GPU if there is one; cpu: the CPU alone; gpu: the best GPU alone, software too
    /// [default: auto]
    #[arg(long, value_enum, help_heading = DEVICES)]
    pub backend: Option<Backend>,

    /// Besides the CPU, the GPU whose description contains NAME, as in `texbake devices`; vulkan:NAME names the API too,
    /// `all` means every one; may be repeated. With --backend gpu without the CPU
    #[arg(long, value_name = "NAME", help_heading = DEVICES)]
    pub adapter: Vec<String>,

    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,
}

const MEASURED: &str = "What is measured";
const DEVICES: &str = "Where it runs";

/// What bakes.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backend {
    Auto,
    Cpu,
    Gpu,
}

pub fn run(arguments: &MeasureArguments) -> Result<Exit, Failure> {
    let monitor = interruptible();
    let options = arguments.options()?;
    let devices = arguments.devices()?;
    let read = arguments.heights.read();
    let (heights, mut warnings) = HeightMap::read_with(&arguments.input, &read)?;
    let detail = match &arguments.detail {
        None => None,
        Some(path) => {
            let (detail, more) = HeightMap::read_with(path, &read)?;
            warnings.extend(more);
            Some(detail)
        }
    };
    let mut models = Vec::new();
    for path in &arguments.model {
        models.extend(meshes(path, arguments.heights.max_bytes)?);
    }
    let name = |path: &Path| path.display().to_string();
    let input = Input::new(name(&arguments.input), &heights, arguments.detail.as_deref().map(name), &options)?;
    let folder = ReportFolder::create(&arguments.output, &arguments.files())?;
    if !arguments.quiet {
        warnings.iter().for_each(|text| say(format_args!("warning: {text}")));
    }
    let measured = Measured { heights: &heights, detail: detail.as_ref(), models: &models, devices: &devices };
    let bar = bar(arguments.quiet);
    let watch = &mut |progress: Progress<'_>| advance(&bar, progress, arguments);
    let figures = match measure(&measured, &options, &monitor, watch) {
        Err(Error::Cancelled) => {
            say(format_args!("{} was not written", arguments.output.display()));
            return Ok(Exit::Interrupted);
        }
        figures => figures?,
    };
    bar.finish_and_clear();
    let report = Report::new(command(), &options, input, Machine::this(&devices), figures);
    folder.write(&report)?;
    if !arguments.quiet {
        report.figures.notes.iter().for_each(|note| say(format_args!("warning: {note}")));
        show(&report.figures);
        put(format_args!("{}: report.json, report.md and plots", arguments.output.display()));
    }
    Ok(Exit::Success)
}

impl MeasureArguments {
    fn options(&self) -> Result<MeasureOptions, Failure> {
        if let Some(precision) = self.slope.precision {
            let range = "left out: both are measured".into();
            return Err(Error::Parameter { parameter: "precision", value: precision.to_string(), range }.into());
        }
        let defaults = MeasureOptions::default();
        let runs = if self.quick { 1 } else { defaults.runs };
        let bake = self.slope.bake(Some(Default::default()), None, None)?;
        Ok(MeasureOptions {
            bake: BakeOptions { scale: bake.scale.shrunk(self.heights.read().shrink)?, ..bake },
            convention: self.convention.unwrap_or_default(),
            seed: self.seed,
            runs: self.runs.map_or(runs, Into::into),
            quick: self.quick,
            elevation: self.elevation,
        })
    }

    /// What is read.
    fn files(&self) -> Vec<&Path> {
        let inputs = [&self.input].into_iter().chain(&self.detail).chain(&self.model);
        inputs.map(PathBuf::as_path).collect()
    }

    /// Opens what the arguments mean, each device once.
    fn devices(&self) -> Result<Vec<Baker>, Failure> {
        if let (Some(Backend::Cpu | Backend::Auto), Some(adapter)) = (self.backend, self.adapter.first()) {
            let range = "left out, or used with --backend gpu".into();
            return Err(Error::Parameter { parameter: "adapter", value: adapter.clone(), range }.into());
        }
        let mut devices = match self.backend {
            Some(Backend::Gpu) => Vec::new(),
            _ => vec![Baker::cpu()],
        };
        match (self.backend, &self.adapter[..]) {
            (Some(Backend::Cpu), []) => {}
            (Some(Backend::Gpu), []) => devices.push(Baker::gpu(None)?),
            (_, []) => devices.push(Baker::auto()),
            (_, named) => {
                for name in named.iter().filter(|name| *name != "all") {
                    devices.push(Baker::gpu(Some(name))?);
                }
                if named.iter().any(|name| name == "all") {
                    devices.extend(every_adapter());
                }
            }
        }
        let mut names = Vec::new();
        devices.retain(|device| {
            let is_new = !names.contains(&device.name());
            names.push(device.name());
            is_new
        });
        match devices.is_empty() {
            true => Err(Baker::gpu(None).err().map_or(Failure::Failed("there is no device".into()), Into::into)),
            false => Ok(devices),
        }
    }
}

/// Every adapter that works; of others it is said why not.
fn every_adapter() -> Vec<Baker> {
    let open = |device: &texbake::Device| match &device.self_test {
        Ok(()) => Baker::gpu(Some(&format!("{}:{}", device.api, device.name))).map_err(|error| error.to_string()),
        Err(reason) => Err(format!("{} ({}): {reason}", device.name, device.api)),
    };
    let gpus = texbake::devices().into_iter().filter(|device| device.api != "cpu");
    let say_why_not = |reason: String| say(format_args!("warning: not measured: {reason}"));
    gpus.filter_map(|device| open(&device).map_err(say_why_not).ok()).collect()
}

/// The meshes of a model by name: all with texture coordinates.
fn meshes(path: &Path, bytes: Option<ByteSize>) -> Result<Vec<(String, Mesh)>> {
    let model = Model::read_with(path, &ModelReadOptions { all: true, max_bytes: max_bytes(bytes) })?;
    let mesh = |i: usize| Ok((format!("{}, {}", path.display(), model.primitives()[i].name), model.mesh(i)?));
    (0..model.primitives().len()).map(mesh).collect()
}

/// What was typed, with quotes where a shell needs them.
fn command() -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,:=+%@".contains(c);
    let quoted = |word: String| match word.is_empty() || !word.chars().all(is_plain) {
        true => format!("'{}'", word.replace('\'', r"'\''")),
        false => word,
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    ["texbake".to_owned()].into_iter().chain(words).collect::<Vec<_>>().join(" ")
}

/// Hidden where stderr is no terminal.
fn bar(is_quiet: bool) -> ProgressBar {
    let bar = if is_quiet { ProgressBar::hidden() } else { ProgressBar::new(0) };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}").unwrap_or(ProgressStyle::default_bar()));
    bar
}

fn advance(bar: &ProgressBar, progress: Progress<'_>, arguments: &MeasureArguments) {
    // Where no bar is seen.
    if progress.done == 0 && bar.is_hidden() && !arguments.quiet {
        say(format_args!("measuring {}, {} steps", arguments.input.display(), progress.of));
    }
    bar.set_length(progress.of as u64);
    bar.set_position(progress.done as u64);
    bar.set_message(progress.step.to_owned());
}

/// The fronts in words.
fn show(figures: &Figures) {
    for front in &figures.fronts {
        put(format_args!("{}, by {}:", front.name, front.by));
        front.lines().iter().for_each(|line| put(format_args!("  {line}")));
    }
}
