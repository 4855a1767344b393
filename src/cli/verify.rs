//! `texbake verify`: proof that the devices of this machine compute what they should.

use super::exit::{Exit, Failure};
use super::interruptible;
use super::print::{comparison_table, put, say};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use std::path::PathBuf;
use texbake::batch::JsonFile;
use texbake::stream::Monitor;
#[cfg(feature = "gpu")]
use texbake::verify::Page;
use texbake::verify::{DeviceReport, Mismatch, Options, OracleAnswer, Progress, Report, Stored, Subject};
use texbake::{Error, Result};

/// Prove that every device of this machine computes what it should, kernel by kernel
#[derive(Args, Debug)]
#[command(after_help = "\
Runs every kernel, in every precision, format, edge mode and encoding, on
random, small, extreme and boundary inputs, on every adapter and on the
vectorised CPU, and compares each answer with the specification: plain scalar
code on the CPU. Codes of the specification, in turn, are judged by the
formulas in whole numbers of any size. In exact precision every bit must
agree. In fast precision the errors are measured, in codes, in units in the
last place of 1 (ulp: 2^-23 of 32f, 2^-10 of 16f), and in degrees, and must
stay within the bounds that the table and the README give.

Of a difference the smallest input that shows it is searched and printed, with
its bits, what each says of it, and the command that repeats it.

With --sabotage a constant of each kernel is changed first: every row of the
table must then fail, or verify would prove nothing. Not every case of a row
shows every constant.

The words of --only are parts of a case's name, as the bar shows it: normal
map, parallax map, both in one pass, parallax map of given normals, blend,
tangents of mikktspace, lengyel or hegde; exact, fast; u8, u16, f32; unorm 8
xyz gl and so on; central, sobel, scharr, prewitt; wrap, clamp, mirror,
wrap/clamp; random, small, extreme, boundaries; hills, mirrored, soup.

The page of --html runs the same kernels by the WebGPU of the browser that
opens it, and compares them with answers that it contains. It has as many of
the cases as give every choice that there is; all of them with --full.

Examples:
  texbake verify
  texbake verify --adapter llvmpipe --full --json report.json
  texbake verify --only \"normal map, exact, u16\"
  texbake verify --html verify.html

Exit status: 0 all agree or, sabotaged, every comparison fails; 1 something
differs, could not be verified, or did not notice the sabotage; 2 wrong
arguments, 130 interrupted.")]
pub struct VerifyArguments {
    /// Only adapters whose description contains NAME, as in `texbake devices`; vulkan:NAME names the API too
    #[arg(long, value_name = "NAME", conflicts_with = "backend")]
    pub adapter: Option<String>,

    /// Only the CPU, or only GPUs [default: both]
    #[arg(long, value_enum)]
    pub backend: Option<Backend>,

    /// Besides, every filter under every edge mode and convention, and every pair of formats that are blended: 180
    /// thousand cases instead of 1500, minutes on a GPU, hours in software
    #[arg(long)]
    pub full: bool,

    /// What all inputs are made from
    #[arg(long, value_name = "NUMBER", default_value_t = Options::default().seed)]
    pub seed: u64,

    /// Only cases that have all these words, with commas between them; a|b is either, see below
    #[arg(long, value_name = "WORDS")]
    pub only: Option<String>,

    /// Change a constant of each kernel first, to see that it is noticed
    #[arg(long)]
    pub sabotage: bool,

    /// Write what was found as JSON; missing folders are made
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Write a page that runs the same kernels by the WebGPU of any browser that opens it; nothing is verified here. Missing
    /// folders are made
    #[cfg(feature = "gpu")]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["adapter", "backend", "json"])]
    pub html: Option<PathBuf>,

    /// Print failures only
    #[arg(short, long)]
    pub quiet: bool,
}

/// What is verified.
#[derive(ValueEnum, Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backend {
    Cpu,
    Gpu,
}

pub fn verify(arguments: &VerifyArguments) -> Result<Exit, Failure> {
    let monitor = interruptible();
    #[cfg(feature = "gpu")]
    if let Some(path) = &arguments.html {
        return write_page(path, arguments, &monitor);
    }
    let file = arguments.json.as_deref().map(|path| JsonFile::create("report", path, &[], None)).transpose()?;
    let options = arguments.options();
    let mut report = Report::new(&options, arguments.sabotage);
    for subject in subjects(arguments)? {
        match examine(subject, arguments, &options, &monitor) {
            Ok(device) => {
                if !arguments.quiet || !device.passed() {
                    show(&device);
                }
                report.devices.push(device);
            }
            Err(Error::Cancelled) => {
                say(match report.devices.len() {
                    0 => "interrupted before a device was verified".to_owned(),
                    1 => "interrupted: one device was verified".to_owned(),
                    devices => format!("interrupted: {devices} devices were verified"),
                });
                report.interrupted = true;
                break;
            }
            Err(error) => return Err(error.into()),
        }
    }
    if let Some(file) = file {
        file.write(&report)?;
    }
    if report.interrupted {
        return Ok(Exit::Interrupted);
    }
    if !arguments.quiet {
        put(summary(&report));
    }
    let is_well = if report.sabotaged { report.is_noticed() } else { report.passed() };
    Ok(if is_well { Exit::Success } else { Exit::Failed })
}

impl VerifyArguments {
    fn options(&self) -> Options {
        Options { seed: self.seed, full: self.full, only: self.only.clone() }
    }
}

