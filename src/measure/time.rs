//! How long work takes.

use std::time::{Duration, Instant};

/// The median of how long `work` takes, of `runs` runs after one that is not counted; of an even number the mean of the
/// two in the middle.
pub(crate) fn median_time(runs: usize, mut work: impl FnMut()) -> Duration {
    work();
    let mut times = Vec::new();
    for _ in 0..runs.max(1) {
        let start = Instant::now();
        work();
        times.push(start.elapsed());
    }
    median(times)
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    (times[(times.len() - 1) / 2] + times[times.len() / 2]) / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_the_median() {
        let of = |times: &[u64]| median(times.iter().map(|&time| Duration::from_millis(time)).collect());
        assert_eq!([of(&[7]), of(&[9, 1, 2]), of(&[9, 1])].map(|time| time.as_millis()), [7, 2, 5]);
    }
}
