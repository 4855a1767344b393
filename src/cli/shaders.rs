//! `texbake shaders`: the shader library for other engines.

use super::exit::{Exit, Failure};
use super::print::put;
use super::values::choice;
use clap::Args;
use std::path::PathBuf;
use texbake::shading::{LIBRARY, ShaderLanguage, export};

/// Write the shader library: what a scene's shaders do with the maps, in the language of any engine
#[derive(Args, Debug)]
#[command(after_help = "\
Each file has the functions of one concept, without bindings: it is included
in a shader of yours, and its first lines say what the functions take and give,
and the equation or listing of each. All of them can be included in one shader.

  decode_normal    normals from unorm, snorm, biased and two-channel samples
  tangent_frame    tangent space from a normal, a tangent and its handedness
  cotangent_frame  the same without tangents, by derivatives (Schüler)
  lighting         diffuse, two lights with ambient, Blinn-Phong
  welsh_offset     parallax mapping, with and without offset limiting (Welsh)
  plane_offset     parallax by the plane of a texel (FGED2 eq. 7.50), limited
  stepped_offset   parallax in k steps (FGED2 listing 7.9)
  relief_offset    where the ray to the eye meets the relief, by steps

wgsl   as they are
glsl   for GLSL 3.30 and later, with and without Vulkan, and GLSL ES 3.00
hlsl   for shader model 5.0 and later
msl    for the Metal Shading Language 1.2 and later
spirv  modules of SPIR-V 1.0 whose functions spirv-link finds by their names

Examples:
  texbake shaders --lang glsl -o shaders
  texbake shaders --list

Exit status: 0 all were written, 1 something failed, 2 wrong arguments.")]
pub struct ShadersArguments {
    /// The language
    #[arg(long, value_name = "LANG", default_value_t, value_parser = choice::<ShaderLanguage>(ShaderLanguage::NAMES))]
    pub lang: ShaderLanguage,

    /// The folder that the files are written into; missing folders are made, files of the same names are replaced
    #[arg(short, long, value_name = "DIR", required_unless_present = "list")]
    pub output: Option<PathBuf>,

    /// Print the files and their functions; with -o, of what is written
    #[arg(long)]
    pub list: bool,

    /// Print failures only
    #[arg(short, long, conflicts_with = "list")]
    pub quiet: bool,
}

pub fn shaders(arguments: &ShadersArguments) -> Result<Exit, Failure> {
    let ShadersArguments { lang, output, list, quiet } = arguments;
    let written = output.as_ref().map(|folder| export(folder, *lang)).transpose()?;
    if *list {
        for file in LIBRARY {
            let functions: Vec<_> = file.functions().collect();
            put(format_args!("{}: {}", file.file_name(*lang), functions.join(", ")));
        }
    } else if !quiet {
        written.into_iter().flatten().for_each(|path| put(path.display()));
    }
    Ok(Exit::Success)
}
