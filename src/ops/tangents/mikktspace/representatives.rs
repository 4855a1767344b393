//! Which corner the reference's welding puts in the place of all equal ones.
//!
//! It is not the lowest one. Corners go into 2048 buckets along the longest axis; each bucket is halved again and
//! again along its longest axis by swapping corners on the wrong sides, and where it cannot be halved any more the
//! first in that order represents its equals. Only the order of the last edges depends on it ([`super::LastEdges`]),
//! so it is found for a few buckets, if any.

use super::Fabric;
use super::faces::Role;
use super::rings::NONE;
use rayon::prelude::*;

const BUCKETS: u16 = 2048;

/// The bucket of each weld, and what is known of representatives.
pub(super) struct Representatives<'a> {
    fabric: &'a Fabric<'a>,
    buckets: Vec<u16>,
    corners: Vec<u32>,
}

/// A corner on its way through the halvings.
#[derive(Clone, Copy)]
struct Slot {
    position: [f32; 3],
    corner: u32,
    /// Its weld, or [`NONE`] if that is not wanted.
    weld: u32,
}

impl<'a> Representatives<'a> {
    pub fn new(fabric: &'a Fabric<'a>) -> Self {
        let welds = fabric.rows.rows() as u32;
        let position = |weld: u32| fabric.surface.position(fabric.welds.vertex(weld));
        let used = (0..welds).into_par_iter().filter(|&weld| !fabric.rows.row(weld as usize).is_empty());
        let (least, greatest) = used
            .map(|weld| (position(weld), position(weld)))
            .reduce(|| ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |a, b| (least(a.0, b.0), greatest(a.1, b.1)));
        let axis = longest_axis(least, greatest);
        let (origin, length) = (least[axis], greatest[axis] - least[axis]);
        let bucket = |weld| {
            let place = (position(weld)[axis] - origin) / length;
            ((f32::from(BUCKETS) * place.clamp(0.0, 1.0)) as u16).min(BUCKETS - 1)
        };
        Self { fabric, buckets: (0..welds).into_par_iter().map(bucket).collect(), corners: vec![NONE; welds as usize] }
    }

    /// The representative of each of the welds that were looked up; else [`NONE`].
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Finds the representatives of all welds.
    pub fn look_up_all(&mut self) {
        self.look_up(0..self.buckets.len() as u32);
    }

    /// Finds the representatives of some welds.
    pub fn look_up(&mut self, welds: impl IntoIterator<Item = u32>) {
        let mut is_wanted = vec![false; self.buckets.len()];
        let mut has_wanted = vec![false; BUCKETS.into()];
        for weld in welds.into_iter().filter(|&weld| self.corners[weld as usize] == NONE) {
            is_wanted[weld as usize] = true;
            has_wanted[usize::from(self.buckets[weld as usize])] = true;
        }
        let mut welds: Vec<(u16, u32)> = (self.buckets.par_iter().copied().zip(0..self.buckets.len() as u32))
            .filter(|&(bucket, _)| has_wanted[usize::from(bucket)])
            .collect();
        welds.par_sort_unstable();
        let buckets = welds.par_chunk_by(|a, b| a.0 == b.0);
        let found: Vec<(u32, u32)> =
            buckets.flat_map_iter(|bucket| first_corners(self.fabric, bucket, &is_wanted)).collect();
        for (weld, corner) in found {
            self.corners[weld as usize] = corner;
        }
    }
}

/// The wanted welds of a bucket, and their representatives.
fn first_corners(fabric: &Fabric<'_>, bucket: &[(u16, u32)], is_wanted: &[bool]) -> Vec<(u32, u32)> {
    // Degenerate triangles come after all others.
    let order = |corner: u32| {
        let is_degenerate = fabric.faces[corner as usize / 3].role == Role::Degenerate;
        u64::from(is_degenerate) << 32 | u64::from(corner)
    };
    let of_weld = |&(_, weld): &(u16, u32)| {
        let corners = fabric.rows.row(weld as usize).iter();
        corners.map(move |&corner| (order(corner), weld))
    };
    let mut corners: Vec<(u64, u32)> = bucket.iter().flat_map(of_weld).collect();
    corners.sort_unstable();
    let slot = |&(order, weld): &(u64, u32)| Slot {
        position: fabric.surface.position(fabric.welds.vertex(weld)),
        corner: order as u32,
        weld: if is_wanted[weld as usize] { weld } else { NONE },
    };
    let mut slots: Vec<Slot> = corners.iter().map(slot).collect();
    let mut found = Vec::new();
    halve(&mut slots, &mut found);
    found
}

/// Halves a bucket until nothing is strictly between its bounds, as far as it holds wanted welds.
///
/// The bounds' distance halves with each three calls, so the recursion ends after hundreds at most.
fn halve(slots: &mut [Slot], found: &mut Vec<(u32, u32)>) {
    if slots.iter().all(|slot| slot.weld == NONE) {
        return;
    }
    let first = slots[0].position;
    let (least, greatest) = slots
        .iter()
        .fold((first, first), |(low, high), slot| (least(low, slot.position), greatest(high, slot.position)));
    let axis = longest_axis(least, greatest);
    let middle = 0.5 * (greatest[axis] + least[axis]);
    if !(least[axis] < middle && middle < greatest[axis]) {
        let begin = found.len();
        found.extend(slots.iter().filter(|slot| slot.weld != NONE).map(|slot| (slot.weld, slot.corner)));
        // The sort is stable, so the first of equals stays the first.
        found[begin..].sort_by_key(|&(weld, _)| weld);
        let mut kept = begin;
        for at in begin..found.len() {
            if at == begin || found[at].0 != found[kept - 1].0 {
                found[kept] = found[at];
                kept += 1;
            }
        }
        found.truncate(kept);
        return;
    }
    let (mut below, mut above) = (0, slots.len());
    loop {
        while below < above && slots[below].position[axis] < middle {
            below += 1;
        }
        while below < above && slots[above - 1].position[axis] >= middle {
            above -= 1;
        }
        if below == above {
            break;
        }
        above -= 1;
        slots.swap(below, above);
        below += 1;
    }
    let (low, high) = slots.split_at_mut(below);
    halve(low, found);
    halve(high, found);
}

fn longest_axis(least: [f32; 3], greatest: [f32; 3]) -> usize {
    let [x, y, z] = [0, 1, 2].map(|axis| greatest[axis] - least[axis]);
    if y > x && y > z {
        1
    } else if z > x {
        2
    } else {
        0
    }
}

fn least(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].min(b[2])]
}

fn greatest(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])]
}
