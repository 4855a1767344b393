//! The command line.

use super::resources::Resources;
use super::settings::{CodeChoice, Device, FileOutput, HeightInput, Mips, NormalOutput, Settings, Slope, Tiles};
use super::values::{ByteSize, MapChoice, WeightPair, choice, count, iterations, value};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::num::{NonZeroU32, NonZeroUsize};
use std::path::{Path, PathBuf};
use texbake::batch::{NameTemplate, OUTPUT_EXTENSIONS};
use texbake::io::Channel;
use texbake::{Channels, Convention, Depth, Encoding, Precision, Rational};

/// Bakes height maps into normal and parallax maps, blends normal maps, and computes tangents for meshes: the same
/// bytes on every CPU and GPU
#[derive(Parser, Debug)]
#[command(name = "texbake", version, arg_required_else_help = true, max_term_width = 110)]
#[command(after_help = "\
Examples:
  texbake bake textures --out baked --maps normal,parallax
  texbake normal height.png -o normal.png --scale 24
  texbake parallax height.png -o parallax.png --scale 24 --json
  texbake plan scene.toml -o texbake.toml --explain
  texbake blend base_normal.png detail_normal.png -o normal.png --tile
  texbake tangents model.glb -o model_t.glb
  texbake preview height.png -o sheet.png --scale 24
  texbake devices
  texbake verify
  texbake shaders --lang glsl -o shaders

Exit status: 0 all went well, 1 something failed, 2 wrong arguments or
settings, 130 interrupted.")]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    Normal(Box<NormalArguments>),
    Parallax(Box<ParallaxArguments>),
    Bake(Box<BakeArguments>),
    Plan(Box<super::plan::PlanArguments>),
    Blend(Box<BlendArguments>),
    Tangents(Box<super::tangents::TangentsArguments>),
    Check(Box<super::check::CheckArguments>),
    Diff(Box<super::diff::DiffArguments>),
    Preview(Box<super::preview::PreviewArguments>),
    Devices(DevicesArguments),
    Verify(Box<super::verify::VerifyArguments>),
    Measure(Box<super::measure::MeasureArguments>),
    Shaders(super::shaders::ShadersArguments),
}

/// Bake one height map into a normal map
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  texbake normal height.png -o normal.png --scale 24
  texbake normal dem.tif -o normal.exr --scale 3.5 --edge clamp
  texbake normal wall.png -o normal.png --filter scharr --convention dx
  texbake normal wall.png -o normal.png --size 2.0x2.0 --depth 0.1 --bits 16
  texbake normal m.tif -o n.png --size 90000x90000 --depth 65535 --edge clamp
  texbake normal terrain.raw --raw 1025x1025:u16le -o n.tif --edge clamp
  texbake normal wall.png -o normal.ktx2 --block-compression bc5 --mips
  texbake normal wall.png -o n.dds --mips --roughness r.dds")]
pub struct NormalArguments {
    /// Height map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or any file with --raw
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Normal map: .png, .tif, .exr, .ktx2 or .dds; missing folders are made
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Roughness map of the mip levels, .ktx2 or .dds, with --mips: what averaging removes of the slopes makes a level
    /// rougher; the largest level has the base roughness
    #[arg(long, value_name = "FILE", help_heading = "Mip levels")]
    pub roughness: Option<PathBuf>,

    #[command(flatten)]
    pub settings: Settings,

    #[command(flatten)]
    pub resources: Resources,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// Bake one height map into a parallax map, n_z (2h - 1)
#[derive(Args, Debug)]
#[command(after_help = "\
A PNG has no signed numbers: it holds biased codes, of which 128 (or 32768) is
exactly zero, and v = (code - 128) / 127. EXR holds floats, the others snorm
codes.
In the unorm codes of a given normal map 128 (or 32768) reads as exactly 0.

What a shader needs goes into --json and --report: for each axis
u = s / (2 k r) (FGED2 eq. 7.52), with the scale s in texels, k iterations and
r texels of the map; and, to use the height map itself, Welsh's scale s / r
and bias -s / (2 r). Welsh's text has the bias s / 2; the minus of his
programs is right: a height of 1/2 must move nothing.

Examples:
  texbake parallax height.png -o parallax.png --scale 24
  texbake parallax height.png -o parallax.png --scale 24 --iterations 4 --json
  texbake parallax height.png -o p.tif --scale 24 --bits 16 --normal n.png")]
pub struct ParallaxArguments {
    /// Height map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP, or any file with --raw
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,

