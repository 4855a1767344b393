//! `texbake normal`: one file.

use super::args::NormalArguments;
use super::exit::{Exit, Failure};
use super::settings::open_baker;
use super::single::{ParallaxTelling, bake_one};
use super::values::USUAL_ITERATIONS;
use std::sync::Arc;
use texbake::Maps;
use texbake::batch::Job;

pub fn normal(arguments: &NormalArguments) -> Result<Exit, Failure> {
    let settings = &arguments.settings;
    let format = settings.normal.format(&arguments.output)?;
    let options = settings.slope.bake(Some(format), None)?;
    let job = Job {
        input: arguments.input.clone(),
        outputs: Maps { normal: Some(arguments.output.clone()), parallax: None, roughness: None },
        normals: None,
        read: settings.input.read(),
        options,
        write: settings.file.write(),
        baker: Arc::new(open_baker(&settings.device.place()?)?),
    };
    bake_one(job, &ParallaxTelling { iterations: USUAL_ITERATIONS, sidecar: None }, &arguments.reporting)
}
