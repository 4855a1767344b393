//! The triangles around a welded vertex, linked over the edges they share.
//!
//! The reference goes through all edges between two welds in the order of their triangles; each that has no partner
//! takes the first one after it that has none either and runs the other way. Both ends of an edge see the same edges
//! in the same order, so each finds the same partners on its own.

use super::Fabric;
use super::faces::Role;

/// No corner.
pub(super) const NONE: u32 = u32::MAX;

/// The corners at a weld, without those of degenerate triangles.
#[derive(Default)]
pub(super) struct Ring {
    /// Ascending.
    pub corners: Vec<u32>,
    /// The weld that the edge from each corner leads to.
    to: Vec<u32>,
    /// The weld that the edge to each corner comes from.
    from: Vec<u32>,
    /// Which of the corners lies across the edge from each corner.
    pub next: Vec<u32>,
    /// Which of the corners lies across the edge to each corner.
    pub previous: Vec<u32>,
    events: Vec<(u32, u32, bool)>,
}

/// Up to this many corners, comparing each with each takes less time than sorting.
const FEW: usize = 24;

impl Ring {
    /// Takes the corners at a weld and links them.
    #[inline]
    pub fn set(&mut self, fabric: &Fabric<'_>, weld: u32) {
        self.corners.clear();
        self.to.clear();
        self.from.clear();
        for &corner in fabric.rows.row(weld as usize) {
            if fabric.faces[corner as usize / 3].role != Role::Degenerate {
                let [to, from] = fabric.welds.beside(corner);
                self.corners.push(corner);
                self.to.push(to);
                self.from.push(from);
            }
        }
        self.next.clear();
        self.next.resize(self.corners.len(), NONE);
        self.previous.clear();
        self.previous.resize(self.corners.len(), NONE);
        if self.corners.len() <= FEW {
            self.link_few()
        } else {
            self.link_many()
        }
        if let Some(last) = fabric.last.as_ref().filter(|last| last.concerns(weld)) {
            self.relink(weld, last);
        }
    }

    pub fn len(&self) -> usize {
        self.corners.len()
    }

    #[inline(always)]
    fn link(&mut self, from: usize, to: usize) {
        self.next[from] = to as u32;
        self.previous[to] = from as u32;
    }

    #[inline(always)]
    fn link_few(&mut self) {
        for late in 0..self.len() {
            let (to, from) = (self.to[late], self.from[late]);
            if let Some(early) = (0..late).find(|&early| self.from[early] == to && self.previous[early] == NONE) {
                self.link(late, early);
            }
            if let Some(early) = (0..late).find(|&early| self.to[early] == from && self.next[early] == NONE) {
                self.link(early, late);
            }
        }
    }

    /// The same in less than quadratic time.
    fn link_many(&mut self) {
        let mut events = std::mem::take(&mut self.events);
        events.clear();
        events.extend((0..).zip(&self.to).map(|(corner, &to)| (to, corner, true)));
        events.extend((0..).zip(&self.from).map(|(corner, &from)| (from, corner, false)));
        events.sort_unstable();
        for edges in events.chunk_by(|a, b| a.0 == b.0) {
            pair(edges.iter().map(|&(_, corner, leaves)| (corner, leaves)), |leaving, coming| {
                self.link(leaving as usize, coming as usize);
            });
        }
        self.events = events;
    }

    /// Replaces links over edges that the reference pairs in an order of its own.
    fn relink(&mut self, weld: u32, last: &super::LastEdges) {
        for corner in 0..self.len() {
            let next = self.next[corner];
            if next != NONE && last.includes(weld, self.to[corner]) {
                self.next[corner] = NONE;
                self.previous[next as usize] = NONE;
            }
        }
        for (from, to) in last.links(weld) {
            let of = |triangle: u32| self.corners.binary_search_by_key(&triangle, |corner| corner / 3);
            if let (Ok(from), Ok(to)) = (of(from), of(to)) {
                self.link(from, to);
            }
        }
    }
}

/// Pairs edges between two welds, given in order with whether they run the one way: `(one way, other way)`.
pub(super) fn pair(edges: impl Iterator<Item = (u32, bool)>, mut found: impl FnMut(u32, u32)) {
    // Edges without a partner all run the same way.
    let mut waiting = std::collections::VecDeque::new();
    let mut way = true;
    for (edge, its_way) in edges {
        match waiting.front() {
            Some(&first) if its_way != way => {
                waiting.pop_front();
                if its_way { found(edge, first) } else { found(first, edge) }
            }
            _ => {
                way = its_way;
                waiting.push_back(edge);
            }
        }
    }
}
