//! `texbake diff`: how two normal maps differ.

use super::check::{create_folder_of, is_same_file, place, texels};
use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::values::{ByteSize, choice, value};
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::PoisonError;
use texbake::inspect::{Census, CodeDifference, Counted, Difference, Misreading, heatmap};
use texbake::io::{NormalReadOptions, create_normals, default_format, open_normals};
use texbake::stream::{Monitor, NormalRows};
use texbake::{Channels, Convention, Encoding, Error, NormalFormat, Result};

/// Compare two normal maps: codes, angles, and where they differ most
#[derive(Args, Debug)]
#[command(after_help = "\
The angle of a texel is the one between both normals, whatever their lengths,
in double precision. Maps of different encodings, bits, channels or
conventions are compared by their angles, maps of one format by their codes
too. The 99th percentile has the exact rank and is given with 12 bits behind
the leading one. A texel of NaN, infinity, or (0, 0, 0) has no angle; it
counts as a difference, unless it is the same (0, 0, 0) in both.

The heatmap goes from black over blue, green and red to white (the cubehelix
ramp, brighter for larger angles); a texel without an angle is magenta.

Examples:
  texbake diff cpu.png gpu.png
  texbake diff old_normal.png new_normal.tif --tolerance 0.5
  texbake diff gl.png dx.png --convention gl,dx --heatmap angles.png

Exit status: 0 no difference above --tolerance, 1 a difference or a file that
cannot be read, 2 wrong arguments, 130 interrupted.")]
pub struct DiffArguments {
    /// A normal map: PNG, TIFF, EXR, TGA, BMP, JPEG or WebP
    #[arg(value_name = "A")]
    pub a: PathBuf,

    /// A normal map of the same size
    #[arg(value_name = "B")]
    pub b: PathBuf,

    /// Largest angle that is no difference; 0: the same codes
    #[arg(long, value_name = "DEGREES", value_parser = angle, allow_hyphen_values = true, default_value = "0")]
    pub tolerance: f64,

    /// Paint the angles into a picture: .png, or .tif; missing folders are made
    #[arg(long, value_name = "FILE")]
    pub heatmap: Option<PathBuf>,

    /// Angle that is white in the heatmap [default: the largest]
    #[arg(long, value_name = "DEGREES", value_parser = angle, allow_hyphen_values = true, requires = "heatmap")]
    pub heatmap_max: Option<f64>,

    /// Print JSON
    #[arg(long)]
    pub json: bool,

    /// How codes are read, of both or of A,B; unorm also reads floats from 0 to 1 [default: unorm for unsigned integers,
    /// snorm for signed ones, float]
    #[arg(long, value_delimiter = ',', value_parser = choice::<Encoding>(Encoding::NAMES), help_heading = INPUTS)]
    pub encoding: Vec<Encoding>,

    /// Components, of both or of A,B; z of xy is rebuilt [default: as the file has them]
    #[arg(long, value_delimiter = ',', value_parser = choice::<Channels>(Channels::NAMES), help_heading = INPUTS)]
    pub channels: Vec<Channels>,

    /// Green up (gl) or down (dx), of both or of A,B [default: gl]
    #[arg(long, value_delimiter = ',', value_parser = choice::<Convention>(Convention::NAMES), help_heading = INPUTS)]
    pub convention: Vec<Convention>,

    /// Most memory that decoding one file may take: 512M, 4G [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, help_heading = INPUTS)]
    pub max_bytes: Option<ByteSize>,
}

const INPUTS: &str = "Inputs";

pub fn diff(arguments: &DiffArguments) -> Result<Exit, Failure> {
    let monitor = interruptible();
    let ended = compare(arguments, &monitor);
    // Nothing else that is left to say matters then.
    if ended.is_err() && monitor.is_cancelled() { Ok(Exit::Interrupted) } else { ended }
}

