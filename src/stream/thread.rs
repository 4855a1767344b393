//! Threads beside a bake: one reads, one writes.

use crate::error::{Error, Result};
use std::thread::{Builder, JoinHandle};

/// Starts a thread for `job`.
///
/// # Errors
/// [`Error::Threads`] if the system refuses one more.
pub(super) fn start<T: Send + 'static>(
    builder: Builder,
    job: impl FnOnce() -> T + Send + 'static,
) -> Result<JoinHandle<T>> {
    builder.spawn(job).map_err(Error::threads)
}

/// What the thread's job returned; its panic is the caller's.
pub(super) fn join<T>(thread: JoinHandle<T>) -> T {
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No address space holds such a stack.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_thread_that_the_system_refuses_is_an_error() {
        let refused = start(Builder::new().stack_size(1 << 60), || ());
        let message = refused.expect_err("a stack of 2^60 bytes").to_string();
        assert!(message.starts_with("the system starts no more threads: "), "{message}");
        assert!(message.ends_with("; run fewer bakes at a time, or raise the limit (ulimit -u)"), "{message}");
    }
}
