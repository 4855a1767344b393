//! `texbake plan`: what a scene needs, measured on its maps.

use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{put, say};
use super::settings::{Device, open_baker};
use clap::Args;
use std::path::PathBuf;
use texbake::Error;
use texbake::plan::{Plan, Scene, check_place};

/// Choose the cheapest maps that a scene needs, and write them as settings of texbake bake
#[derive(Args, Debug)]
#[command(after_help = "\
A scene file says which height maps there are, how they are seen, and what may
go wrong:

  folder = \"textures\"         # of the height maps, the one that bake is given,
                              # from the scene file on [default: beside it]
  suffix = [\"_height\"]        # [default: as texbake bake]

  [view]                      # of all materials that have no view of their own
  distance = 1.5              # nearest, straight from above, in the unit of size
  fov = 60                    # vertical field of view in degrees
  resolution = [1920, 1080]   # of the screen in pixels
  angle = 20                  # shallowest, between surface and eye, 1 to 90 degrees

  [tolerance]
  normal = 1.0                # largest error of a normal in degrees
  parallax-99 = 1.0           # error of an offset in pixels, in 99 of 100 of them;
                              # or parallax, in all: where relief hides relief no
                              # shader finds the same edge, so that is for gentle
                              # hills
  bytes-per-texel = 4         # of all maps, if bounded, over texels of the file
  milliseconds = 2            # of parallax for a full screen, if bounded, on all
                              # threads of this CPU

  [[material]]
  files = \"walls/*\"           # a glob, or several, as in [[override]]
  size = [2.0, 2.0]           # what the map covers, and
  depth = 0.1                 # the height of white in the same unit

  [[material]]                # of two for the same file the last one counts
  files = [\"cloth/*\", \"dem_*\"]
  scale = 8                   # or the height of white in texels
  view = { texels-per-pixel = 0.5 }   # along a pixel's side, instead of a
                              # distance, for which a material with a scale
                              # needs its size too
  tolerance = { normal = 0.3 }
  edge = \"clamp\"              # filter, edge, convention, channel, color-space,
                              # raw: as texbake bake
  format = \"tif\"              # of the maps [default: png]
  model = \"wall.glb\"          # on which tangents are measured

What is chosen, on the maps as they would be baked, fewest bytes first: which
maps at all, how far they are reduced (no texel covers less than a pixel at the
nearest view), bits, encoding and channels, exact or fast, the parallax method
and its steps, tangents or a cotangent frame. The largest error counts: of
normals in every texel, of offsets in 8192 pixels, each from its own side, at
each of four angles from the shallowest up. steps 4 is FGED2 listing 7.9 with
k = 4; relief 16+5 marches 16 steps down the ray and halves the last one 5 times.

bake --check-plan measures what was baked in the same way. It fails if an error
is larger than what was predicted, a size another, a texel of a parallax map
farther off, or a setting not the plan's; better than predicted is no failure.
Which of exact and fast is taken depends on how long each takes here, so that
another machine may plan another one; milliseconds are never checked.

Examples:
  texbake plan scene.toml -o texbake.toml --explain
  texbake plan examples/scene.toml -o plan.toml
  texbake bake examples/textures --config plan.toml --out baked --check-plan

Exit status: 0 written, 1 a tolerance that cannot be met, or a file that cannot
be read or written, 2 wrong arguments or a wrong scene, 130 interrupted.")]
pub struct PlanArguments {
    /// Scene file: materials, views, tolerances; see below
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,

    /// Settings file to write; one that texbake plan did not write is not replaced
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Print each choice with its reason, what was measured, and what was rejected
    #[arg(long)]
    pub explain: bool,

    /// Replace the output whatever it is
    #[arg(long)]
    pub force: bool,

    #[command(flatten)]
    pub device: Device,

    /// Print failures only
    #[arg(short, long)]
    pub quiet: bool,
}

pub fn plan(arguments: &PlanArguments) -> Result<Exit, Failure> {
    check_place(&arguments.output, arguments.force)?;
    let scene = Scene::read(&arguments.scene).map_err(Failure::settings)?;
    let baker = open_baker(&arguments.device.place()?)?;
    let monitor = interruptible();
    let mut watch = |path: &std::path::Path| {
        if !arguments.quiet {
            say(format_args!("measuring {}", path.display()));
        }
    };
    let plan = match Plan::new(&scene, &baker, &monitor, &mut watch) {
        Err(Error::Cancelled) => {
            say("interrupted: no plan was written");
            return Ok(Exit::Interrupted);
        }
        plan => plan?,
    };
    if arguments.explain {
        plan.files.iter().for_each(|file| put(file.explanation()));
    }
    plan.write(&arguments.output, arguments.force)?;
    if !arguments.quiet {
        for file in &plan.left_out {
            say(format_args!("{}: the scene does not show it, so it gets no map", file.display()));
        }
        say(format_args!(
            "{}: {} planned; texbake bake {} --config {} --out FOLDER --check-plan",
            arguments.output.display(),
            match plan.files.len() {
                1 => "1 height map".to_owned(),
                count => format!("{count} height maps"),
            },
            plan.folder.display(),
            arguments.output.display(),
        ));
    }
    Ok(Exit::Success)
}
