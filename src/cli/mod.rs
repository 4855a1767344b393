//! The command line: arguments, then actions. Nothing else prints.

mod args;
mod bake;
mod blend;
mod check;
mod check_plan;
pub(crate) mod config;
mod devices;
mod diff;
mod exit;
mod jobs;
mod measure;
mod normal;
mod parallax;
mod plan;
mod preview;
mod print;
mod progress;
mod resources;
mod settings;
mod shaders;
mod single;
mod tangents;
mod values;
mod verify;
mod watch;

use args::{Arguments, Command};
use clap::Parser;
use exit::Exit;
use std::process::ExitCode;
use std::sync::Arc;
use texbake::stream::Monitor;

/// Does what the arguments say.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    survive_large_files();
    let done = match &arguments.command {
        Command::Normal(arguments) => normal::normal(arguments),
        Command::Parallax(arguments) => parallax::parallax(arguments),
        Command::Bake(arguments) => bake::bake(arguments),
        Command::Plan(arguments) => plan::plan(arguments),
        Command::Blend(arguments) => blend::blend(arguments),
        Command::Tangents(arguments) => tangents::tangents(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Diff(arguments) => diff::diff(arguments),
        Command::Devices(arguments) => devices::devices(arguments),
        Command::Preview(arguments) => preview::preview(arguments),
        Command::Verify(arguments) => verify::verify(arguments),
        Command::Measure(arguments) => measure::run(arguments),
        Command::Shaders(arguments) => shaders::shaders(arguments),
    };
    let exit = done.unwrap_or_else(|failure| {
        print::say(format_args!("error: {failure}"));
        failure.exit()
    });
    print::finish_announcement();
    match exit {
        Exit::Success if print::is_lost() => Exit::Failed.into(),
        exit => exit.into(),
    }
}

/// Makes a file that grows beyond the limit on sizes (`ulimit -f`) an error of writing it, not the end of the program.
fn survive_large_files() {
    #[cfg(unix)]
    {
        use signal_hook::{consts::SIGXFSZ, flag};
        // Whatever handles the signal; if nothing can, the program ends as others do.
        let _ = flag::register(SIGXFSZ, Arc::default());
    }
}

/// A monitor that an interrupt cancels: files that are being written end cleanly. A second interrupt ends the program.
fn interruptible() -> Arc<Monitor> {
    stopped_by_interrupts(Monitor::default())
}

/// As [`interruptible`], for a monitor that is there.
fn stopped_by_interrupts(monitor: Monitor) -> Arc<Monitor> {
    let monitor = Arc::new(monitor);
    let watched = monitor.clone();
    let stop = move || {
        if watched.is_cancelled() {
            end_at_once();
        }
        let text = "interrupted: what is being written is dropped; interrupt again to end at once";
        print::announce(text, || watched.cancel());
    };
    if let Err(error) = ctrlc::set_handler(stop) {
        print::say(format_args!("warning: an interrupt will not end cleanly: {error}"));
    }
    monitor
}

/// Ends the program without the drivers' and libraries' own endings, which may wait for what hangs.
fn end_at_once() -> ! {
    let status = Exit::Interrupted.code().into();
    #[cfg(unix)]
    signal_hook::low_level::exit(status);
    #[cfg(not(unix))]
    std::process::exit(status)
}