    /// Parallax map: .png, .tif, .exr, .ktx2 or .dds; missing folders are made
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    #[command(flatten)]
    pub slope: Slope,

    /// How a value becomes a code [default: biased in PNG, snorm in TIFF, KTX2 and DDS, float in EXR files]
    #[arg(long, value_parser = choice::<Encoding>(Encoding::NAMES), help_heading = PARALLAX_MAP)]
    pub encoding: Option<Encoding>,

    /// Bits of a code; f is for float [default: 32f in EXR files, else 8]
    #[arg(long, value_parser = choice::<Depth>(Depth::NAMES), help_heading = PARALLAX_MAP)]
    pub bits: Option<Depth>,

    /// Write what a shader needs beside the output, under its name with the extension json; no file but one of these is
    /// replaced
    #[arg(long, help_heading = PARALLAX_MAP)]
    pub json: bool,

    /// Steps towards the eye that a shader takes, for the numbers in --json and --report
    #[arg(long, value_name = "K", default_value = "4", value_parser = iterations, help_heading = PARALLAX_MAP)]
    pub iterations: NonZeroU32,

    /// Normal map of the same size that gives n_z, instead of the heights' slopes; --scale is then for the numbers in
    /// --json and --report
    #[arg(long, value_name = "FILE", conflicts_with_all = ["filter", "edge", "neighbours"], help_heading = GIVEN_NORMALS)]
    pub normal: Option<PathBuf>,

    /// How its codes are read [default: unorm; snorm for signed integers, float for floats]
    #[arg(long, value_name = "ENCODING", value_parser = choice::<Encoding>(Encoding::NAMES), requires = "normal")]
    #[arg(help_heading = GIVEN_NORMALS)]
    pub normal_encoding: Option<Encoding>,

    /// Its components [default: as the file has them]
    #[arg(long, value_name = "CHANNELS", value_parser = choice::<Channels>(Channels::NAMES), requires = "normal")]
    #[arg(help_heading = GIVEN_NORMALS)]
    pub normal_channels: Option<Channels>,

    #[command(flatten)]
    pub mips: Mips,

    #[command(flatten)]
    pub file: FileOutput,

    #[command(flatten)]
    pub heights: HeightInput,

    #[command(flatten)]
    pub tiles: Tiles,

    #[command(flatten)]
    pub device: Device,

    #[command(flatten)]
    pub resources: Resources,

    #[command(flatten)]
    pub reporting: Reporting,
}

const PARALLAX_MAP: &str = "Parallax map";
const GIVEN_NORMALS: &str = "Given normal map";

impl ParallaxArguments {
    /// What was set of the parallax map's codes.
    pub fn codes(&self) -> CodeChoice {
        CodeChoice { encoding: self.encoding, bits: self.bits }
    }
}

/// Bake folders of height maps into a folder of normal maps, parallax maps, or both in one pass
#[derive(Args, Debug)]
#[command(after_help = "\
Folders are searched for files such as wall_height.png, wall_disp_2k.exr or
Wall_Displacement.tif; files are taken as they are. In --out,
tex/brick/wall_height_2k.png becomes brick/wall_normal_2k.png.

With --neighbours every file that has the name of a tile is found too, with any
extension: dem/tile_0_0.png becomes tile_0_0_normal.png. Height maps with other
names are maps of their own; a file that is named must be a tile.

Each setting comes from the command line, else from the last [[override]] in
texbake.toml that has it and whose glob matches the file's path below the
folder, else from [defaults]. A --format on the command line also takes the
place of bits, encodings and blocks in texbake.toml that it cannot hold. A key
is the name of an option:

