//! What was baked is not baked again, and what was not is.

#[cfg(unix)]
mod concurrent;
mod decisions;
mod dry_run;
mod kernel_version;
mod library;
mod many;
mod neighbours;
mod options;
mod record;
#[cfg(unix)]
mod resume;
mod support;
#[cfg(unix)]
mod watch;
