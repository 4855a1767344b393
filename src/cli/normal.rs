//! `texbake normal`: one file.

use super::args::NormalArguments;
use super::exit::{Exit, Failure};
use super::settings::open_baker;
use super::single::{ParallaxTelling, bake_one};
use super::values::USUAL_ITERATIONS;
use std::sync::Arc;
use texbake::Maps;
use texbake::batch::Job;
use texbake::io::check_roughness;

pub fn normal(arguments: &NormalArguments) -> Result<Exit, Failure> {
    let (settings, resources) = (&arguments.settings, &arguments.resources);
    resources.start_threads()?;
    let write = settings.mips.write(settings.file.write());
    let format = settings.normal.format(&arguments.output, &write)?;
    let roughness = arguments.roughness.as_ref().map(|path| {
        let options = settings.roughness.options();
        check_roughness(path, options.format, &write).map(|()| options)
    });
    let options = settings.slope.bake(Some(format), None, roughness.transpose()?)?;
    settings.file.check_effect([arguments.output.as_path()])?;
    settings.roughness.check_effect(arguments.roughness.is_some())?;
    let job = Job {
        input: arguments.input.clone(),
        outputs: Maps {
            normal: Some(arguments.output.clone()),
            parallax: None,
            roughness: arguments.roughness.clone(),
        },
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
