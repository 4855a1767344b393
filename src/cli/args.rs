//! The command line.

use super::settings::Settings;
use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use texbake::batch::{NameTemplate, OUTPUT_EXTENSIONS};

/// Bakes height maps into normal maps, with the same bytes on every CPU and GPU
#[derive(Parser, Debug)]
#[command(name = "texbake", version, arg_required_else_help = true, max_term_width = 110)]
#[command(after_help = "\
Examples:
  texbake bake textures --out baked
  texbake normal height.png -o normal.png --scale 24
  texbake devices

Exit status: 0 all went well, 1 something failed, 2 wrong arguments or settings, 130 interrupted.")]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    Normal(Box<NormalArguments>),
    Bake(Box<BakeArguments>),
    Check(Box<super::check::CheckArguments>),
    Diff(Box<super::diff::DiffArguments>),
    Devices(DevicesArguments),
}

/// Bake one height map into a normal map
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  texbake normal height.png -o normal.png --scale 24
  texbake normal dem.tif -o normal.exr --scale 3.5 --edge clamp --filter scharr --convention dx
  texbake normal wall.png -o normal.png --size 2.0x2.0 --depth 0.1 --bits 16
  texbake normal srtm.tif -o normal.png --size 108000x108000 --depth 65535 --edge clamp   (16 bits, metres)
  texbake normal terrain.raw --raw 1025x1025:u16le -o normal.tif --edge clamp")]
pub struct NormalArguments {
    /// Height map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or any file with --raw
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Normal map: .png, .tif or .exr; missing folders are made
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    #[command(flatten)]
    pub settings: Settings,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// Bake folders of height maps into a folder of normal maps
#[derive(Args, Debug)]
#[command(after_help = "\
Folders are searched for files such as wall_height.png, wall_disp_2k.exr or Wall_Displacement.tif;
files are taken as they are. tex/brick/wall_height_2k.png becomes brick/wall_normal_2k.png in --out.

Each setting comes from the command line, else from the last [[override]] in texbake.toml that has it
and whose glob matches the file's path below the folder, else from [defaults]. A key is an option's name:

  suffix = [\"_height\", \"_dem\"]
  [defaults]
  scale = 24
  [[override]]
  glob = \"**/dem_*\"
  edge = \"clamp\"

Examples:
  texbake bake textures --out baked
  texbake bake textures --out baked --scale 24 --convention dx --format tif --bits 16
  texbake bake dem_1.tif dem_2.tif --out baked --edge clamp --report report.json")]
pub struct BakeArguments {
    /// Folders to search, and files
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,

    /// Folder for the normal maps; it is made if it is missing
    #[arg(short, long, value_name = "FOLDER")]
    pub out: PathBuf,

    /// End of a height map's name, in any case; may be repeated
    /// [default: _height _h _disp _displacement _bump _heightmap]
    #[arg(long, value_name = "TEXT", help_heading = "Files")]
    pub suffix: Vec<String>,

    /// Settings file [default: texbake.toml in the first folder, else in the current one]
    #[arg(long, value_name = "FILE", help_heading = "Files")]
    pub config: Option<PathBuf>,

    /// Files baked at the same time, each with its own rows in memory [default: one more than the cores]
    #[arg(short, long, value_name = "N", help_heading = "Where it runs")]
    pub jobs: Option<NonZeroUsize>,

    #[command(flatten)]
    pub each: PerFile,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// What may differ from file to file in a folder.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct PerFile {
    /// Output names; {stem} is the input's without suffix, {size} its _2k or nothing [default: {stem}_normal{size}]
    #[arg(long, value_name = "TEMPLATE", value_parser = super::values::value::<NameTemplate>, help_heading = "Files")]
    pub name: Option<NameTemplate>,

    /// Format of the outputs [default: png]
    #[arg(long, value_parser = OUTPUT_EXTENSIONS, help_heading = "Files")]
    pub format: Option<String>,

    #[command(flatten)]
    pub settings: Settings,
}

impl PerFile {
    /// These settings, and those of `weaker` where these say nothing.
    pub fn or(self, weaker: &Self) -> Self {
        Self {
            name: self.name.or_else(|| weaker.name.clone()),
            format: self.format.or_else(|| weaker.format.clone()),
            settings: self.settings.or(&weaker.settings),
        }
    }
}

/// What is said about a run.
#[derive(Args, Debug)]
pub struct Reporting {
    /// Write what was done, file by file, as JSON
    #[arg(long, value_name = "FILE", help_heading = "Reporting")]
    pub report: Option<PathBuf>,

    /// Print errors only
    #[arg(short, long, help_heading = "Reporting")]
    pub quiet: bool,
}

/// List what could run bakes: each device, its self-test, and whether `auto` picks it and why
#[derive(Args, Debug)]
pub struct DevicesArguments {
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}
