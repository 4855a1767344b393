//! `texbake blend`: two normal maps.

use super::args::{BlendArguments, Formula, Method};
use super::exit::{Exit, Failure};
use super::print::{blend_line, say};
use super::progress::{Ending, Progress, Verbosity, fallback};
use super::settings::{max_bytes, open_baker};
use super::stopped_by_interrupts;
use super::values::WeightPair;
use clap::ValueEnum;
use std::sync::Arc;
use texbake::batch::{BlendJob, BlendReport, FileResult, JsonFile, MaskInput, NormalInput};
use texbake::io::{NormalReadOptions, ReadOptions};
use texbake::{BlendMethod, BlendOptions, Convention, Error, Result as BakeResult, Weights};

pub fn blend(arguments: &BlendArguments) -> Result<Exit, Failure> {
    arguments.resources.start_threads()?;
    let (reporting, method) = (&arguments.reporting, arguments.formula.method());
    let job = job(arguments, method)?;
    let files = job.files();
    let report_file = reporting.report.as_deref();
    let report_file = report_file.map(|path| JsonFile::create("report", path, std::slice::from_ref(&files), None));
    let report_file = report_file.transpose()?;

    let monitor = stopped_by_interrupts(arguments.resources.monitor()?);
    let progress = Progress::new(&[&job.base.path], &monitor, Verbosity::of(reporting, Verbosity::Warnings));
    let blended = progress.during(|| job.run(&monitor, &|size| progress.opened(0, size)));
    let outcome = &blended.outcome;
    let ran = outcome.result.as_ref().ok().map(|blended| &blended.ran);
    let ending = Ending {
        line: None,
        failure: job.failure(outcome),
        warnings: outcome.warnings.iter().cloned().chain(ran.and_then(fallback)).collect(),
        succeeded: ran.is_some(),
    };
    progress.ended(0, ending);

    let name = method.name();
    if !reporting.quiet {
        blend_line(&job, &name, &blended).iter().for_each(say);
    }
    if let Some(file) = report_file {
        file.write(&BlendReport::new(&job, &name, &blended))?;
    }
    Ok(match FileResult::of(outcome) {
        FileResult::Baked | FileResult::Fresh => Exit::Success,
        FileResult::Failed => Exit::Failed,
        FileResult::Stopped | FileResult::NotBegun => {
            say(format_args!("{} was not written", arguments.output.display()));
            Exit::Interrupted
        }
    })
}

fn job(arguments: &BlendArguments, method: Method) -> Result<BlendJob, Failure> {
    let (formula, inputs) = (&arguments.formula, &arguments.inputs);
    let write = arguments.file.write();
    let options = BlendOptions {
        method: formula.formula(method)?,
        tile: formula.tile,
        format: arguments.normal.format(&arguments.output, &write)?,
        precision: formula.precision.unwrap_or_default(),
    };
    arguments.file.check_effect([arguments.output.as_path()])?;
    let max_bytes = max_bytes(inputs.max_bytes);
    let read = |encoding, channels, convention: Option<Convention>| NormalReadOptions {
        encoding,
        channels,
        convention: convention.unwrap_or_default(),
        max_bytes,
    };
    let base = read(inputs.base_encoding, inputs.base_channels, inputs.base_convention);
    let detail = read(inputs.detail_encoding, inputs.detail_channels, inputs.detail_convention);
    let mask = || ReadOptions { channel: formula.mask_channel.clone(), max_bytes, ..ReadOptions::default() };
    Ok(BlendJob {
        base: NormalInput { path: arguments.base.clone(), read: base },
        detail: NormalInput { path: arguments.detail.clone(), read: detail },
        mask: formula.mask.clone().map(|path| MaskInput { path, read: mask() }),
        output: arguments.output.clone(),
        options,
        write,
        baker: Arc::new(open_baker(&arguments.device.place()?)?),
    })
}

impl Method {
    /// Its name on the command line.
    fn name(self) -> String {
        self.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
    }
}

impl Formula {
    /// The method that was named, or the one that the other options are for.
    fn method(&self) -> Method {
        let is_weighted = self.weights.is_some() || self.transition.is_some() || self.mask.is_some();
        self.method.unwrap_or(if is_weighted { Method::Weighted } else { Method::Add })
    }

    /// The formula with its weights.
    fn formula(&self, method: Method) -> BakeResult<BlendMethod> {
        match method {
            Method::Add => {
                let is_one = self.weights.is_none_or(|WeightPair(weights)| weights == [1.into(), 1.into()]);
                self.check_weightless("method add, whose weights are 1,1 (see --method weighted)", is_one)?;
                Ok(BlendMethod::add())
            }
            Method::Weighted | Method::PartialDerivative => self.weighted(method),
            Method::Linear => self.weightless(method, BlendMethod::Linear),
            Method::Overlay => self.weightless(method, BlendMethod::Overlay),
            Method::Udn => self.weightless(method, BlendMethod::Udn),
            Method::Whiteout => self.weightless(method, BlendMethod::Whiteout),
            Method::Rnm => self.weightless(method, BlendMethod::Rnm),
        }
    }

    fn weighted(&self, method: Method) -> BakeResult<BlendMethod> {
        match (self.weights, self.transition, &self.mask) {
            (Some(WeightPair([base, detail])), ..) => {
                Weights::new(base, detail).map(|_| BlendMethod::Weighted { base, detail })
            }
            (None, Some(transition), _) => BlendMethod::transition(transition),
            (None, None, Some(_)) => Ok(BlendMethod::Masked),
            (None, None, None) if method == Method::PartialDerivative => Ok(BlendMethod::add()),
            (None, None, None) => {
                let range = "given with --method weighted, or else --transition or --mask".into();
                Err(Error::Parameter { parameter: "weights", value: "missing".into(), range })
            }
        }
    }

    fn weightless(&self, method: Method, formula: BlendMethod) -> BakeResult<BlendMethod> {
        let what = format!("method {}, which has no weights (see --method weighted)", method.name());
        self.check_weightless(&what, self.weights.is_none()).map(|()| formula)
    }

    /// Fails if something was given that `what` does not go with.
    fn check_weightless(&self, what: &str, weights_fit: bool) -> BakeResult<()> {
        let weights = self.weights.filter(|_| !weights_fit).map(|weights| ("weights", weights.to_string()));
        let transition = self.transition.map(|transition| ("transition", transition.to_string()));
        let mask = self.mask.as_ref().map(|mask| ("mask", mask.display().to_string()));
        match weights.or(transition).or(mask) {
            None => Ok(()),
            Some((parameter, value)) => {
                Err(Error::Parameter { parameter, value, range: format!("left out with --{what}") })
            }
        }
    }
}
