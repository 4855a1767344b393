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
    /// What the process holds besides.
    taken: u64,
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
    /// `bytes` of a process that has `taken` some of them.
    pub fn new(bytes: u64, taken: u64) -> Self {
        let free = Mutex::new(bytes.saturating_sub(taken));
        Self { turn: Mutex::default(), all: bytes, taken, free, given_back: Condvar::new() }
    }

    /// Waits for the turn of one bake.
    pub fn turn(&self) -> Turn<'_> {
        Turn { bounded: Some((self, self.turn.lock().unwrap_or_else(PoisonError::into_inner))) }
    }

    fn take(&self, bytes: u64, monitor: &Monitor) -> Result<Share<'_>> {
        // Such a thread may be in the middle of a bake, of which it waits for a part: there it takes up the next one,
        // which would wait here for the memory of the bake beneath it.
        if rayon::current_thread_index().is_some() {
            let range = "left unbounded where bakes run on the threads of rayon: std's wait for each other";
            return Err(Error::parameter("memory", as_given(self.all), range));
        }
        let needed = self.taken.saturating_add(bytes);
        if needed > self.all {
            let range = format!("at least {}M for this file", needed.div_ceil(MEBIBYTE));
            return Err(Error::parameter("memory", as_given(self.all), range));
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
    /// [`Error::Parameter`] if there are never so many, or on a thread of rayon; [`Error::Cancelled`].
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

const MEBIBYTE: u64 = 1 << 20;

/// As a user writes it.
fn as_given(bytes: u64) -> String {
    if bytes.is_multiple_of(MEBIBYTE) { format!("{}M", bytes / MEBIBYTE) } else { bytes.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

    #[test]
    fn shares_never_exceed_the_budget() {
        let (monitor, budget) = (Monitor::default(), Budget::new(17, 7));
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
        let (monitor, budget) = (Monitor::default(), Budget::new(64 << 20, 61 << 20));
        let error = budget.turn().take((3 << 20) + 1, &monitor).unwrap_err();
        assert_eq!(error.to_string(), "memory is 64M: it must be at least 65M for this file");
        let _all = budget.turn().take(3 << 20, &monitor).unwrap();
        monitor.cancel();
        assert!(matches!(budget.turn().take(1, &monitor), Err(Error::Cancelled)));
    }
}