fn compare(arguments: &DiffArguments, monitor: &Monitor) -> Result<Exit, Failure> {
    let read = arguments.read()?;
    arguments.check_heatmap()?;
    let open = || -> Result<[NormalRows; 2]> {
        Ok([open_normals(&arguments.a, &read[0])?.rows, open_normals(&arguments.b, &read[1])?.rows])
    };
    let maps = open()?;
    let [a, b] = maps.each_ref().map(|map| map.size());
    if a != b {
        let (first, second) = (arguments.a.display(), arguments.b.display());
        return Err(Failure::Failed(format!("{first} has {a} texels, {second} {b}: give two maps of one size")));
    }
    let [(a, in_a), (b, in_b)] = maps.map(Counted::new);
    let difference = Difference::between(Box::new(a), Box::new(b), arguments.tolerance, monitor)?;
    for (path, read, census) in [(&arguments.a, &read[0], in_a), (&arguments.b, &read[1], in_b)] {
        let census = census.lock().unwrap_or_else(PoisonError::into_inner);
        warn_of_misreading(path, read, &census);
    }
    let white = arguments.white(&difference);
    if let Some(path) = &arguments.heatmap {
        create_folder_of(path)?;
        let picture = create_normals(path, difference.size, NormalFormat::default())?;
        heatmap(open()?, white, picture, monitor)?;
    }
    let is_beyond = difference.exceeds(arguments.tolerance);
    if arguments.json {
        put(format_args!("{:#}", json_of(arguments, &difference, is_beyond)));
    } else {
        put(lines(arguments, &difference));
    }
    Ok(if is_beyond { Exit::Failed } else { Exit::Success })
}

/// Says so if a map seems to be read wrongly and the user has not said how to.
fn warn_of_misreading(path: &Path, read: &NormalReadOptions, census: &Census) {
    let Some(misreading) = census.misreading() else { return };
    let is_said = match misreading {
        Misreading::TwoChannels => read.channels.is_some(),
        Misreading::UnormFloats => read.encoding.is_some(),
    };
    if !is_said {
        say(format_args!("warning: {}: {misreading}; {}", path.display(), misreading.remedy()));
    }
}

impl DiffArguments {
    /// Fails if the heatmap cannot be written, before anything is compared.
    fn check_heatmap(&self) -> Result<(), Failure> {
        let Some(path) = &self.heatmap else { return Ok(()) };
        if default_format(path)?.0 == Encoding::Float {
            return Err(Failure::Usage(format!("--heatmap is {}: it must be a .png or .tif file", path.display())));
        }
        let input = [&self.a, &self.b].into_iter().find(|input| is_same_file(input, path));
        input.map_or(Ok(()), |input| {
            Err(Failure::Usage(format!("--heatmap would overwrite {}: choose another name", input.display())))
        })
    }

    /// The angle that is white in the heatmap, in degrees.
    fn white(&self, difference: &Difference) -> f64 {
        let largest = difference.largest.map_or(0.0, |(degrees, _)| f64::from(degrees));
        // Where nothing differs any scale paints black.
        self.heatmap_max.unwrap_or(if largest > 0.0 { largest } else { 1.0 })
    }

    /// How either map is read.
    fn read(&self) -> Result<[NormalReadOptions; 2], Failure> {
        let default = NormalReadOptions::default();
        let encoding = of_each("encoding", &self.encoding)?;
        let channels = of_each("channels", &self.channels)?;
        let convention = of_each("convention", &self.convention)?;
        let max_bytes = self.max_bytes.map_or(default.max_bytes, |ByteSize(bytes)| bytes);
        Ok([0, 1].map(|map| NormalReadOptions {
            encoding: encoding[map],
            channels: channels[map],
            convention: convention[map].unwrap_or_default(),
            max_bytes,
        }))
    }
}

