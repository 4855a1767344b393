//! Jobs that any thread may do, and whose results come in order.
//!
//! The threads are those that all of the process share (rayon's). They may all be waiting for this very file, where a
//! caller bakes on them; so whoever waits for a job that nobody has begun does it.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What makes a result of a job.
type Work<J, R> = Arc<dyn Fn(J) -> R + Send + Sync>;

/// Bytes of jobs that may be on their way at a time; one job may be more.
const WAITING_BYTES: usize = 16 << 20;

/// Jobs on their way, the oldest first.
pub(super) struct InOrder<J, R> {
    tasks: VecDeque<Arc<Task<J, R>>>,
    most: usize,
    work: Work<J, R>,
}

struct Task<J, R> {
    state: Mutex<State<J, R>>,
    done: Condvar,
}

enum State<J, R> {
    Waiting(J),
    Begun,
    /// The result, or the panic of the work: it is that of who asks for the result, not of the thread that had it.
    Done(std::thread::Result<R>),
}

impl<J: Send + 'static, R: Send + 'static> InOrder<J, R> {
    /// Jobs of about `job_bytes` each that are done by `work`.
    pub fn new(job_bytes: usize, work: impl Fn(J) -> R + Send + Sync + 'static) -> Self {
        let most = (WAITING_BYTES / job_bytes.max(1)).clamp(1, rayon::current_num_threads());
        Self { tasks: VecDeque::new(), most, work: Arc::new(work) }
    }

    /// Jobs that may be on their way when the next one is pushed: each thread has one, and together they are small.
    pub fn most(&self) -> usize {
        self.most
    }

    /// Adds a job, for whichever thread is free.
    pub fn push(&mut self, job: J) {
        let task = Arc::new(Task { state: Mutex::new(State::Waiting(job)), done: Condvar::new() });
        self.tasks.push_back(task.clone());
        let work = self.work.clone();
        rayon::spawn(move || task.run(&*work));
    }

    /// The result of the oldest job once it is done, if there are more than may be on their way.
    pub fn pop_surplus(&mut self) -> Option<R> {
        if self.tasks.len() > self.most { self.pop() } else { None }
    }

    /// The result of the oldest job once it is done; `None` if there is none.
    pub fn pop(&mut self) -> Option<R> {
        let task = self.tasks.pop_front()?;
        task.run(&*self.work);
        Some(task.wait().unwrap_or_else(|panic| resume_unwind(panic)))
    }
}

impl<J, R> Drop for InOrder<J, R> {
    /// Whoever gives up, as a file that failed, leaves no work behind, and no memory that others count as free.
    fn drop(&mut self) {
        for task in self.tasks.drain(..) {
            if !task.withdraw() {
                let _ = task.wait();
            }
        }
    }
}

impl<J, R> Task<J, R> {
    fn state(&self) -> MutexGuard<'_, State<J, R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does the job if nobody has begun it.
    fn run(&self, work: &dyn Fn(J) -> R) {
        let mut state = self.state();
        match std::mem::replace(&mut *state, State::Begun) {
            State::Waiting(job) => {
                drop(state);
                let result = catch_unwind(AssertUnwindSafe(|| work(job)));
                *self.state() = State::Done(result);
                self.done.notify_one();
            }
            other => *state = other,
        }
    }

    /// Sees to it that nobody begins the job; false if somebody has.
    fn withdraw(&self) -> bool {
        let mut state = self.state();
        let is_waiting = matches!(*state, State::Waiting(_));
        if is_waiting {
            *state = State::Begun;
        }
        is_waiting
    }

    /// Waits for the job, which somebody has begun.
    fn wait(&self) -> std::thread::Result<R> {
        let mut state = self.state();
        loop {
            match std::mem::replace(&mut *state, State::Begun) {
                State::Done(result) => return result,
                other => *state = other,
            }
            state = self.done.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};

    #[test]
    fn results_come_in_order() {
        let mut jobs = InOrder::new(8, |number: u64| (0..number * 1000 % 7919).sum());
        (0..50).for_each(|number| jobs.push(number));
        let results: Vec<u64> = std::iter::from_fn(|| jobs.pop()).collect();
        let expected: Vec<u64> = (0..50).map(|number| (0..number * 1000 % 7919u64).sum()).collect();
        assert_eq!(results, expected);
    }

    #[test]
    fn large_jobs_do_not_wait_in_numbers() {
        let mut jobs = InOrder::new(WAITING_BYTES, |number: u32| number);
        assert_eq!(jobs.most(), 1);
        jobs.push(1);
        assert_eq!(jobs.pop_surplus(), None);
        jobs.push(2);
        assert_eq!([jobs.pop_surplus(), jobs.pop_surplus(), jobs.pop()], [Some(1), None, Some(2)]);
    }

    /// Every shared thread waits for a job: whoever waits does it, or this test would not end.
    #[test]
    fn threads_that_all_wait_go_on() {
        rayon::broadcast(|_| {
            let mut jobs = InOrder::new(8, |number: usize| number + 1);
            (0..10).for_each(|number| jobs.push(number));
            let results: Vec<usize> = std::iter::from_fn(|| jobs.pop()).collect();
            assert_eq!(results, (1..11).collect::<Vec<usize>>());
        });
    }

    /// The first job holds the only thread until all others were pushed.
    #[test]
    fn what_is_given_up_is_not_done() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let begun = Arc::new(AtomicUsize::new(0));
        pool.install(|| {
            let counter = begun.clone();
            let mut jobs = InOrder::new(8, move |_: u32| counter.fetch_add(1, SeqCst));
            (0..10).for_each(|number| jobs.push(number));
            assert_eq!(jobs.pop(), Some(0));
        });
        // What the pool still has of them comes before this.
        pool.install(|| assert_eq!(begun.load(SeqCst), 1));
    }

    #[test]
    fn a_panic_is_that_of_who_waits() {
        let mut jobs = InOrder::new(8, |number: u32| 6 / number);
        [1, 0, 2].into_iter().for_each(|number| jobs.push(number));
        assert_eq!(jobs.pop(), Some(6));
        assert!(catch_unwind(AssertUnwindSafe(|| jobs.pop())).is_err());
        assert_eq!(jobs.pop(), Some(3));
    }
}
