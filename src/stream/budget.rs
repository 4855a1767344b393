//! Memory that the bakes of one run share.

use super::monitor::Monitor;
use crate::error::{Error, Result};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A number of bytes, of which each bake takes a share before its rows flow, and gives it back at its end.
#[derive(Debug)]
pub(super) struct Budget {
    /// Held by the one bake that opens its files and waits for its share: others wait with nothing open.
    turn: Mutex<()>,
    all: u64,
    free: Mutex<u64>,
    given_back: Condvar,
}

/// The right to open files, until the share for them is taken.
pub(crate) struct Turn<'a> {
    /// `None` where memory is not bounded.
    bounded: Option<(&'a Budget, MutexGuard<'a, ()>)>,
}

/// What one bake may hold.
#[derive(Debug)]
pub(crate) struct Share<'a> {
    budget: &'a Budget,
    bytes: u64,
}

/// How long a bake that waits for memory does not look whether it shall end.
const LOOK: Duration = Duration::from_millis(50);

impl Budget {
    pub fn new(bytes: u64) -> Self {
        Self { turn: Mutex::default(), all: bytes, free: Mutex::new(bytes), given_back: Condvar::new() }
    }

    /// Waits for the turn of one bake.
    pub fn turn(&self) -> Turn<'_> {
        Turn { bounded: Some((self, self.turn.lock().unwrap_or_else(PoisonError::into_inner))) }
    }

    fn take(&self, bytes: u64, monitor: &Monitor) -> Result<Share<'_>> {
        if bytes > self.all {
            let range = format!("at least {} for this file", megabytes(bytes));
            return Err(Error::parameter("memory left for rows", megabytes(self.all), range));
        }
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        while *free < bytes {
            monitor.check()?;
            (free, _) = self.given_back.wait_timeout(free, LOOK).unwrap_or_else(PoisonError::into_inner);
        }
        *free -= bytes;
        Ok(Share { budget: self, bytes })
    }
}

impl<'a> Turn<'a> {
    /// The turn of a bake whose memory is not bounded.
    pub fn unbounded() -> Self {
        Self { bounded: None }
    }

    /// Waits until `bytes` are free, takes them for as long as what is returned lives, and lets the next one open its
    /// files.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there are never so many; [`Error::Cancelled`].
    pub fn take(self, bytes: u64, monitor: &Monitor) -> Result<Option<Share<'a>>> {
        self.bounded.map(|(budget, _turn)| budget.take(bytes, monitor)).transpose()
    }
}

impl Drop for Share<'_> {
    fn drop(&mut self) {
        *self.budget.free.lock().unwrap_or_else(PoisonError::into_inner) += self.bytes;
        self.budget.given_back.notify_all();
    }
}

/// As `--memory` takes it, rounded up.
fn megabytes(bytes: u64) -> String {
    format!("{}M", bytes.div_ceil(1 << 20))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

    #[test]
    fn shares_never_exceed_the_budget() {
        let (monitor, budget) = (Monitor::default(), Budget::new(10));
        let (held, most) = (AtomicU64::new(0), AtomicU64::new(0));
        std::thread::scope(|scope| {
            for bytes in [3, 4, 5, 6, 10, 1] {
                let (monitor, budget, held, most) = (&monitor, &budget, &held, &most);
                scope.spawn(move || {
                    for _ in 0..200 {
                        let share = budget.turn().take(bytes, monitor).unwrap();
                        most.fetch_max(held.fetch_add(bytes, SeqCst) + bytes, SeqCst);
                        held.fetch_sub(bytes, SeqCst);
                        drop(share);
                    }
                });
            }
        });
        assert_eq!((*budget.free.lock().unwrap(), most.load(SeqCst)), (10, 10));
    }

    #[test]
    fn what_never_fits_is_refused_and_what_waits_can_be_stopped() {
        let (monitor, budget) = (Monitor::default(), Budget::new(3 << 20));
        let error = budget.turn().take((3 << 20) + 1, &monitor).unwrap_err();
        assert_eq!(error.to_string(), "memory left for rows is 3M: it must be at least 4M for this file");
        let _all = budget.turn().take(3 << 20, &monitor).unwrap();
        monitor.cancel();
        assert!(matches!(budget.turn().take(1, &monitor), Err(Error::Cancelled)));
    }
}
