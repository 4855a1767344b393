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
    let (settings, resources) = (&arguments.settings, &arguments.resources);
    resources.start_threads()?;
    let write = settings.file.write();
    let format = settings.normal.format(&arguments.output, &write)?;
    let options = settings.slope.bake(Some(format), None)?;
    let job = Job {
        input: arguments.input.clone(),
        outputs: Maps { normal: Some(arguments.output.clone()), parallax: None },
        normals: None,
        neighbours: settings.tiles.around(&arguments.input, &options)?,
        read: settings.input.read(),
        options,
        write,
        baker: Arc::new(open_baker(&settings.device.place()?)?),
    };
    let telling = ParallaxTelling { iterations: USUAL_ITERATIONS, sidecar: None };
    bake_one(job, &telling, resources, &arguments.reporting)
}
