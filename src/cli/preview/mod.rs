//! `texbake preview`: pictures of a material, and of a model that wears it.

mod maps;
mod model;

use super::check::{create_folder_of, is_same_file};
use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::settings::{Backend, Settings};
use super::values::{USUAL_ITERATIONS, choice, iterations};
use clap::Args;
use maps::Shown;
use std::num::NonZeroU32;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use texbake::material::{Material, ParallaxMethod};
use texbake::preview::{
    Light, Look, ModelSheetOptions, Paint, Picture, Renderer, Sheet, SheetOptions, Surface, Told, model_sheet,
};
use texbake::stream::Monitor;
use texbake::{Encoding, Error, Result};

/// Show a material as a scene would: a sheet of all parallax methods and their errors, or a model that wears it
#[derive(Args, Debug)]
#[command(after_help = "\
The sheet shows a plane, from two elevations: flat; normal mapped; with
parallax by Welsh, with his offset limiting, by the plane of a texel (FGED2
eq. 7.50) with offsets of at most one and three heights, and in steps through
the parallax map (listing 7.9); and by relief intersection, which is the truth
that the others approximate. Beneath each picture is the length of the error
of its offsets, in texels, from black over blue, green and red to white (the
cubehelix ramp). Depths are dark, heights are bright; the light comes from the
small sun in the flat picture. The same numbers go to stdout.

--material takes maps that were baked before, NAME_normal and NAME_parallax
(and NAME_height, if it is there too) in one folder; FOLDER/NAME is one of
several. Heights may also be given as INPUT. Without heights there is no truth
to compare with, and no heatmap. --scale and --edge must be those that the
maps were baked with; --encoding, --channels and --convention say how the
normal map is read, --parallax-encoding how the parallax map is.

--model shows meshes that wear the material: normal mapped, with parallax,
with their tangents, bitangents and normals as lines, and with the handedness
as colours. Tangents are those of the file, else mikktspace's; both must be
glTF's, for green up. Meshes stand where the nodes of the first scene put them;
skins move nothing. Models are rendered on the CPU; sheets on a GPU if there is
a real one.

Examples:
  texbake preview height.png -o sheet.png --scale 24
  texbake preview wall.png -o sheet.png --size 2x2 --depth 0.1 --iterations 8
  texbake preview --material baked/ -o sheet.png --scale 24 --convention dx
  texbake preview --material baked/ --model model_t.glb -o shot.png
  texbake preview height.png --model model.obj -o shot.png --scale 24

Exit status: 0 the picture was written, 1 something failed, 2 wrong arguments,
130 interrupted.")]
pub struct PreviewArguments {
    /// Height map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or any file with --raw
    #[arg(value_name = "INPUT")]
    pub input: Option<PathBuf>,

    /// Folder of maps that were baked before, or one of its materials, as baked/wall
    #[arg(long, value_name = "FOLDER")]
    pub material: Option<PathBuf>,

    /// What the codes of the parallax map of --material mean [default: biased, snorm if they are signed, float]
    #[arg(long, value_name = "ENCODING", value_parser = choice::<Encoding>(Encoding::NAMES), requires = "material")]
    pub parallax_encoding: Option<Encoding>,

    /// Model that wears the material: .glb, .gltf or .obj
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,

    /// Picture: .png; missing folders are made
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Steps through the parallax map, besides 1 and 4
    #[arg(long, value_name = "K", default_value_t = USUAL_ITERATIONS, value_parser = iterations, help_heading = PICTURE)]
    #[arg(conflicts_with = "model")]
    pub iterations: NonZeroU32,

    /// Degrees above the surface from which it is seen, from 5 to 90, one for each row, with commas [default: 60,25]
    #[arg(long, value_name = "DEGREES", value_delimiter = ',', value_parser = elevation, default_value = "60,25")]
    #[arg(help_heading = PICTURE, hide_default_value = true, allow_negative_numbers = true, conflicts_with = "model")]
    pub elevations: Vec<f32>,

    /// Texels that a panel shows from left to right [default: ten times --scale, at most all]
    #[arg(long, value_name = "TEXELS", value_parser = above_zero, help_heading = PICTURE)]
    #[arg(allow_negative_numbers = true, conflicts_with = "model")]
    pub across: Option<f32>,

    /// Error that is white, in texels [default: the longest offset that the relief can have, for each elevation]
    #[arg(long, value_name = "TEXELS", value_parser = above_zero, help_heading = PICTURE)]
    #[arg(allow_negative_numbers = true, conflicts_with = "model")]
    pub error_max: Option<f32>,

    /// Where the light comes from: degrees counterclockwise from the right, and degrees above the surface
    #[arg(long, value_name = "ANGLE,HEIGHT", value_parser = light, default_value = "135,40", allow_hyphen_values = true)]
    #[arg(help_heading = PICTURE)]
    pub light: Light,

