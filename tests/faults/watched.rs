//! A running process and its moment.

use std::process::Child;
use std::time::{Duration, Instant};

/// How long a process may do neither what is waited for nor end: a test fails instead of hanging.
const PATIENCE: Duration = Duration::from_secs(120);

/// Between two looks at it, so that the tests do not take the time that it needs.
pub const PAUSE: Duration = Duration::from_millis(1);

/// Looks at a process until `is_time`; whether that came before its end.
pub fn reaches(child: &mut Child, pause: Duration, mut is_time: impl FnMut() -> bool) -> bool {
    let begin = Instant::now();
    while !is_time() {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("for {PATIENCE:?} neither the moment came that was waited for nor the end of the process");
        }
        std::thread::sleep(pause);
    }
    true
}
