//! `texbake normal`: one file.

use super::args::NormalArguments;
use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{bake_line, say};
use super::progress::{Progress, Verbosity};
use super::settings::open_baker;
use std::sync::Arc;
use std::time::Instant;
use texbake::batch::{Job, Report, ReportFile, run};

pub fn normal(arguments: &NormalArguments) -> Result<Exit, Failure> {
    let settings = &arguments.settings;
    let options = settings.normal(&arguments.output)?;
    let device = settings.device()?;
    let jobs = [Job {
        input: arguments.input.clone(),
        output: arguments.output.clone(),
        read: settings.read(),
        options,
        baker: Arc::new(open_baker(&device)?),
    }];
    let reporting = &arguments.reporting;
    let report_file = reporting.report.as_deref().map(|path| ReportFile::create(path, &jobs, None)).transpose()?;

    let monitor = interruptible();
    let progress = Progress::new(&jobs, &monitor, if reporting.quiet { Verbosity::Quiet } else { Verbosity::Warnings });
    let start = Instant::now();
    let outcomes = progress.during(|| run(&jobs, 1, &monitor, &|event| progress.watch(event)));
    let time = start.elapsed();

    if !reporting.quiet {
        jobs.iter().zip(&outcomes).filter_map(|(job, outcome)| bake_line(job, outcome)).for_each(say);
    }
    let report = Report::new(&jobs, &outcomes, time, &[], None);
    if let Some(file) = report_file {
        file.write(&report)?;
    }
    Ok(match report.totals {
        totals if totals.baked == 1 => Exit::Success,
        totals if totals.failed == 1 => Exit::Failed,
        _ => {
            say(format_args!("{} was not baked", arguments.input.display()));
            Exit::Interrupted
        }
    })
}