    /// Degrees by which the model is turned to the left, from -360 to 360, and above it, from -89 to 89
    #[arg(long, value_name = "TURN,HEIGHT", value_parser = view, default_value = "30,25", allow_hyphen_values = true)]
    #[arg(help_heading = PICTURE, requires = "model")]
    pub view: ModelView,

    /// Width of a panel in pixels, from 128 to 1024, and from 200 for a model [default: 164; 340 for a model]
    #[arg(long, value_name = "PIXELS", value_parser = panel, help_heading = PICTURE)]
    pub panel: Option<u32>,

    /// At most N colours, from 2 to 256, for a file of a third of the bytes or less [default: all]
    #[arg(long, value_name = "N", value_parser = colors, help_heading = PICTURE)]
    pub colors: Option<u16>,

    #[command(flatten)]
    pub settings: Settings,

    /// Print errors only
    #[arg(short, long, help_heading = "Reporting")]
    pub quiet: bool,
}

const PICTURE: &str = "Picture";
/// Pixels of a model's panel that the words above it need.
const LEAST_OF_MODELS: u32 = 200;

/// From where a model is seen, in degrees: around it, and above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelView {
    pub turn: f32,
    pub elevation: f32,
}

pub fn preview(arguments: &PreviewArguments) -> Result<Exit, Failure> {
    arguments.check_output()?;
    let monitor = interruptible();
    let ended = shown(arguments, &monitor);
    if ended.is_err() && monitor.is_cancelled() {
        say(format_args!("{} was not written", arguments.output.display()));
        return Ok(Exit::Interrupted);
    }
    ended
}

fn shown(arguments: &PreviewArguments, monitor: &Monitor) -> Result<Exit, Failure> {
    let shown = Shown::of(arguments)?;
    let (picture, told, place) = match &arguments.model {
        Some(path) => {
            let meshes = model::meshes(path, arguments)?;
            let picture = model_sheet(&meshes, &shown.material, &arguments.model_options(path, &shown), monitor)?;
            (picture, None, "cpu, which renders all models".to_owned())
        }
        None => {
            let renderer = renderer(&arguments.settings)?;
            let sheet = Sheet::render(&shown.material, &arguments.sheet_options(&shown), &renderer, monitor)?;
            let place = match renderer.fallback() {
                Some(reason) => {
                    if !arguments.quiet {
                        say(format_args!("warning: {reason}; the CPU did it instead"));
                    }
                    format!("cpu, in place of {}", renderer.name())
                }
                None => format!("{} ({})", renderer.name(), renderer.reason()),
            };
            (sheet.picture, Some(sheet.told), place)
        }
    };
    create_folder_of(&arguments.output)?;
    if monitor.is_cancelled() {
        return Err(Error::Cancelled.into());
    }
    match arguments.colors {
        Some(colors) => picture.write_in_colours(&arguments.output, colors.into())?,
        None => picture.write(&arguments.output)?,
    }
    if !arguments.quiet {
        if !shown.has_heights && told.is_some() {
            say("without heights there is no truth to compare with: give the height map as INPUT for the errors");
        }
        told.filter(|told| !told.is_empty()).iter().for_each(|told| put(lines(told)));
        say(format_args!("{}: {} pixels; {place}", arguments.output.display(), picture.size()));
    }
    Ok(Exit::Success)
}

/// What renders it.
fn renderer(settings: &Settings) -> Result<Renderer> {
    match settings.device.place()? {
        (Backend::Auto, _) => Ok(Renderer::auto()),
        (Backend::Cpu | Backend::Reference, _) => Ok(Renderer::cpu()),
        (Backend::Gpu, adapter) => Renderer::gpu(adapter.as_deref()),
    }
}

impl PreviewArguments {
    /// Fails if the picture cannot be called so, before anything is read.
    fn check_output(&self) -> Result<(), Failure> {
        Picture::check_output(&self.output).map_err(|error| Failure::Usage(error.to_string()))?;
        if self.model.is_some() && self.panel.is_some_and(|panel| panel < LEAST_OF_MODELS) {
            return Err(Failure::Usage(format!("--panel must be at least {LEAST_OF_MODELS} for a model")));
        }
        check_overwrites_none(&self.output, [&self.input, &self.model].into_iter().flatten().map(PathBuf::as_path))
    }

