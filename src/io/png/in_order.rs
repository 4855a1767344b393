//! Jobs that any thread may do, and whose results come in order.
//!
//! The threads are those that all of the process share (rayon's). They may all be waiting for this very file, where a
//! caller bakes on them; so whoever waits for a job that nobody has begun does it.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What is done to a job.
type Work<T> = Arc<dyn Fn(&mut T) + Send + Sync>;

/// Jobs on their way, the oldest first.
pub(super) struct InOrder<T> {
    jobs: VecDeque<Arc<Job<T>>>,
    work: Work<T>,
}

struct Job<T> {
    state: Mutex<State<T>>,
    done: Condvar,
}

enum State<T> {
    Waiting(T),
    Begun,
    Done(T),
}

impl<T: Send + 'static> InOrder<T> {
    /// Jobs that are done by `work`.
    pub fn new(work: impl Fn(&mut T) + Send + Sync + 'static) -> Self {
        Self { jobs: VecDeque::new(), work: Arc::new(work) }
    }

    /// Jobs whose results were not taken.
    pub fn len(&self) -> usize {
        self.jobs.len()
    }

    /// Lets some thread do a job.
    pub fn push(&mut self, job: T) {
        let job = Arc::new(Job { state: Mutex::new(State::Waiting(job)), done: Condvar::new() });
        self.jobs.push_back(job.clone());
        let work = self.work.clone();
        rayon::spawn(move || job.run(&*work));
    }

    /// The oldest job once it is done; `None` if there is none.
    pub fn pop(&mut self) -> Option<T> {
        let job = self.jobs.pop_front()?;
        job.run(&*self.work);
        Some(job.wait())
    }
}

impl<T> Job<T> {
    fn state(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does the job if nobody has begun it.
    fn run(&self, work: &dyn Fn(&mut T)) {
        let mut state = self.state();
        match std::mem::replace(&mut *state, State::Begun) {
            State::Waiting(mut job) => {
                drop(state);
                work(&mut job);
                *self.state() = State::Done(job);
                self.done.notify_one();
            }
            other => *state = other,
        }
    }

    fn wait(&self) -> T {
        let mut state = self.state();
        loop {
            match std::mem::replace(&mut *state, State::Begun) {
                State::Done(job) => return job,
                other => *state = other,
            }
            state = self.done.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order() {
        let mut jobs = InOrder::new(|number: &mut u64| *number = (0..*number * 1000 % 7919).sum());
        (0..50).for_each(|number| jobs.push(number));
        let results: Vec<u64> = std::iter::from_fn(|| jobs.pop()).collect();
        let expected: Vec<u64> = (0..50).map(|number| (0..number * 1000 % 7919u64).sum()).collect();
        assert_eq!(results, expected);
        assert_eq!(jobs.len(), 0);
    }

    /// Every shared thread waits for a job: whoever waits does it, or this test would not end.
    #[test]
    fn threads_that_all_wait_go_on() {
        rayon::broadcast(|_| {
            let mut jobs = InOrder::new(|number: &mut usize| *number += 1);
            (0..10).for_each(|number| jobs.push(number));
            let results: Vec<usize> = std::iter::from_fn(|| jobs.pop()).collect();
            assert_eq!(results, (1..11).collect::<Vec<usize>>());
        });
    }
}
