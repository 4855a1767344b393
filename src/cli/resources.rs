//! What a run may take of the machine.

use super::values::{ByteSize, count, value};
use clap::Args;
use std::num::NonZeroUsize;
use texbake::stream::Monitor;
use texbake::{Error, Result};

/// Cores and memory of a run.
#[derive(Args, Debug)]
pub struct Resources {
    /// Cores that the run takes; elsewhere than on Linux, threads that bake and compress [default: all]
    #[arg(long, value_name = "N", value_parser = count, allow_hyphen_values = true, help_heading = HEADING)]
    pub threads: Option<NonZeroUsize>,

    /// Most memory of the run: 512M, 2G. Files wait for each other; one that needs more by itself fails
    /// [default: unbounded]
    #[arg(long, value_name = "BYTES", value_parser = value::<ByteSize>, allow_hyphen_values = true)]
    #[arg(help_heading = HEADING)]
    pub memory: Option<ByteSize>,
}

const HEADING: &str = "Where it runs";

/// What the process takes besides rows and what it has already: stacks of threads, and what the allocator keeps.
const BESIDE_ROWS: u64 = 8 << 20;

impl Resources {
    /// Keeps the run to its cores, and starts the threads that bake and compress; the first thing of a run, since
    /// threads may run where the one that starts them may.
    ///
    /// # Errors
    /// [`Error::Threads`] if the system refuses.
    pub fn start_threads(&self) -> Result<()> {
        let Some(threads) = self.threads else { return Ok(()) };
        let refused = |reason: String| Error::Threads { reason };
        #[cfg(target_os = "linux")]
        keep_to_cores(threads.get()).map_err(|error| refused(error.to_string()))?;
        let cores = std::thread::available_parallelism().unwrap_or(threads);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.min(cores).get()).build_global();
        pool.map_err(|error| refused(error.to_string()))
    }

    /// What watches the bakes of the run, and bounds their memory; called once devices are open, since what they took
    /// counts.
    ///
    /// # Errors
    /// [`Error::Parameter`] if nothing is left for rows.
    pub fn monitor(&self) -> Result<Monitor> {
        let Some(ByteSize(bytes)) = self.memory else { return Ok(Monitor::default()) };
        give_back_at_once();
        let resident = memory_stats::memory_stats().map_or(0, |stats| stats.physical_mem as u64);
        let taken = resident + BESIDE_ROWS;
        if bytes <= taken {
            let range = format!("above {}M, which the program takes before any file", taken.div_ceil(1 << 20));
            let value = format!("{}M", bytes.div_ceil(1 << 20));
            return Err(Error::Parameter { parameter: "memory", value, range });
        }
        Ok(Monitor::with_memory(bytes, taken))
    }
}

/// Makes the allocator give large buffers back to the system when they are freed. It would keep those of up to 32 MiB,
/// for each thread: a run that was bounded to 44 MiB came to 82.
fn give_back_at_once() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        // Smaller ones are reused before they grow to much.
        const LARGE: libc::c_int = 256 << 10;
        // SAFETY: it changes a number of the allocator, under the allocator's lock.
        #[allow(unsafe_code, reason = "no safe interface to the allocator's options; measured above")]
        let _ = unsafe { libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE) };
    }
}

/// Lets the process, with the threads of its files, its libraries and drivers, run on `count` of its cores, chosen by
/// chance: several processes with fewer cores than there are rarely choose the same.
#[cfg(target_os = "linux")]
fn keep_to_cores(count: usize) -> rustix::io::Result<()> {
    use rustix::thread::{CpuSet, sched_getaffinity, sched_setaffinity};
    use std::hash::{BuildHasher, RandomState};
    let allowed = sched_getaffinity(None)?;
    let mut cores: Vec<usize> = (0..CpuSet::MAX_CPU).filter(|core| allowed.is_set(*core)).collect();
    // Its keys are random.
    let chance = RandomState::new();
    cores.sort_by_cached_key(|core| chance.hash_one(core));
    let mut chosen = CpuSet::new();
    cores.into_iter().take(count).for_each(|core| chosen.set(core));
    sched_setaffinity(None, &chosen)
}
