//! `texbake tangents`: the meshes of a model.

use super::args::Reporting;
use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{say, tangents_line};
use super::progress::fallback;
use super::settings::{Device, max_bytes, open_baker};
use super::values::{ByteSize, choice, degrees, value};
use clap::Args;
use std::path::{Path, PathBuf, is_separator};
use std::sync::Arc;
use texbake::batch::{FileResult, JsonFile, ModelTangentsReport, TangentJob};
use texbake::io::ModelReadOptions;
use texbake::{Convention, MissingNormals, Precision, TangentMethod, TangentOptions};

/// Compute tangents for the meshes of a model, glTF or OBJ, and write it as glTF
#[derive(Args, Debug)]
#[command(after_help = "\
Methods, from each triangle's edges e in space and (x, y) in the texture:
  mikktspace  what glTF and every engine expect, and what normal maps are
              baked with: the result of Mikkelsen's reference implementation.
              Vertices whose triangles do not belong together are split
  lengyel     the sum of (e1 y2 - e2 y1) / (x1 y2 - x2 y1), FGED2 eq. 7.37 and
              listing 7.4. Vertices between mirrored halves are split
  hegde       the average of unit edges along growing u (Messing with Tangent
              Space). Vertices between mirrored halves are split

A tangent has four components; the shader rebuilds the bitangent as
w (n x t) (FGED2 eq. 7.40). In glTF the texture's v grows down the image and
green points up it, so with --convention gl the bitangent points against v.

A vertex without a direction (its triangles have no area in the texture, or
their tangents cancel) gets any tangent at a right angle to its normal; such
vertices are counted and reported.

Primitives get tangents if their material has a normal map: its own, or else
that of its clearcoat or its anisotropy, or else one of its variants'
(KHR_materials_variants). KHR_texture_transform is applied. With --all every
primitive with texture coordinates gets them; without, a model that has no
normal map is written as it was, with a warning, and the exit status is 0.
Draco and meshopt compression are refused: write the model without it first.

The output is .glb or .gltf, by its name; from scan.obj a folder gets scan.glb.
Beside model.gltf lies its buffer: model.bin if it was made of .glb or .obj,
else model_tangents.bin with what is new. In another folder, the files that
the model refers to are copied beside it; a .glb made of .gltf or .obj holds
its images. What changes in a glTF file: TANGENT;
NORMAL where it was missing or repaired; where vertices are split, copies in
all attributes, and indices of 16 or 32 bits; strips and fans then become
triangles. Tangents of morph targets are dropped. Old bytes may stay in the
buffer. The faces of an OBJ become triangles first.

One model at a time; several in a shell:
for model in *.glb; do texbake tangents \"$model\" -o out/; done

Examples:
  texbake tangents model.glb -o model_t.glb
  texbake tangents model.gltf -o out/ --method mikktspace --backend auto
  texbake tangents scan.obj -o scan.glb --normals smooth --method lengyel
  texbake tangents pipe.glb -o pipe_t.glb --all --unwrap --weld-seams 30")]
pub struct TangentsArguments {
    /// Model: .glb, .gltf or .obj
    #[arg(value_name = "MODEL")]
    pub input: PathBuf,

    /// Model with tangents: .glb or .gltf, missing folders are made; or a folder, one that exists or whose name ends in
    /// /, for a file of the same name (.glb if the model is .obj)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    #[command(flatten)]
    pub formula: Formula,

    #[command(flatten)]
    pub meshes: Meshes,

    #[command(flatten)]
    pub device: Device,

    #[command(flatten)]
    pub reporting: Reporting,
}

/// What is computed for a mesh.
#[derive(Args, Debug)]
pub struct Formula {
    /// Formula; see below [default: mikktspace]
    #[arg(long, value_parser = choice::<TangentMethod>(TangentMethod::NAMES), help_heading = TANGENTS)]
    pub method: Option<TangentMethod>,

    /// Green of the normal maps: up (gl) or down (dx); the bitangent points where green does [default: gl]
    #[arg(long, value_parser = choice::<Convention>(Convention::NAMES), help_heading = TANGENTS)]
    pub convention: Option<Convention>,

    /// exact: IEEE f32 in a fixed order, the same bytes on every CPU and GPU. fast: native floats [default: exact]
    #[arg(long, value_parser = choice::<Precision>(Precision::NAMES), help_heading = TANGENTS)]
    pub precision: Option<Precision>,

    /// Take u that spans more than half of the texture in a triangle, and no more than all of it, to have jumped from 1
    /// to 0, as around a cylinder without a seam; not for meshes of which a triangle rightly spans that much
    #[arg(long, help_heading = TANGENTS)]
    pub unwrap: bool,