/// One value is for both maps.
fn of_each<T: Copy>(parameter: &'static str, values: &[T]) -> Result<[Option<T>; 2], Failure> {
    match *values {
        [] => Ok([None; 2]),
        [both] => Ok([Some(both); 2]),
        [a, b] => Ok([Some(a), Some(b)]),
        _ => {
            let value = format!("{} values", values.len());
            Err(Error::Parameter { parameter, value, range: "one for both maps, or two: A,B".into() }.into())
        }
    }
}

/// An angle in degrees.
fn angle(text: &str) -> Result<f64, String> {
    let degrees = text.parse().ok().filter(|degrees| (0.0..=180.0).contains(degrees));
    degrees.ok_or_else(|| "it must be a number of degrees between 0 and 180".into())
}

fn lines(arguments: &DiffArguments, difference: &Difference) -> String {
    let percent = |texels: u64| 100.0 * texels as f64 / difference.size.texels() as f64;
    let Difference { differing, above_tolerance, size, .. } = difference;
    let above = match arguments.tolerance {
        0.0 => None,
        degrees => {
            Some(format!("{} ({:.4}%) above {degrees} degrees", texels(*above_tolerance), percent(*above_tolerance)))
        }
    };
    let differing = format!("{differing} of {size} texels differ ({:.4}%)", percent(*differing));
    let codes = difference.codes.as_ref().map(code_line);
    let codes = codes.unwrap_or_else(|| "codes: of different formats, not compared".into());
    let angles = difference.largest.map(|(degrees, at)| match degrees {
        0.0 => "angle: 0 degrees everywhere".into(),
        _ => format!(
            "angle: largest {degrees:.6} degrees at {at}, 99th percentile {:.6}, mean {:.6}",
            difference.percentile_99, difference.mean
        ),
    });
    let no_angle = match difference.no_angle {
        0 => None,
        texels => Some(format!("without direction in one map or both: {texels} texels")),
    };
    let painted = arguments
        .heatmap
        .as_ref()
        .map(|path| format!("{}: white is {:.6} degrees and more", path.display(), arguments.white(difference)));
    [Some(differing), above, Some(codes), angles, no_angle, painted]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join("\n")
}

fn code_line(codes: &CodeDifference) -> String {
    let channels = ["x", "y", "z"].iter().zip(codes.largest.iter().zip(&codes.mean));
    let channels = channels.map(|(channel, (largest, mean))| format!("{channel} {largest} and {mean:.6}"));
    let (largest, mean) = (codes.largest_of_all(), codes.mean_of_all());
    format!("codes: largest difference {largest}, mean {mean:.6} ({})", channels.collect::<Vec<_>>().join(", "))
}

fn json_of(arguments: &DiffArguments, difference: &Difference, is_beyond: bool) -> Value {
    let format = |format: NormalFormat| {
        json!({
            "encoding": format.encoding.to_string(),
            "bits": format.depth.to_string(),
            "channels": format.channels.to_string(),
            "convention": format.convention.to_string(),
        })
    };
    let codes = difference.codes.as_ref().map(|codes| {
        json!({
            "largest": codes.largest_of_all(),
            "mean": codes.mean_of_all(),
            "largest_of_channels": codes.largest,
            "mean_of_channels": codes.mean,
        })
    });
    json!({
        "a": arguments.a.to_string_lossy(),
        "b": arguments.b.to_string_lossy(),
        "width": difference.size.width(),
        "height": difference.size.height(),
        "formats": difference.formats.map(format),
        "within_tolerance": !is_beyond,
        "tolerance": arguments.tolerance,
        "differing": difference.differing,
        "above_tolerance": difference.above_tolerance,
        "no_angle": difference.no_angle,
        "codes": codes,
        "degrees": {
            "largest": difference.largest.map(|(degrees, _)| degrees),
            "mean": difference.mean,
            "percentile_99": difference.percentile_99,
        },
        "worst": difference.largest.map(|(_, at)| place(at)),
        "heatmap": arguments.heatmap.as_ref().map(|path| {
            json!({ "file": path.to_string_lossy(), "white_degrees": arguments.white(difference) })
        }),
    })
}