    fn sheet_options(&self, shown: &Shown) -> SheetOptions {
        let mut steps = vec![1, 4, self.iterations.get()];
        steps.sort_unstable();
        steps.dedup();
        let is_possible = |surface: &Surface| match surface {
            Surface::Flat | Surface::Mapped(ParallaxMethod::None) => true,
            Surface::Mapped(ParallaxMethod::Steps { .. }) => shown.has_parallax,
            Surface::Mapped(_) | Surface::Truth => shown.has_heights,
        };
        let (usual, material) = (SheetOptions::default(), &shown.material);
        let [width, height] = usual.panel;
        let panel = self.panel.unwrap_or(width);
        SheetOptions {
            title: format!("{}, scale {}", shown.name, scale_of(material)),
            surfaces: SheetOptions::every_surface(&steps).into_iter().filter(is_possible).collect(),
            elevations: self.elevations.clone(),
            width: self.across.map(|texels| texels / material.size().width() as f32),
            white: self.error_max,
            panel: [panel, panel * height / width],
            look: self.look(material),
        }
    }

    fn model_options(&self, path: &Path, shown: &Shown) -> ModelSheetOptions {
        let usual = ModelSheetOptions::default();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // Without heights there may still be steps through the parallax map.
        let possible = |paint| match paint {
            Paint::Lit(ParallaxMethod::Limited) if !shown.has_heights => {
                shown.has_parallax.then(|| Paint::Lit(ParallaxMethod::steps(self.iterations.get())))
            }
            paint => Some(paint),
        };
        ModelSheetOptions {
            title: format!("{name} with {}, scale {}", shown.name, scale_of(&shown.material)),
            paints: usual.paints.into_iter().filter_map(possible).collect(),
            turn: self.view.turn,
            elevation: self.view.elevation,
            panel: self.panel.unwrap_or(usual.panel),
            look: self.look(&shown.material),
        }
    }

    /// Depths are dark whichever way the codes go.
    fn look(&self, material: &Material) -> Look {
        let look = Look { light: self.light, ..Look::default() };
        if material.scale()[0] < 0.0 { Look { low: look.high, high: look.low, ..look } } else { look }
    }
}

/// Fails if the picture would replace one of the files that are read.
fn check_overwrites_none<'a>(output: &Path, mut read: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
    match read.find(|input| is_same_file(input, output)) {
        Some(input) => {
            Err(Failure::Usage(format!("--output would overwrite {}: choose another name", input.display())))
        }
        None => Ok(()),
    }
}

fn scale_of(material: &Material) -> String {
    match material.scale() {
        [x, y] if x == y => format!("{x} texels"),
        [x, y] => format!("{x} and {y} texels"),
    }
}

/// What the sheet tells in numbers.
fn lines(told: &[Told]) -> String {
    let line = |told: &Told| {
        let Told { elevation, surface, errors } = told;
        format!(
            "{elevation:>4}° {surface:<18} mean {:>8.4}  99 % {:>8.4}  largest {:>8.4} texels",
            errors.mean, errors.percentile_99, errors.largest
        )
    };
    let told = told.iter().filter(|told| !matches!(told.surface, Surface::Flat | Surface::Truth));
    told.map(line).collect::<Vec<_>>().join("\n")
}

fn panel(text: &str) -> Result<u32, String> {
    let pixels = text.parse().ok().filter(|pixels| (128..=1024).contains(pixels));
    pixels.ok_or_else(|| "it must be a whole number from 128 to 1024".into())
}

fn colors(text: &str) -> Result<u16, String> {
    let colors = text.parse().ok().filter(|colors| (2..=256).contains(colors));
    colors.ok_or_else(|| "it must be a whole number from 2 to 256".into())
}

fn elevation(text: &str) -> Result<f32, String> {
    let degrees = text.parse().ok().filter(|degrees| (5.0..=90.0).contains(degrees));
    degrees.ok_or_else(|| "it must be a number of degrees from 5 to 90".into())
}

fn above_zero(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| (1e-3..=1e6).contains(number));
    number.ok_or_else(|| "it must be a number from 0.001 to 1000000".into())
}

fn light(text: &str) -> Result<Light, String> {
    let light = angles(text, 0.0..=90.0).map(|[azimuth, elevation]| Light { azimuth, elevation });
    light.ok_or_else(|| "it must be two numbers of degrees, from -360 to 360 and from 0 to 90, as 135,40".into())
}

fn view(text: &str) -> Result<ModelView, String> {
    let view = angles(text, -89.0..=89.0).map(|[turn, elevation]| ModelView { turn, elevation });
    view.ok_or_else(|| "it must be two numbers of degrees, from -360 to 360 and from -89 to 89, as 30,25".into())
}

/// Degrees around and above.
fn angles(text: &str, above: RangeInclusive<f32>) -> Option<[f32; 2]> {
    let (around, height) = text.split_once(',')?;
    let [around, height] = [around.trim().parse::<f32>().ok()?, height.trim().parse().ok()?];
    ((-360.0..=360.0).contains(&around) && above.contains(&height)).then_some([around, height])
}
