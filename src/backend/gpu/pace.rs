//! How much a device computes in one submission: so little that no driver takes the device for hung.

use super::kernel::Kernel;
use super::lock::lock;
use std::collections::{HashMap, VecDeque};
use std::sync::Mutex;
use std::time::{Duration, Instant};
use wgpu::SubmissionIndex;

/// A submission that takes longer is followed by smaller ones. Drivers reset a device after two seconds, and whoever
/// else draws with it waits meanwhile.
const LONGEST: Duration = Duration::from_millis(50);

/// What a submission computes.
#[derive(Debug, Clone)]
pub(super) struct Work {
    pub kernel: Kernel,
    /// Texels, triangles or fans.
    pub items: usize,
}

/// Commands on their way through the queue of a device.
#[derive(Debug, Clone)]
pub(super) struct Submission {
    pub index: SubmissionIndex,
    /// Counted from 1, in the order of the queue.
    number: u64,
}

/// A submission whose end nobody has seen.
#[derive(Debug)]
pub(super) struct UnderWay {
    pub submission: Submission,
    /// `None`: it only copies.
    work: Option<Work>,
    begun: Instant,
    /// How long it took to submit: to compute, on drivers that do it there and then.
    submitting: Duration,
}

/// The queue of a device as it is seen from outside, and what that says of each kernel's speed.
#[derive(Debug)]
pub(super) struct Pace {
    /// How long a submission may take.
    pub longest: Duration,
    seen: Mutex<Seen>,
}

#[derive(Debug, Default)]
struct Seen {
    /// The most items of a submission of each kernel; absent before its first one has ended.
    most: HashMap<Kernel, usize>,
    /// In the order of the queue.
    under_way: VecDeque<UnderWay>,
    /// Submissions so far.
    count: u64,
    /// When the latest end was seen.
    latest_end: Option<Instant>,
    /// All that was computed, for tests.
    #[cfg(test)]
    all: Vec<Work>,
}

impl Default for Pace {
    fn default() -> Self {
        Self { longest: LONGEST, seen: Mutex::default() }
    }
}

impl Pace {
    /// The most items of a submission.
    pub fn most_items(&self, kernel: &Kernel) -> usize {
        lock(&self.seen).most.get(kernel).copied().unwrap_or(usize::MAX)
    }

    /// Submits commands that compute `work`, or only copy.
    pub fn begin(&self, work: Option<Work>, submit: impl FnOnce() -> SubmissionIndex) -> Submission {
        // Locked meanwhile: what is under way stands in the order of the queue.
        let mut seen = lock(&self.seen);
        seen.count += 1;
        let begun = Instant::now();
        let submission = Submission { number: seen.count, index: submit() };
        let submitting = begun.elapsed();
        #[cfg(test)]
        seen.all.extend(work.clone());
        seen.under_way.push_back(UnderWay { submission: submission.clone(), work, begun, submitting });
        submission
    }

    /// Items of all submissions with an entry point, in the queue's order.
    #[cfg(test)]
    pub fn submitted(&self, entry_point: &str) -> Vec<usize> {
        let seen = lock(&self.seen);
        seen.all.iter().filter(|work| work.kernel.source.entry_point == entry_point).map(|work| work.items).collect()
    }

    /// The next submission whose end is to be seen, up to this one.
    pub fn next_until(&self, last: &Submission) -> Option<UnderWay> {
        let under_way = &mut lock(&self.seen).under_way;
        under_way.front().is_some_and(|next| next.submission.number <= last.number).then(|| under_way.pop_front())?
    }

    /// A submission has ended: now, or before anybody looked.
    pub fn end(&self, UnderWay { work, begun, submitting, .. }: UnderWay, is_now: bool) {
        let now = Instant::now();
        let mut seen = lock(&self.seen);
        let idle_since = seen.latest_end.map_or(begun, |end| end.max(begun));
        seen.latest_end = Some(now);
        let Some(work) = work else { return };
        // The end before it may have been seen late, so it may have had the device for longer than since then.
        let at_least = if is_now { submitting.max(now.duration_since(idle_since)) } else { submitting };
        seen.judge(work, at_least, now.duration_since(begun), self.longest);
    }
}

impl Seen {
    fn judge(&mut self, Work { kernel, items }: Work, at_least: Duration, at_most: Duration, longest: Duration) {
        // A kernel's first submission may have waited for the driver to compile it.
        let Some(most) = self.most.get_mut(&kernel) else {
            self.most.insert(kernel, usize::MAX);
            return;
        };
        if at_least >= longest {
            *most = (items / 2).min(*most);
        } else if at_most < longest / 4 && items > *most / 2 {
            // Another one was slow for another reason: the device was busy with something else.
            *most = most.saturating_mul(2);
        }
    }
}
