//! Tangents in two passes over blocks: what each triangle gives, then what each fan makes of it.
//!
//! ```text
//! triangles -> gathered, planar -> formulas in lanes -> given, one row for each triangle
//! fans -> sums of given in the order of their rows, planar -> formulas in lanes -> tangents
//! ```
//!
//! The formulas are the reference's own, compiled for several instruction sets.

mod frames;
mod mikktspace;

use crate::ops::tangents::{BLOCK, TangentMethod, TangentPlan};
use rayon::prelude::*;

/// Blocks that take one thread less time than it takes to wake others: some 20 microseconds.
const FEW: usize = 32;

/// Whether a plan is worth more than one thread.
pub(super) fn is_large(plan: &TangentPlan<'_>) -> bool {
    plan.surface.triangles.len().max(plan.fans.count()) > FEW * BLOCK
}

/// The tangent of each fan, and its handedness as to growing v; zero where no direction is left.
pub(super) fn tangents(plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) {
    match plan.method {
        TangentMethod::Mikktspace => mikktspace::tangents(plan, tangents),
        TangentMethod::Lengyel => frames::tangents(frames::lengyel, plan, tangents),
        TangentMethod::Hegde => frames::tangents(frames::hegde, plan, tangents),
    }
}

/// What is made of each block of `count`: `make` is told the first of the block, and has room to work in.
fn of_blocks<R: Default, T: Send>(count: usize, make: impl Fn(&mut R, usize) -> T + Sync) -> Vec<T> {
    let blocks = count.div_ceil(BLOCK);
    let of_block = |room: &mut R, block| make(room, block * BLOCK);
    if blocks <= FEW {
        let mut room = R::default();
        (0..blocks).map(|block| of_block(&mut room, block)).collect()
    } else {
        (0..blocks).into_par_iter().map_init(R::default, of_block).collect()
    }
}

/// Fills blocks of tangents: `fill` is told the first of the block.
fn fill_blocks(tangents: &mut [[f32; 4]], fill: impl Fn(usize, &mut [[f32; 4]]) + Sync) {
    let fill = |(block, tangents): (usize, &mut [[f32; 4]])| fill(block * BLOCK, tangents);
    if tangents.len() <= FEW * BLOCK {
        tangents.chunks_mut(BLOCK).enumerate().for_each(fill);
    } else {
        tangents.par_chunks_mut(BLOCK).enumerate().for_each(fill);
    }
}