    /// Make tangents equal that are at most ANGLE degrees apart, from 0 to 90, of vertices of one primitive with the
    /// very same position and normal, to the bit, and the same handedness
    #[arg(long, value_name = "ANGLE", value_parser = degrees, allow_hyphen_values = true, help_heading = TANGENTS)]
    pub weld_seams: Option<f32>,

    /// Also write the bitangents, as the attribute _BITANGENT; no reader needs them
    #[arg(long, help_heading = TANGENTS)]
    pub bitangent: bool,
}

/// Which meshes are taken, and how.
#[derive(Args, Debug)]
pub struct Meshes {
    /// Normals of a mesh that has none: flat, each triangle's own, as glTF prescribes, or smooth [default: flat]
    #[arg(long, value_parser = choice::<MissingNormals>(MissingNormals::NAMES), help_heading = MESHES)]
    pub normals: Option<MissingNormals>,

    /// Also take primitives of glTF whose material has no normal map, for their first texture coordinates
    #[arg(long, help_heading = MESHES)]
    pub all: bool,

    /// Most memory that reading the model may take: 512M, 4G [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, help_heading = MESHES)]
    pub max_bytes: Option<ByteSize>,
}

const TANGENTS: &str = "Tangents";
const MESHES: &str = "Meshes";

pub fn tangents(arguments: &TangentsArguments) -> Result<Exit, Failure> {
    let reporting = &arguments.reporting;
    let job = job(arguments)?;
    let files = job.files();
    let report_file = reporting.report.as_deref();
    let report_file = report_file.map(|path| JsonFile::create("report", path, std::slice::from_ref(&files), None));
    let report_file = report_file.transpose()?;

    let outcome = job.run(&interruptible());
    job.failure(&outcome).iter().for_each(|reason| say(format_args!("error: {reason}")));
    if !reporting.quiet {
        let ran = outcome.result.as_ref().ok().and_then(|model| model.ran.as_ref());
        let warnings = outcome.warnings.iter().cloned().chain(ran.and_then(fallback));
        warnings.for_each(|text| say(format_args!("warning: {text}")));
        tangents_line(&job, &outcome).iter().for_each(say);
    }
    if let Some(file) = report_file {
        file.write(&ModelTangentsReport::new(&job, &outcome))?;
    }
    Ok(match FileResult::of(&outcome) {
        FileResult::Baked | FileResult::Fresh => Exit::Success,
        FileResult::Failed => Exit::Failed,
        FileResult::Stopped | FileResult::NotBegun => {
            say(format_args!("{} was not written", job.output.display()));
            Exit::Interrupted
        }
    })
}

fn job(arguments: &TangentsArguments) -> Result<TangentJob, Failure> {
    let (formula, meshes) = (&arguments.formula, &arguments.meshes);
    let options = TangentOptions {
        method: formula.method.unwrap_or_default(),
        convention: formula.convention.unwrap_or_default(),
        missing_normals: meshes.normals.unwrap_or_default(),
        unwrap: formula.unwrap,
        weld_seams: formula.weld_seams,
        precision: formula.precision.unwrap_or_default(),
    };
    Ok(TangentJob {
        input: arguments.input.clone(),
        output: output(&arguments.input, &arguments.output),
        options,
        bitangents: formula.bitangent,
        read: ModelReadOptions { all: meshes.all, max_bytes: max_bytes(meshes.max_bytes) },
        baker: Arc::new(open_baker(&arguments.device.place()?)?),
    })
}

/// The file that is meant by `given`: itself, or in a folder one with the input's name.
fn output(input: &Path, given: &Path) -> PathBuf {
    let names_folder = given.to_string_lossy().ends_with(is_separator) || given.is_dir();
    match input.file_name().filter(|_| names_folder) {
        None => given.to_owned(),
        Some(name) => {
            let is_obj = input.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
            let file = given.join(name);
            if is_obj { file.with_extension("glb") } else { file }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_takes_the_name_of_the_input() {
        for (input, given, file) in [
            ("a/model.glb", "b.glb", "b.glb"),
            ("a/model.glb", "out/", "out/model.glb"),
            ("a/model.gltf", "src", "src/model.gltf"),
            ("a/scan.v2.OBJ", "out/", "out/scan.v2.glb"),
            ("scan.obj", "out", "out"),
        ] {
            assert_eq!(output(input.as_ref(), given.as_ref()), Path::new(file), "{input} {given}");
        }
    }
}
