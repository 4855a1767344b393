//! What a job holds in memory.

use crate::backend::{Backend, RowBytes};
use crate::mips::{self, LevelsOut};
use crate::ops::bake::{BakeOptions, BakePlan};
use crate::stream::{BUFFERS, RowsOut};
use rayon::ThreadPool;

/// Rows of heights beside those of a band: its halo, what it has in common with the next one, and both ends of a map
/// that wraps.
const BESIDE: usize = 4;

/// What a job needs whatever the size of its maps: the stacks of its threads, the tables and windows of deflate, the
/// bytes of files that are read and written.
const FIXED_BYTES: usize = 2 << 20;

/// The most bytes that a job holds while a map of `height` rows passes through `backend` into `sinks`, without what the
/// sources hold.
pub(super) fn job_bytes(backend: &dyn Backend, row: RowBytes, height: usize, sinks: &[RowsOut]) -> u64 {
    let rows = backend.band_rows(row).min(height);
    let bands = BUFFERS * ((rows + BESIDE) * row.read + rows * row.written);
    let held_by_sinks: u64 = sinks.iter().map(|sink| sink.held_bytes(rows)).sum();
    (FIXED_BYTES + bands) as u64 + backend.held_bytes(row) + held_by_sinks
}

/// The most bytes that a bake holds besides for the smaller levels of its maps, those of its roughness map last, and for
/// the rows of that map.
pub(super) fn beside_bytes(
    backend: &dyn Backend,
    plan: &BakePlan,
    options: &BakeOptions,
    levels: &[LevelsOut<'_>],
) -> u64 {
    let threads = backend.host_threads().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads);
    let rows = backend.band_rows(RowBytes::of_bake(plan)).min(plan.size.height());
    let texel_bytes = options.roughness.map_or(0, |options| options.format.texel().bytes());
    let roughness_rows = BUFFERS * rows * plan.size.width() * texel_bytes;
    mips::held_bytes(plan, levels, options.roughness.as_ref(), threads) + roughness_rows as u64
}
