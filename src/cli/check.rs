//! `texbake check`: what is wrong with normal maps.

use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::values::{ByteSize, choice, value};
use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use texbake::inspect::{CheckOptions, Findings, Misreading, Severity, Tally, Texel, check_file, repair};
use texbake::io::{NormalReadOptions, create_normals, open_normals};
use texbake::stream::Monitor;
use texbake::{Baker, Channels, Convention, Depth, Encoding, Error, NormalFormat, Result};

/// Tell what is wrong with normal maps, and mend it
#[derive(Args, Debug)]
#[command(after_help = "\
Faults, each with its share, the worst texel and what to do:
  no-direction  floats that are NaN, infinite or beyond 65536
  zero-vector   (0, 0, 0)
  misread       a third channel that is no z, or floats that hold 0 to 1:
                --repair refuses such maps until --channels or --encoding
                says how to read them
  non-unit      lengths that are off by more than three steps of the encoding
                (2.4 % for 8 bits; 0.2 % for floats)
  below-zero    z below zero
  green         green (or red) seems to point the other way: slopes of heights
                have no curl, and these have much less of it with green turned
                around; no telling for flat maps, slopes along one axis and
                what is not made of heights
  srgb          the file says that it holds sRGB colours
  eight-bit     16 bits or floats that hold nothing but 8-bit values
  banding       8 bits, most changes being single codes between plateaus of
                8 texels or more
Notes, which are no faults:
  rounding      lengths that are off by less: truncated or dithered codes
  at-zero       z of zero: as steep as the encoding can tell
  file          what else its reader has to say, such as that a JPEG bends
                normals
  seam          the edges do not fit where the map is repeated; a fault with
                --tiles; maps below 16 x 16 texels are not judged

