//! Groups around a weld: chains of triangles of one handedness.
//!
//! Most welds have one group, whose fan is the row of all corners; nothing is written for them.

use super::Fabric;
use super::faces::Role;
use super::rings::{NONE, Ring};
use super::spokes::{Spoke, find_plain_fans};
use super::subgroups::{Member, subgroups};
use rayon::prelude::*;
use std::ops::Range;

/// Fans of welds whose row of corners is not one fan as it stands.
#[derive(Default)]
pub(super) struct Divided {
    /// The weld of each fan; those of one weld follow each other.
    pub welds: Vec<u32>,
    /// Where each fan's row ends in `corners`.
    ends: Vec<u32>,
    /// The corners that contribute to each fan, ascending.
    corners: Vec<u32>,
    /// Corners, and the fans that they take their tangents from.
    pub members: Vec<(u32, u32)>,
}

impl Divided {
    /// The corners that contribute to a fan.
    pub fn row(&self, fan: usize) -> &[u32] {
        let begin = fan.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.corners[begin as usize..self.ends[fan] as usize]
    }

    /// One more fan.
    fn add(&mut self, weld: u32, corners: impl IntoIterator<Item = u32>) -> u32 {
        self.corners.extend(corners);
        self.ends.push(self.corners.len() as u32);
        self.welds.push(weld);
        self.welds.len() as u32 - 1
    }
}

/// Welds of one task.
const WELDS: usize = 4096;
/// Welds whose corners are read at once.
const BLOCK: usize = 64;

/// The fans of all welds whose corners are not one fan as they stand, in ascending order.
pub(super) fn divide(fabric: &Fabric<'_>) -> Vec<Divided> {
    let welds = fabric.rows.rows();
    let parts = (0..welds.div_ceil(WELDS)).into_par_iter().map_init(Workspace::default, |workspace, part| {
        let mut divided = Divided::default();
        let end = welds.min((part + 1) * WELDS);
        for begin in (part * WELDS..end).step_by(BLOCK) {
            workspace.divide_block(fabric, begin..end.min(begin + BLOCK), &mut divided);
        }
        divided
    });
    parts.filter(|divided| !divided.welds.is_empty()).collect()
}

#[derive(Default)]
struct Workspace {
    /// Of the corners of a block of welds.
    spokes: Vec<Spoke>,
    ring: Ring,
    /// The group of each corner of the ring.
    groups: Vec<u32>,
    count: u32,
    /// The members of one group after the other.
    sorted: Vec<Member>,
}

impl Workspace {
    fn divide_block(&mut self, fabric: &Fabric<'_>, welds: Range<usize>, divided: &mut Divided) {
        let offsets = &fabric.rows.offsets()[welds.start..=welds.end];
        let corners = offsets[0] as usize..offsets[offsets.len() - 1] as usize;
        // A short loop, of which the processor runs many turns at once: it waits for memory.
        self.spokes.clear();
        self.spokes.extend(fabric.rows.corners()[corners].iter().map(|&corner| Spoke::of(fabric, corner)));
        let mut is_plain = [false; BLOCK];
        find_plain_fans(fabric, welds.start as u32, offsets, &self.spokes, &mut is_plain);
        for (weld, is_plain) in (welds.start as u32..welds.end as u32).zip(is_plain) {
            let is_exempt = fabric.last.as_ref().is_some_and(|last| last.concerns(weld));
            if is_exempt || !is_plain {
                self.divide(fabric, weld, divided);
            }
        }
    }

    fn divide(&mut self, fabric: &Fabric<'_>, weld: u32, divided: &mut Divided) {
        let row = fabric.rows.row(weld as usize);
        self.ring.set(fabric, weld);
        self.find_groups(fabric);
        if !self.is_one_fan(fabric, weld, row) {
            self.add_fans(fabric, weld, row, divided);
        }
    }

    /// A group is a chain of corners over paired edges, all of one handedness, with at least one that is directed.
    fn find_groups(&mut self, fabric: &Fabric<'_>) {
        let face = |at: usize| &fabric.faces[self.ring.corners[at] as usize / 3];
        self.groups.clear();
        self.groups.resize(self.ring.len(), NONE);
        self.count = 0;
        for start in 0..self.ring.len() {
            let is_positive = face(start).is_positive;
            if self.groups[start] != NONE || face(start).role != Role::Directed {
                continue;
            }
            self.groups[start] = self.count;
            for links in [&self.ring.next, &self.ring.previous] {
                let mut at = links[start];
                while at != NONE && self.groups[at as usize] == NONE && face(at as usize).is_positive == is_positive {
                    self.groups[at as usize] = self.count;
                    at = links[at as usize];
                }
            }
            self.count += 1;
        }
    }

    /// Whether all corners are directed, in one group and far from opposite.
    fn is_one_fan(&self, fabric: &Fabric<'_>, weld: u32, row: &[u32]) -> bool {
        let face = |corner: u32| &fabric.faces[corner as usize / 3];
        let agree = || {
            let first = face(row[0]).projected(fabric.normal(weld));
            row.iter().all(|&corner| face(corner).role == Role::Directed && face(corner).agrees(&first))
        };
        self.count == 1 && self.ring.len() == row.len() && self.groups.iter().all(|&group| group == 0) && agree()
    }

    fn add_fans(&mut self, fabric: &Fabric<'_>, weld: u32, row: &[u32], divided: &mut Divided) {
        let role = |corner: u32| fabric.faces[corner as usize / 3].role;
        self.sorted.clear();
        self.sorted.extend(self.ring.corners.iter().zip(&self.groups).map(|(&corner, &group)| Member {
            group,
            corner,
            is_directed: role(corner) == Role::Directed,
        }));
        self.sorted.sort_unstable();
        let first_member = divided.members.len();
        let is_group = |members: &&[Member]| members[0].group != NONE;
        for members in self.sorted.chunk_by(|a, b| a.group == b.group).filter(is_group) {
            add_group(fabric, weld, members, divided);
        }

        let mut empty = None;
        for member in self.sorted.iter().filter(|member| member.group == NONE) {
            let fan = *empty.get_or_insert_with(|| divided.add(weld, []));
            divided.members.push((member.corner, fan));
        }
        // Corners of degenerate triangles take the tangent of the weld's first other corner.
        let first = self.ring.corners.first();
        let members = &divided.members[first_member..];
        let copied = first.and_then(|&first| members.iter().find(|member| member.0 == first)).map(|member| member.1);
        for &corner in row.iter().filter(|&&corner| role(corner) == Role::Degenerate) {
            let fan = copied.unwrap_or_else(|| *empty.get_or_insert_with(|| divided.add(weld, [])));
            divided.members.push((corner, fan));
        }
    }
}

/// Adds the fan of a group, or those of its subgroups.
fn add_group(fabric: &Fabric<'_>, weld: u32, members: &[Member], divided: &mut Divided) {
    let n = fabric.normal(weld);
    let face = |corner: u32| &fabric.faces[corner as usize / 3];
    let directed = || members.iter().filter(|member| member.is_directed).map(|member| member.corner);
    let Some(first) = directed().next() else { return };
    let projected = face(first).projected(n);
    if directed().all(|corner| face(corner).agrees(&projected)) {
        let fan = divided.add(weld, directed());
        divided.members.extend(members.iter().map(|member| (member.corner, fan)));
    } else {
        let fans = subgroups(fabric.surface, n, members, |corners| divided.add(weld, corners));
        divided.members.extend(fans);
    }
}
