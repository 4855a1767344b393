//! One file: baked, reported, and described to a shader.

use super::args::Reporting;
use super::exit::{Exit, Failure};
use super::jobs::missing_tiles;
use super::print::{bake_line, parallax_line, say};
use super::progress::{Progress, Verbosity};
use super::resources::Resources;
use super::stopped_by_interrupts;
use std::num::NonZeroU32;
use std::path::Path;
use std::time::Instant;
use texbake::batch::{Job, JsonFile, ParallaxSidecar, Report, run};

/// What is told about a parallax map.
pub struct ParallaxTelling<'a> {
    /// Steps of the shader.
    pub iterations: NonZeroU32,
    /// The JSON file beside it.
    pub sidecar: Option<&'a Path>,
}

/// Bakes one file, and says how it went.
pub fn bake_one(
    job: Job,
    telling: &ParallaxTelling<'_>,
    resources: &Resources,
    reporting: &Reporting,
) -> Result<Exit, Failure> {
    job.neighbours.iter().try_for_each(|neighbours| neighbours.check(&job.read, &job.options, &job.write))?;
    let jobs = [job];
    let mut files = Job::all_files(&jobs);
    let create = |path| {
        let file = JsonFile::create("sidecar", path, &files, None)?;
        ParallaxSidecar::check_place(path).map(|()| file)
    };
    let sidecar = telling.sidecar.map(create).transpose()?;
    files[0].outputs.extend(telling.sidecar);
    let report_file = reporting.report.as_deref().map(|path| JsonFile::create("report", path, &files, None));
    let report_file = report_file.transpose()?;

    let warnings = missing_tiles(&jobs);
    if !reporting.quiet {
        warnings.iter().for_each(|text| say(format_args!("warning: {text}")));
    }
    let monitor = stopped_by_interrupts(resources.monitor()?);
    let progress = Progress::new(&[&jobs[0].input], &monitor, Verbosity::of(reporting, Verbosity::Warnings));
    let start = Instant::now();
    let outcomes = progress.during(|| run(&jobs, 1, &monitor, &|event| progress.watch(&jobs, event)));
    let time = start.elapsed();

    let numbers = ParallaxSidecar::of(&jobs[0], &outcomes[0], telling.iterations);
    if !reporting.quiet {
        bake_line(&jobs[0], &outcomes[0]).iter().for_each(say);
        numbers.iter().map(|sidecar| parallax_line(&sidecar.numbers)).for_each(say);
    }
    let report = Report { warnings, ..Report::new(&jobs, &outcomes, time, &[], None, telling.iterations) };
    if let Some(file) = report_file {
        file.write(&report)?;
    }
    // A sidecar that cannot be written is no reason to go without the report.
    if let Some((file, numbers)) = sidecar.zip(numbers.as_ref()) {
        // Without its own numbers, the new map shall not have those of the old one.
        file.write(numbers).inspect_err(|_| _ = telling.sidecar.map(std::fs::remove_file))?;
    }
    Ok(match report.totals {
        totals if totals.baked == 1 => Exit::Success,
        totals if totals.failed == 1 => Exit::Failed,
        _ => {
            say(format_args!("{} was not baked", jobs[0].input.display()));
            Exit::Interrupted
        }
    })
}
