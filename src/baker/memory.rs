//! What a job holds in memory.

use crate::backend::{Backend, RowBytes};
use crate::map::Maps;
use crate::mips;
use crate::ops::bake::BakePlan;
use crate::stream::{BUFFERS, MapOut, RowsOut};
use rayon::ThreadPool;

/// Rows of heights beside those of a band: its halo, what it has in common with the next one, and both ends of a map
/// that wraps.
const BESIDE: usize = 4;

/// What a job needs whatever the size of its maps: the stacks of its threads, the tables and windows of deflate, the
/// bytes of files that are read and written.
const FIXED_BYTES: usize = 2 << 20;

/// The most bytes that a job holds while a map of `height` rows passes through `backend` into `sinks`, without what the
/// sources hold.
pub(super) fn job_bytes<'a>(
    backend: &dyn Backend,
    row: RowBytes,
    height: usize,
    sinks: impl IntoIterator<Item = &'a RowsOut>,
) -> u64 {
    let rows = backend.band_rows(row).min(height);
    let bands = BUFFERS * ((rows + BESIDE) * row.read + rows * row.written);
    let held_by_sinks: u64 = sinks.into_iter().map(|sink| sink.held_bytes(rows)).sum();
    (FIXED_BYTES + bands) as u64 + backend.held_bytes(row) + held_by_sinks
}

/// The same of a bake, with the smaller levels of its maps.
pub(super) fn bake_bytes(backend: &dyn Backend, plan: &BakePlan, maps: &Maps<MapOut>) -> u64 {
    let threads = backend.host_threads().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
    let sinks = maps.iter().map(|map| &map.rows);
    job_bytes(backend, RowBytes::of_bake(plan), plan.size.height(), sinks) + mips::held_bytes(plan, maps, threads)
}
