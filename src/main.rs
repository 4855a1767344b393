//! The program: see `texbake --help`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
