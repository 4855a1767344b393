//! `texbake check`: what is wrong with normal maps.

use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::values::{ByteSize, choice, value};
use clap::Args;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use texbake::inspect::{CheckOptions, Findings, Severity, Tally, Texel, check_file, repair};
use texbake::io::{NormalReadOptions, create_normals, open_normals};
use texbake::{Baker, Channels, Convention, Depth, Encoding, Error, NormalFormat, Result};

/// Tell what is wrong with normal maps, and mend it
#[derive(Args, Debug)]
#[command(after_help = "\
Faults, each with its share, the worst texel and what to do:
  no-direction  floats that are NaN, infinite or beyond 65536
  zero-vector   (0, 0, 0)
  non-unit      lengths that rounding a unit vector to the encoding cannot give
  below-zero    z below zero
  green         green seems to point the other way: slopes of heights have no curl, and these have
                much less of it with green turned around; no telling for flat maps, slopes along one
                axis and what is not made of heights
  srgb          the file says that it holds sRGB colours
  eight-bit     16 bits or floats that hold nothing but 8-bit values
  banding       8 bits, most changes being single codes between plateaus of 8 texels or more
Notes, which are no faults:
  at-zero       z of zero: as steep as the encoding can tell
  seam          the edges do not fit where the map is repeated; a fault with --tiles; maps below
                16 x 16 texels are not judged

Examples:
  texbake check wall_normal.png
  texbake check baked/*.png --tiles --json
  texbake check rock_normal.tif --encoding biased --convention dx
  texbake check resized_normal.png --repair -o repaired_normal.png

Exit status: 0 no fault, 1 a fault or a file that cannot be read, 2 wrong arguments. \
With --repair it is the repaired map that counts.")]
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
    /// How codes are read [default: unorm for unsigned integers, snorm for signed ones, float]
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

    /// Repaired map: .png, .tif or .exr
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
    let mut listed = Vec::new();
    let mut exit = Exit::Success;
    for files in arguments.files.chunks(AT_A_TIME) {
        let check = |path: &PathBuf| (path.clone(), check_file(path, &read, &options));
        let checked: Vec<Checked> = files.par_iter().map(check).collect();
        for file in &checked {
            exit = exit_of(exit, file);
            tell(arguments, file, &mut listed);
        }
    }
    if let (Some(output), [input]) = (output, &arguments.files[..]) {
        let format = match mend(input, output, &read, &arguments.repair) {
            Err(Error::Cancelled) => return Ok(Exit::Interrupted),
            mended => mended?,
        };
        let read = NormalReadOptions {
            encoding: Some(format.encoding),
            channels: Some(format.channels),
            convention: format.convention,
            ..read
        };
        let repaired = (output.to_owned(), check_file(output, &read, &options));
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
fn mend(input: &Path, output: &Path, read: &NormalReadOptions, options: &RepairArguments) -> Result<NormalFormat> {
    let open = || open_normals(input, read).map(|file| file.rows);
    let format = options.format(open()?.format());
    let create = |size| create_normals(output, size, format);
    let repaired = repair(&Baker::cpu(), &open, &create, format, &interruptible())?;
    say(format_args!(
        "{}: repaired to {} {} {} {}; texels without direction made flat: {}",
        output.display(),
        format.encoding,
        format.depth,
        format.channels,
        format.convention,
        repaired.flattened
    ));
    Ok(format)
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
