//! A model that wears the material.

use super::PreviewArguments;
use crate::cli::exit::Failure;
use crate::cli::print::say;
use crate::cli::settings::open_baker;
use std::path::Path;
use texbake::TangentOptions;
use texbake::io::{Model, ModelReadOptions};
use texbake::preview::Worn;

/// The model's meshes, with the tangents of the file where it has them, and others where it has none.
pub fn meshes(path: &Path, arguments: &PreviewArguments) -> Result<Vec<Worn>, Failure> {
    let max_bytes = arguments.settings.input.read().max_bytes;
    let model = Model::read_with(path, &ModelReadOptions { all: true, max_bytes })?;
    let note = |text: &dyn std::fmt::Display| {
        if !arguments.quiet {
            say(format_args!("warning: {}: {text}", path.display()));
        }
    };
    model.warnings().iter().for_each(|text| note(text));
    for left_out in model.left_out() {
        note(&format_args!("{} is not shown: {}", left_out.name, left_out.reason));
    }
    if model.primitives().is_empty() {
        let reason = "it has no mesh with texture coordinates";
        return Err(Failure::Failed(format!("{}: {reason}; unwrap it first, and export it again", path.display())));
    }
    let baker = open_baker(&arguments.settings.device.place()?)?;
    let worn = |primitive| {
        let mesh = model.mesh(primitive)?;
        let worn = match model.tangents(primitive)?.filter(|_| mesh.normals().is_some()) {
            Some(tangents) => Worn::with_tangents(&mesh, &tangents)?,
            None => Worn::of_tangents(&mesh, &baker.tangents(&mesh, &TangentOptions::default())?)?,
        };
        Ok(worn)
    };
    let worn: Vec<_> = (0..model.primitives().len()).map(worn).collect::<texbake::Result<_>>()?;
    let meshes: Vec<_> = model.placements()?.into_iter().zip(worn).collect();
    let copied = meshes.iter().map(|(places, worn)| places.len() as u64 * worn.bytes()).sum::<u64>();
    if copied > max_bytes {
        let reason = format!("its meshes take {copied} bytes with all copies, above the limit of {max_bytes}");
        return Err(Failure::Failed(format!("{}: {reason}; raise it with --max-bytes", path.display())));
    }
    Ok(meshes.iter().flat_map(|(places, worn)| places.iter().map(|place| worn.placed(place))).collect())
}