#[cfg(feature = "gpu")]
fn write_page(path: &std::path::Path, arguments: &VerifyArguments, monitor: &Monitor) -> Result<Exit, Failure> {
    let bar = bar(arguments.quiet);
    let watch = &mut |progress: Progress<'_>| advance(&bar, "page", progress);
    let page = match Page::new(&arguments.options(), arguments.sabotage, monitor, watch) {
        Err(Error::Cancelled) => {
            say("interrupted: no page was written");
            return Ok(Exit::Interrupted);
        }
        page => page?,
    };
    bar.finish_and_clear();
    page.write(path)?;
    if !arguments.quiet {
        let (cases, values) = (page.cases(), page.values());
        put(format_args!("{}: {cases} cases, {values} values; open it in a browser with WebGPU", path.display()));
    }
    Ok(Exit::Success)
}

/// Hidden where stderr is no terminal.
fn bar(is_quiet: bool) -> ProgressBar {
    let bar = if is_quiet { ProgressBar::hidden() } else { ProgressBar::new(0) };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}").unwrap_or(ProgressStyle::default_bar()));
    bar
}

fn advance(bar: &ProgressBar, name: &str, progress: Progress<'_>) {
    bar.set_length(progress.of as u64);
    bar.set_position(progress.done as u64);
    bar.set_message(format!("{name}: {}", progress.case));
}

/// What the arguments mean; an adapter that does not open is a finding.
fn subjects(arguments: &VerifyArguments) -> Result<Vec<Result<Subject>>, Failure> {
    let (named, backend) = (arguments.adapter.as_deref(), arguments.backend);
    let mut subjects = Vec::new();
    if named.is_none() && backend != Some(Backend::Gpu) {
        subjects.push(Ok(Subject::cpu()));
    }
    if backend != Some(Backend::Cpu) {
        let adapters = adapters(named);
        match (named, adapters.is_empty()) {
            // Which says what there is.
            (Some(_), true) => return Err(Failure::from(no_adapter(named))),
            // What was not verified is no success.
            (None, true) => subjects.push(Err(no_adapter(named))),
            _ => subjects.extend(adapters),
        }
    }
    Ok(subjects)
}

#[cfg(feature = "gpu")]
fn adapters(named: Option<&str>) -> Vec<Result<Subject>> {
    Subject::adapters(named)
}

#[cfg(not(feature = "gpu"))]
fn adapters(_: Option<&str>) -> Vec<Result<Subject>> {
    Vec::new()
}

/// Why there is no adapter, and which there are.
fn no_adapter(named: Option<&str>) -> Error {
    let reason =
        || "this machine has no adapter that runs compute kernels; --backend cpu verifies the CPU alone".into();
    match (named, texbake::Baker::gpu(named)) {
        (Some(_), Err(error)) => error,
        _ => Error::Device { adapter: "gpu".into(), reason: reason() },
    }
}

/// Verifies a device while a bar moves.
fn examine(
    subject: Result<Subject>,
    arguments: &VerifyArguments,
    options: &Options,
    monitor: &Monitor,
) -> Result<DeviceReport> {
    let subject = match subject {
        Ok(subject) if arguments.sabotage => subject.sabotaged(),
        Ok(subject) => subject,
        Err(Error::Device { adapter, reason }) => return Ok(DeviceReport::failed(adapter, reason)),
        Err(error) => return Err(error),
    };
    let bar = bar(arguments.quiet);
    let name = subject.name();
    let report = subject.verify(options, monitor, &mut |progress| {
        // Where no bar is seen.
        if progress.done == 0 && bar.is_hidden() && !arguments.quiet {
            say(format_args!("verifying {name}, {} cases", progress.of));
        }
        advance(&bar, &name, progress);
    });
    bar.finish_and_clear();
    report
}

fn show(device: &DeviceReport) {
    put(format_args!("{}", device.device));
    if !device.comparisons.is_empty() {
        put(comparison_table(&device.comparisons));
        let judged: u64 = device.comparisons.iter().map(|it| it.agreement.judged).sum();
        put(format_args!(" {judged} codes of the specification were judged by the formulas in whole numbers"));
    }
    if let Some(failure) = &device.failure {
        put(format_args!(" FAILED: {failure}"));
    }
    for comparison in &device.comparisons {
        comparison.mismatch.iter().for_each(show_mismatch);
    }
    put("");
}

fn show_mismatch(mismatch: &Mismatch) {
    put(format_args!("\n  {}", mismatch.case));
    put(format_args!("  the smallest input that was found: {}", mismatch.input.replace('\n', "\n  ")));
    put(format_args!("  at {}", mismatch.place));
    let stored = |it: Option<Stored>| it.map_or("nothing".into(), |it| format!("{} ({:#x})", it.number, it.bits));
    let oracle = match &mismatch.oracle {
        None => "no whole numbers say it".into(),
        Some(OracleAnswer { component, bits: Some(bits) }) => format!("the component is {component}: code {bits:#x}"),
        Some(OracleAnswer { component, .. }) => format!("the component is {component}"),
    };
    for (who, says) in [
        ("this device says", stored(mismatch.device)),
        ("the CPU", stored(mismatch.cpu)),
        ("the specification", stored(mismatch.specification)),
        ("the formula", oracle),
    ] {
        put(format_args!("    {who:<20}{says}"));
    }
    put(format_args!("  again: {}", mismatch.command));
}

fn summary(report: &Report) -> String {
    let (failed, devices) = (report.devices.iter().filter(|device| !device.passed()).count(), report.devices.len());
    let found = match (report.sabotaged, report.is_noticed()) {
        (true, true) => "sabotaged on purpose, and every comparison has noticed it".to_owned(),
        (true, false) => "sabotaged on purpose, and NOT every comparison has noticed it".to_owned(),
        _ if failed > 0 => format!("{failed} of {devices} FAILED"),
        _ if devices == 1 => format!("it agrees in all {} cases", report.cases()),
        _ => format!("all {devices} agree, in {} cases", report.cases()),
    };
    format!("texbake {}, seed {}: {found}", report.version, report.seed)
}