Examples:
  texbake check wall_normal.png
  texbake check baked/*.png --tiles --json
  texbake check rock_normal.tif --encoding biased --convention dx
  texbake check resized_normal.png --repair -o repaired_normal.png

Exit status: 0 no fault, 1 a fault or a file that cannot be read, 2 wrong
arguments, 130 interrupted. With --repair it is the repaired map that counts,
and what cannot be mended: eight-bit and banding in the input.")]
pub struct CheckArguments {
    /// Normal maps: PNG, TIFF, EXR, TGA, BMP, JPEG or WebP
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// The maps shall tile: a seam is a fault
    #[arg(long)]
    pub tiles: bool,

    /// Print JSON
    #[arg(long)]
    pub json: bool,

    #[command(flatten)]
    pub read: ReadArguments,

    #[command(flatten)]
    pub repair: RepairArguments,
}

/// How normal maps are read.
#[derive(Args, Debug)]
pub struct ReadArguments {
    /// How codes are read; unorm also reads floats from 0 to 1 [default: unorm for unsigned integers, snorm for signed
    /// ones, float]
    #[arg(long, value_parser = choice::<Encoding>(Encoding::NAMES), help_heading = INPUT)]
    pub encoding: Option<Encoding>,

    /// Components; z of xy is rebuilt [default: as the file has them]
    #[arg(long, value_parser = choice::<Channels>(Channels::NAMES), help_heading = INPUT)]
    pub channels: Option<Channels>,

    /// Green up (gl) or down (dx) [default: gl]
    #[arg(long, value_parser = choice::<Convention>(Convention::NAMES), help_heading = INPUT)]
    pub convention: Option<Convention>,

    /// Most memory that decoding one file may take: 512M, 4G [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, help_heading = INPUT)]
    pub max_bytes: Option<ByteSize>,
}

/// How a map is mended.
#[derive(Args, Debug)]
pub struct RepairArguments {
    /// Write a map of unit normals: correctly rounded; z at or below zero raised, NaN, infinity and (0, 0, 0) made flat
    #[arg(long, requires = "output", help_heading = REPAIR)]
    pub repair: bool,

    /// Repaired map: .png, .tif, .exr, .ktx2 or .dds; missing folders are made
    #[arg(short, long, value_name = "FILE", requires = "repair", help_heading = REPAIR)]
    pub output: Option<PathBuf>,

    /// Turn green around: a map read as gl is written as dx, one read as dx as gl
    #[arg(long, requires = "repair", help_heading = REPAIR)]
    pub flip_green: bool,

    /// Encoding of the repaired map [default: the input's]
    #[arg(long, value_name = "ENCODING", value_parser = choice::<Encoding>(Encoding::NAMES), requires = "repair")]
    #[arg(help_heading = REPAIR)]
    pub output_encoding: Option<Encoding>,

    /// Bits of a code of the repaired map; f is for float [default: the input's]
    #[arg(long, value_name = "BITS", value_parser = choice::<Depth>(Depth::NAMES), requires = "repair")]
    #[arg(help_heading = REPAIR)]
    pub output_bits: Option<Depth>,
}

const INPUT: &str = "Input";
const REPAIR: &str = "Repair";

/// Files that are checked at the same time; their lines come out in order.
const AT_A_TIME: usize = 64;

/// What became of one file.
type Checked = (PathBuf, Result<Findings>);

pub fn check(arguments: &CheckArguments) -> Result<Exit, Failure> {
    let (read, options) = (arguments.read.options(), CheckOptions { tiles: arguments.tiles });
    let output = arguments.repair.target(&arguments.files)?;
    let monitor = interruptible();
    let mut listed = Vec::new();
    let mut exit = Exit::Success;
    let mut last = None;
    for files in arguments.files.chunks(AT_A_TIME) {
        let check = |path: &PathBuf| (path.clone(), check_file(path, &read, &options, &monitor));
        let checked: Vec<Checked> = files.par_iter().map(check).collect();
        for file in checked.iter().filter(|(_, result)| !matches!(result, Err(Error::Cancelled))) {
            exit = exit_of(exit, file);
            tell(arguments, file, &mut listed);
        }
        if monitor.is_cancelled() {
            return Ok(Exit::Interrupted);
        }
        last = checked.into_iter().last();
    }
    if let (Some(output), Some((input, Ok(found)))) = (output, last) {
        arguments.read.refuse_misread(&input, &found)?;
        let format = match mend(&input, output, &read, &arguments.repair, &monitor) {
            Err(_) if monitor.is_cancelled() => return Ok(Exit::Interrupted),
            mended => mended?,
        };
        let read = NormalReadOptions {
            encoding: Some(format.encoding),
            channels: Some(format.channels),
            convention: format.convention,
            ..read
        };
        let mut result = check_file(output, &read, &options, &monitor);
        if monitor.is_cancelled() {
            return Ok(Exit::Interrupted);
        }
        if let Ok(repaired) = &mut result {
            repaired.add_unmendable(&found);
        }
        let repaired = (output.to_owned(), result);
        exit = exit_of(Exit::Success, &repaired);
        tell(arguments, &repaired, &mut listed);
    }
    if arguments.json {
        put(format_args!("{:#}", json!(listed)));
    }
    Ok(exit)
}

impl ReadArguments {
    fn options(&self) -> NormalReadOptions {
        let default = NormalReadOptions::default();
        NormalReadOptions {
            encoding: self.encoding,
            channels: self.channels,
            convention: self.convention.unwrap_or_default(),
            max_bytes: self.max_bytes.map_or(default.max_bytes, |ByteSize(bytes)| bytes),
        }
    }

    /// Fails if a repair would destroy a map that seems to be read wrongly, unless the user has said that it is not.
    fn refuse_misread(&self, input: &Path, found: &Findings) -> Result<()> {
        let Some(misreading) = found.census.misreading() else { return Ok(()) };
        let (is_said, otherwise) = match misreading {
            Misreading::TwoChannels => (self.channels.is_some(), "--channels xyz"),
            Misreading::UnormFloats => (self.encoding.is_some(), "--encoding float"),
        };
        if is_said {
            return Ok(());
        }
        let reason = format!("it was not repaired: {misreading}");
        let remedy = format!("{}, or with {otherwise} if it is as it should be", misreading.remedy());
        Err(Error::File { path: input.into(), reason, remedy })
    }
}

impl RepairArguments {
    /// The file to write, if one is wanted.
    fn target(&self, inputs: &[PathBuf]) -> Result<Option<&Path>, Failure> {
        let Some(output) = self.output.as_deref() else { return Ok(None) };
        let [input] = inputs else {
            return Err(Failure::Usage(format!("--repair takes one FILE, not {}", inputs.len())));
        };
        if is_same_file(input, output) {
            let reason = "--output is the input: a repair never overwrites it; choose another name";
            return Err(Failure::Usage(reason.into()));
        }
        Ok(Some(output))
    }

    /// What is written for a map of `format`.
    fn format(&self, format: NormalFormat) -> NormalFormat {
        let depth = self.output_bits.unwrap_or(format.depth);
        // Float bits mean the encoding float, and integers, if nothing else is said, unorm.
        let encoding = match format.encoding {
            _ if depth.is_float() => Encoding::Float,
            Encoding::Float => Encoding::Unorm,
            encoding => encoding,
        };
        let encoding = self.output_encoding.unwrap_or(encoding);
        let depth = match (self.output_bits, encoding) {
            (None, Encoding::Float) if !depth.is_float() => Depth::Float32,
            (None, Encoding::Unorm | Encoding::Snorm | Encoding::Biased) if depth.is_float() => Depth::Bits16,
            _ => depth,
        };
        let turned = match format.convention {
            Convention::Gl => Convention::Dx,
            Convention::Dx => Convention::Gl,
        };
        let convention = if self.flip_green { turned } else { format.convention };
        NormalFormat { encoding, depth, convention, ..format }
    }
}

/// Writes the repaired map; what its codes mean.
fn mend(
    input: &Path,
    output: &Path,
    read: &NormalReadOptions,
    options: &RepairArguments,
    monitor: &Monitor,
) -> Result<NormalFormat> {
    let open = || open_normals(input, read).map(|file| file.rows);
    let format = options.format(open()?.format());
    let create = |size| {
        create_folder_of(output)?;
        create_normals(output, size, format)
    };
    let repaired = repair(&Baker::cpu(), &open, &create, format, monitor).map_err(of_output)?;
    say(format_args!(
        "{}: repaired to {} {} {} {}; made flat: {} of NaN, infinity or beyond 65536, {} of (0, 0, 0)",
        output.display(),
        format.encoding,
        format.depth,
        format.channels,
        format.convention,
        texels(repaired.flattened),
        repaired.zero_vectors,
    ));
    Ok(format)
}

/// The error of a format with the names of the options that set it: the input's was read before.
fn of_output(error: Error) -> Error {
    match error {
        Error::Parameter { parameter: "encoding", value, range } => {
            let range = format!("{range} (see --output-bits too)");
            Error::Parameter { parameter: "output-encoding", value, range }
        }
        Error::Parameter { parameter: "bits", value, range } => {
            Error::Parameter { parameter: "output-bits", value, range }
        }
        error => error,
    }
}

/// Makes the folders above a file.
pub fn create_folder_of(file: &Path) -> Result<()> {
    let folder = file.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder).map_err(|source| Error::Io { path: folder.into(), source })
}

fn exit_of(exit: Exit, (_, result): &Checked) -> Exit {
    let is_sound = result.as_ref().is_ok_and(|findings| !findings.has_faults());
    if is_sound { exit } else { Exit::Failed }
}

/// Prints what was found, or keeps it for the JSON list.
fn tell(arguments: &CheckArguments, (path, result): &Checked, listed: &mut Vec<Value>) {
    if let Err(error) = result {
        say(format_args!("error: {error}"));
    }
    match result {
        _ if arguments.json => listed.push(json_of(path, result)),
        Ok(findings) => put(lines(path, findings)),
        Err(_) => {}
    }
}

/// One line for a map without findings, else one more for each.
fn lines(path: &Path, findings: &Findings) -> String {
    let faults = findings.list.iter().filter(|finding| finding.severity == Severity::Fault).count();
    let verdict = match faults {
        0 => "ok".into(),
        1 => "1 fault".into(),
        faults => format!("{faults} faults"),
    };
    let first = format!("{}: {verdict}", path.display());
    let indented = findings.list.iter().map(|finding| match finding.severity {
        Severity::Fault => format!("\n  {finding}"),
        Severity::Note => format!("\n  note: {finding}"),
    });
    std::iter::once(first).chain(indented).collect()
}

fn json_of(path: &Path, result: &Result<Findings>) -> Value {
    let file = path.to_string_lossy();
    let findings = match result {
        Ok(findings) => findings,
        Err(error) => return json!({ "file": file, "ok": false, "error": error.to_string() }),
    };
    let (census, format, green) = (&findings.census, findings.format, findings.green);
    let list = findings.list.iter().map(|finding| {
        json!({
            "problem": finding.problem.to_string(),
            "severity": finding.severity.to_string(),
            "texels": finding.texels,
            "share": finding.share,
            "worst": finding.worst,
            "at": finding.at.map(place),
            "what": finding.what,
            "remedy": finding.remedy,
        })
    });
    json!({
        "file": file,
        "ok": !findings.has_faults(),
        "error": null,
        "width": findings.size.width(),
        "height": findings.size.height(),
        "encoding": format.encoding.to_string(),
        "bits": format.depth.to_string(),
        "channels": format.channels.to_string(),
        "convention": format.convention.to_string(),
        "findings": list.collect::<Vec<_>>(),
        "texels": {
            "no-direction": count(census.no_direction),
            "zero-vector": count(census.zero_vectors),
            "non-unit": count(census.non_unit),
            "rounding": count(census.rounding),
            "below-zero": count(census.below_zero),
            "at-zero": count(census.at_zero),
        },
        "green": {
            "curl_gl": green.gl,
            "curl_dx": green.dx,
            "ratio": green.ratio(),
            "significance": green.significance,
            "likely": green.likely().map(|convention| convention.to_string()),
        },
    })
}

fn count(tally: Tally) -> Value {
    json!({ "count": tally.count, "first": tally.first.map(place) })
}

/// `1 texel`, `2 texels`.
pub fn texels(count: u64) -> String {
    if count == 1 { "1 texel".into() } else { format!("{count} texels") }
}

/// Column and row.
pub fn place(texel: Texel) -> Value {
    json!({ "x": texel.x, "y": texel.y })
}

/// Whether two paths lead to one file.
#[cfg(unix)]
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |path: &Path| std::fs::metadata(path).ok().map(|file| (file.dev(), file.ino()));
    identity(a).is_some_and(|a| identity(b) == Some(a))
}

/// Whether two paths lead to one file; hard links are not seen.
#[cfg(not(unix))]
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}