  suffix = [\"_height\", \"_dem\"]
  [defaults]
  scale = 24
  maps = [\"normal\", \"parallax\"]
  [[override]]
  glob = \"**/dem_*\"
  edge = \"clamp\"
  maps = \"normal\"

What a shader needs to know of a parallax map goes into the --report; see
texbake parallax --help.

What was baked is remembered in --out, in the file .texbake-baked: options, and
BLAKE3 hashes of inputs and outputs. A map is not baked again while all of that
is as it was; after a kill a run goes on where it stopped. Delete the file, or
use --force, to bake all.

--watch ends with 130 when it is interrupted (Ctrl-C), with 2 if the settings
are wrong at the start, and says what fails meanwhile. Its --report is that of
the last round. Where folders send no word of changes, as over some networks,
run texbake bake again instead.

texbake plan writes a texbake.toml of what a scene needs, with predictions of
what its maps are off by. --check-plan reads the maps that were baked, measures
them again, and ends with 1 if a prediction is broken; --check-plan=only bakes
nothing.

Examples:
  texbake bake textures --out baked
  texbake bake textures --out baked --maps normal,parallax --scale 24
  texbake bake textures --out baked --scale 24 --dry-run
  texbake bake textures --out baked --watch
  texbake bake textures --out baked --convention dx --format tif --bits 16
  texbake bake textures --out baked --format dds --block-compression bc7
  texbake bake textures --out b --format ktx2 --mips --maps normal,roughness
  texbake bake dem --out b --neighbours 'tile_{x}_{y}.png' --edge clamp
  texbake bake dem_1.tif dem_2.tif --out baked --edge clamp --report r.json")]
pub struct BakeArguments {
    /// Folders to search, and files
    #[arg(required = true, value_name = "PATH")]
    pub paths: Vec<PathBuf>,

    /// Folder for the maps; it is made if it is missing
    #[arg(short, long, value_name = "FOLDER")]
    pub out: PathBuf,

    /// End of a height map's name, in any case, instead of the usual ones; may be repeated
    /// [default: _height _h _disp _displacement _bump _heightmap]
    #[arg(long, value_name = "TEXT", help_heading = "Files")]
    pub suffix: Vec<String>,

    /// Settings file [default: texbake.toml in the first folder, else in the current one]
    #[arg(long, value_name = "FILE", help_heading = "Files")]
    pub config: Option<PathBuf>,

    /// Measure the maps against the predictions of texbake plan, after the bake, or only those that are there
    #[arg(long, value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "after")]
    #[arg(value_name = "WHEN", help_heading = "Files")]
    pub check_plan: Option<CheckPlan>,

    /// Bake all files, those too whose maps are what they would be
    #[arg(long, help_heading = "What is baked")]
    pub force: bool,

    /// Say what would be baked, and why; nothing is written but a --report
    #[arg(long, help_heading = "What is baked", conflicts_with_all = ["watch", "check_plan"])]
    pub dry_run: bool,

    /// Go on: bake again when a height map or texbake.toml is saved, or a height map appears, until interrupted
    #[arg(long, help_heading = "What is baked", conflicts_with = "check_plan")]
    pub watch: bool,

    /// Files baked at the same time, each with its own rows in memory [default: one more than the cores]
    #[arg(short, long, value_name = "N", value_parser = count, allow_hyphen_values = true)]
    #[arg(help_heading = "Where it runs")]
    pub jobs: Option<NonZeroUsize>,

    /// Steps towards the eye that a shader takes through a parallax map, for the numbers in --report
    #[arg(long, value_name = "K", default_value = "4", value_parser = iterations, help_heading = PARALLAX_MAP)]
    pub iterations: NonZeroU32,

    #[command(flatten)]
    pub each: PerFile,

    #[command(flatten)]
    pub resources: Resources,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// When the predictions of a plan are checked.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckPlan {
    /// After the bake.
    After,
    /// Nothing is baked.
    Only,
}

/// What may differ from file to file in a folder.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct PerFile {
    /// Maps to bake: normal, parallax or normal,parallax, with roughness for that of mip levels, as normal,roughness; none leaves
    /// the file out [default: normal]
    #[arg(long, value_delimiter = ',', value_parser = choice::<MapChoice>(MapChoice::NAMES), help_heading = "Files")]
    #[arg(hide_possible_values = true)]
    pub maps: Option<Vec<MapChoice>>,

    /// Output names; {stem} is the input's without suffix, {map} is normal, parallax or roughness, {size} the input's _2k or
    /// nothing [default: {stem}_{map}{size}]
    #[arg(long, value_name = "TEMPLATE", value_parser = value::<NameTemplate>, help_heading = "Files")]
    pub name: Option<NameTemplate>,

    /// Format of the outputs [default: png]
    #[arg(long, value_parser = OUTPUT_EXTENSIONS, help_heading = "Files")]
    pub format: Option<String>,

    /// How a value of a parallax map becomes a code [default: biased in PNG (128 is zero), float in EXR, else
    /// snorm]
    #[arg(long, value_name = "ENCODING", value_parser = choice::<Encoding>(Encoding::NAMES))]
    #[arg(help_heading = PARALLAX_MAP)]
    pub parallax_encoding: Option<Encoding>,

    /// Bits of a code of a parallax map [default: 32f in EXR files, else 8]
    #[arg(long, value_name = "BITS", value_parser = choice::<Depth>(Depth::NAMES), help_heading = PARALLAX_MAP)]
    pub parallax_bits: Option<Depth>,

    #[command(flatten)]
    pub settings: Settings,
}

impl PerFile {
    /// These settings, and those of `weaker` where these say nothing; a format here leaves no encoding, bits and blocks
    /// from there that it cannot hold.
    pub fn or(self, weaker: &Self) -> Self {
        let weaker = &match &self.format {
            Some(format) => weaker.held_by(format),
            None => weaker.clone(),
        };
        let CodeChoice { encoding, bits } = self.parallax().or(weaker.parallax());
        Self {
            maps: self.maps.or_else(|| weaker.maps.clone()),
            name: self.name.or_else(|| weaker.name.clone()),
            format: self.format.or_else(|| weaker.format.clone()),
            parallax_encoding: encoding,
            parallax_bits: bits,
            settings: self.settings.or(&weaker.settings),
        }
    }

    /// These settings without what files of this format cannot hold.
    fn held_by(&self, format: &str) -> Self {
        let output = Path::new("map").with_extension(format);
        let CodeChoice { encoding, bits } = self.parallax().held_by(&output);
        let normal = self.settings.normal.held_by(&output);
        let file = self.settings.file.held_by(&output);
        let mips = self.settings.mips.held_by(&output);
        let settings = Settings { normal, file, mips, ..self.settings.clone() };
        Self { parallax_encoding: encoding, parallax_bits: bits, settings, ..self.clone() }
    }

    /// What was set of a parallax map's codes.
    pub fn parallax(&self) -> CodeChoice {
        CodeChoice { encoding: self.parallax_encoding, bits: self.parallax_bits }
    }
}

/// Blend two normal maps into one
#[derive(Args, Debug)]
#[command(after_help = "\
Methods, from the normals (x1, y1, z1) and (x2, y2, z2); then normalised:
  weighted            (a x1/z1 + b x2/z2, a y1/z1 + b y2/z2, 1), FGED2
                      eq. 7.46: as if the height maps were added with weights
                      a and b; a negative weight takes bumps away
  add                 the same with a = b = 1, FGED2 eq. 7.47
  partial-derivative  the same, a = b = 1 unless given; the name is from
                      Blending in Detail
  linear              (x1 + x2, y1 + y2, z1 + z2)
  overlay             v1 + v2 (1 - |v1|) for each component v
  udn                 (x1 + x2, y1 + y2, z1)
  whiteout            (x1 + x2, y1 + y2, z1 z2)
  rnm                 the second normal turned as the first is from (0, 0, 1)
The last five are approximations, to compare with (Hill and Barré-Brisebois,
Blending in Detail).

In unorm codes 128 (or 32768) reads as exactly 0, so that a flat map changes
nothing. Where z is not above zero it counts as the least above zero; such
texels are counted and reported.

Examples:
  texbake blend base_normal.png detail_normal.png -o normal.png --tile
  texbake blend a.png b.png -o out.png --weights 1,-0.5   (half of b away)
  texbake blend a.png b.png -o out.png --transition 0.25
  texbake blend a.png b.png -o out.png --mask mask.png
  texbake blend a.png dx.tif -o out.tif --detail-convention dx
  texbake blend a.png b.png -o out.png --method rnm")]
pub struct BlendArguments {
    /// First normal map: PNG, TIFF, EXR, TGA, BMP, JPEG, WebP; the result has its size
    #[arg(value_name = "BASE")]
    pub base: PathBuf,

    /// Second normal map, of the same size, or of any with --tile
    #[arg(value_name = "DETAIL")]
    pub detail: PathBuf,

    /// Blended normal map: .png, .tif, .exr, .ktx2 or .dds; missing folders are made
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    #[command(flatten)]
    pub formula: Formula,

    #[command(flatten)]
    pub inputs: BlendInputArguments,

    #[command(flatten)]
    pub normal: NormalOutput,

    #[command(flatten)]
    pub file: FileOutput,

    #[command(flatten)]
    pub device: Device,

    #[command(flatten)]
    pub resources: Resources,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// How two normals become one.
#[derive(Args, Debug)]
pub struct Formula {
    /// Formula; see below [default: add, or weighted with --weights, --transition or --mask]
    #[arg(long, value_enum, help_heading = BLEND)]
    pub method: Option<Method>,

    /// Weights a of BASE and b of DETAIL, each between -65535 and 65535: 1,-0.5
    #[arg(long, value_name = "A,B", value_parser = value::<WeightPair>, allow_hyphen_values = true)]
    #[arg(help_heading = BLEND, conflicts_with_all = ["transition", "mask"])]
    pub weights: Option<WeightPair>,

    /// Weights a = 1 - T and b = T: from BASE at 0 to DETAIL at 1
    #[arg(long, value_name = "T", value_parser = value::<Rational>, allow_hyphen_values = true)]
    #[arg(help_heading = BLEND, conflicts_with = "mask")]
    pub transition: Option<Rational>,

    /// Transition of each texel, black for BASE and white for DETAIL: an image of BASE's size
    #[arg(long, value_name = "FILE", help_heading = BLEND)]
    pub mask: Option<PathBuf>,

    /// Channel that holds the mask: r, g, b, a, luma, or the name of an EXR channel; needed if they differ
    #[arg(long, value_name = "CHANNEL", requires = "mask", help_heading = BLEND)]
    pub mask_channel: Option<Channel>,

    /// Repeat DETAIL over a larger BASE, from its first texel on
    #[arg(long, help_heading = BLEND)]
    pub tile: bool,

    /// exact: the same bytes everywhere, and correctly rounded for 8- and 16-bit maps; floats are computed as IEEE f32 in
    /// a fixed order. fast: native floats [default: exact]
    #[arg(long, value_parser = choice::<Precision>(Precision::NAMES), help_heading = BLEND)]
    pub precision: Option<Precision>,
}

/// How the normal maps of a blend are read.
#[derive(Args, Debug)]
pub struct BlendInputArguments {
    /// How BASE's codes are read [default: unorm; snorm for signed integers, float for floats]
    #[arg(long, value_name = "ENCODING", value_parser = choice::<Encoding>(Encoding::NAMES))]
    #[arg(help_heading = INPUTS)]
    pub base_encoding: Option<Encoding>,

    /// BASE's components; z of xy is rebuilt [default: as the file has them]
    #[arg(long, value_name = "CHANNELS", value_parser = choice::<Channels>(Channels::NAMES), help_heading = INPUTS)]
    pub base_channels: Option<Channels>,

    /// BASE's green: up (gl) or down (dx) [default: gl]
    #[arg(long, value_name = "CONVENTION", value_parser = choice::<Convention>(Convention::NAMES))]
    #[arg(help_heading = INPUTS)]
    pub base_convention: Option<Convention>,

    /// How DETAIL's codes are read [default: unorm; snorm for signed integers, float for floats]
    #[arg(long, value_name = "ENCODING", value_parser = choice::<Encoding>(Encoding::NAMES))]
    #[arg(help_heading = INPUTS)]
    pub detail_encoding: Option<Encoding>,

    /// DETAIL's components; z of xy is rebuilt [default: as the file has them]
    #[arg(long, value_name = "CHANNELS", value_parser = choice::<Channels>(Channels::NAMES), help_heading = INPUTS)]
    pub detail_channels: Option<Channels>,

    /// DETAIL's green: up (gl) or down (dx) [default: gl]
    #[arg(long, value_name = "CONVENTION", value_parser = choice::<Convention>(Convention::NAMES))]
    #[arg(help_heading = INPUTS)]
    pub detail_convention: Option<Convention>,

    /// Most memory that decoding one file may take: 512M, 4G [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, help_heading = INPUTS)]
    pub max_bytes: Option<ByteSize>,
}

const BLEND: &str = "Blend";
const INPUTS: &str = "Normal maps that are blended";

/// The formulas, by the names of the command line.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Add,
    Weighted,
    PartialDerivative,
    Linear,
    Overlay,
    Udn,
    Whiteout,
    Rnm,
}

/// What is said about a run.
#[derive(Args, Debug)]
pub struct Reporting {
    /// Write what was done, file by file, as JSON; after a mistake in the command line itself an older one stays
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
