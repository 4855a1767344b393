//! `texbake preview`: pictures of a material, and of a model that wears it.

use super::check::{create_folder_of, is_same_file};
use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::settings::{Backend, Settings, open_baker};
use super::values::{USUAL_ITERATIONS, iterations};
use clap::Args;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use texbake::material::Material;
use texbake::preview::{Light, Look, Picture, Renderer, Sheet, SheetOptions, Surface, Told};
use texbake::stream::Monitor;
use texbake::{Error, HeightMap, NormalFormat, Result};

/// Show a material as a scene would: a sheet of all parallax methods and their errors, or a model that wears it
#[derive(Args, Debug)]
#[command(after_help = "\
The sheet shows a plane, from two elevations: flat; normal mapped; with
parallax by Welsh, with his offset limiting, by the plane of a texel (FGED2
eq. 7.50) with offsets of at most one and three heights, and in steps through
the parallax map (listing 7.9); and by relief intersection, which is the truth
that the others approximate. Beneath each picture is the length of the error
of its offsets, in texels, from black over blue, green and red to white (the
cubehelix ramp). Depths are dark, heights are bright; the light is where the
small sun is in the flat picture.

Examples:
  texbake preview height.png -o sheet.png --scale 24
  texbake preview wall.png -o sheet.png --size 2x2 --depth 0.1 --iterations 8

Exit status: 0 the picture was written, 1 something failed, 2 wrong arguments,
130 interrupted.")]
pub struct PreviewArguments {
    /// Height map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or any file with --raw
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Picture: .png; missing folders are made
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Steps through the parallax map, besides 1 and 4
    #[arg(long, value_name = "K", default_value_t = USUAL_ITERATIONS, value_parser = iterations, help_heading = PICTURE)]
    pub iterations: NonZeroU32,

    /// Degrees above the surface from which it is seen, from 5 to 90, one for each row
    #[arg(long, value_name = "DEGREES", value_delimiter = ',', value_parser = elevation, default_values_t = [60.0, 25.0])]
    #[arg(help_heading = PICTURE)]
    pub elevations: Vec<f32>,

    /// Texels that a panel shows from left to right [default: ten times --scale, at most all]
    #[arg(long, value_name = "TEXELS", value_parser = above_zero, help_heading = PICTURE)]
    pub across: Option<f32>,

    /// Error that is white, in texels [default: the longest offset that the relief can have, for each elevation]
    #[arg(long, value_name = "TEXELS", value_parser = above_zero, help_heading = PICTURE)]
    pub error_max: Option<f32>,

    /// Where the light comes from: degrees counterclockwise from the right, and degrees above the surface
    #[arg(long, value_name = "ANGLE,HEIGHT", value_parser = light, default_value = "135,40", help_heading = PICTURE)]
    pub light: Light,

    /// Width of a panel in pixels, from 64 to 1024
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(64..=1024), default_value_t = 164)]
    #[arg(help_heading = PICTURE)]
    pub panel: u32,

    #[command(flatten)]
    pub settings: Settings,

    /// Print errors only
    #[arg(short, long, help_heading = "Reporting")]
    pub quiet: bool,
}

const PICTURE: &str = "Picture";

pub fn preview(arguments: &PreviewArguments) -> Result<Exit, Failure> {
    Picture::check_output(&arguments.output).map_err(|error| Failure::Usage(error.to_string()))?;
    if is_same_file(&arguments.input, &arguments.output) {
        let input = arguments.input.display();
        return Err(Failure::Usage(format!("--output would overwrite {input}: choose another name")));
    }
    let monitor = interruptible();
    let ended = sheet(arguments, &monitor);
    if ended.is_err() && monitor.is_cancelled() {
        say(format_args!("{} was not written", arguments.output.display()));
        return Ok(Exit::Interrupted);
    }
    ended
}

fn sheet(arguments: &PreviewArguments, monitor: &Monitor) -> Result<Exit, Failure> {
    let renderer = renderer(&arguments.settings)?;
    let material = material(arguments)?;
    let options = arguments.sheet_options(&material);
    let sheet = Sheet::render(&material, &options, &renderer, monitor)?;
    create_folder_of(&arguments.output)?;
    if monitor.is_cancelled() {
        return Err(Error::Cancelled.into());
    }
    sheet.picture.write(&arguments.output)?;
    if !arguments.quiet {
        put(lines(&sheet));
        let size = sheet.picture.size();
        renderer.fallback().iter().for_each(|reason| say(format_args!("warning: {reason}; the CPU did it instead")));
        let (name, reason) = (renderer.name(), renderer.reason());
        say(format_args!("{}: {size} pixels; {name} ({reason})", arguments.output.display()));
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

/// The material that is baked of the height map.
fn material(arguments: &PreviewArguments) -> Result<Material, Failure> {
    let settings = &arguments.settings;
    let options = settings.slope.bake(Some(normal_format(settings)?), Some(Default::default()))?;
    let baker = open_baker(&settings.device.place()?)?;
    let (heights, warnings) = HeightMap::read_with(&arguments.input, &settings.input.read())?;
    if !arguments.quiet {
        warnings.iter().for_each(|text| say(format_args!("warning: {}: {text}", arguments.input.display())));
    }
    Ok(Material::bake(&baker, &heights, &options)?)
}

/// The format that was asked for, if one kind of file can hold it.
fn normal_format(settings: &Settings) -> Result<NormalFormat> {
    let held_by = |name| settings.normal.format(Path::new(name));
    held_by("map.png").or_else(|error| held_by("map.tif").or_else(|_| held_by("map.exr")).map_err(|_| error))
}

impl PreviewArguments {
    fn sheet_options(&self, material: &Material) -> SheetOptions {
        let mut steps = vec![1, 4, self.iterations.get()];
        steps.sort_unstable();
        steps.dedup();
        let name = self.input.file_name().unwrap_or_default().to_string_lossy();
        SheetOptions {
            title: format!("{name}, scale {}", scale_of(material)),
            surfaces: SheetOptions::every_surface(&steps),
            elevations: self.elevations.clone(),
            width: self.across.map(|texels| texels / material.size().width() as f32),
            white: self.error_max,
            panel: [self.panel, self.panel * 25 / 32],
            look: Look { light: self.light, ..Look::default() },
        }
    }
}

fn scale_of(material: &Material) -> String {
    match material.scale() {
        [x, y] if x == y => format!("{x} texels"),
        [x, y] => format!("{x} and {y} texels"),
    }
}

/// What the sheet tells in numbers.
fn lines(sheet: &Sheet) -> String {
    let line = |told: &Told| {
        let Told { elevation, surface, errors } = told;
        format!(
            "{elevation:>4}° {surface:<18} mean {:>8.4}  99 % {:>8.4}  largest {:>8.4} texels",
            errors.mean, errors.percentile_99, errors.largest
        )
    };
    let told = sheet.told.iter().filter(|told| !matches!(told.surface, Surface::Flat | Surface::Truth));
    told.map(line).collect::<Vec<_>>().join("\n")
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
    let number = |text: &str| text.trim().parse::<f32>().ok().filter(|number| number.is_finite());
    let parts = text.split_once(',').and_then(|(azimuth, elevation)| Some((number(azimuth)?, number(elevation)?)));
    let light = parts.filter(|(azimuth, elevation)| azimuth.abs() <= 360.0 && (0.0..=90.0).contains(elevation));
    let light = light.map(|(azimuth, elevation)| Light { azimuth, elevation });
    light.ok_or_else(|| "it must be two numbers of degrees, from -360 to 360 and from 0 to 90, as 135,40".into())
}
