//! `texbake parallax`: one file.

use super::args::ParallaxArguments;
use super::exit::{Exit, Failure};
use super::settings::{max_bytes, open_baker};
use super::single::{ParallaxTelling, bake_one};
use std::sync::Arc;
use texbake::Maps;
use texbake::batch::{Job, NormalInput};
use texbake::io::NormalReadOptions;

pub fn parallax(arguments: &ParallaxArguments) -> Result<Exit, Failure> {
    arguments.resources.start_threads()?;
    let write = arguments.mips.write(arguments.file.write());
    let format = arguments.codes().parallax(&arguments.output, &write)?;
    let options = arguments.slope.bake(None, Some(format), None)?;
    arguments.file.check_effect([arguments.output.as_path()])?;
    let job = Job {
        input: arguments.input.clone(),
        outputs: Maps { parallax: Some(arguments.output.clone()), ..Maps::default() },
        normals: given_normals(arguments),
        neighbours: arguments.tiles.around(&arguments.input, &options)?,
        read: arguments.heights.read(),
        options,
        write,
        baker: Arc::new(open_baker(&arguments.device.place()?)?),
    };
    let sidecar = arguments.json.then(|| arguments.output.with_extension("json"));
    let telling = ParallaxTelling { iterations: arguments.iterations, sidecar: sidecar.as_deref() };
    bake_one(job, &telling, &arguments.resources, &arguments.reporting)
}

/// The normal map that was given; n_z does not depend on which way its green points.
fn given_normals(arguments: &ParallaxArguments) -> Option<NormalInput> {
    let read = NormalReadOptions {
        encoding: arguments.normal_encoding,
        channels: arguments.normal_channels,
        max_bytes: max_bytes(arguments.heights.max_bytes),
        ..NormalReadOptions::default()
    };
    arguments.normal.clone().map(|path| NormalInput { path, read })
}
