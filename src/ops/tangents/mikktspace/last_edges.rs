//! Edges that the reference pairs in an order of its own, because its sort of edges has a defect.
//!
//! It sorts all edges by their lower end, then each run of equal lower ends by the upper end, then by triangle; but
//! its loops over runs leave out the last one (<https://github.com/mmikk/MikkTSpace/issues/5>). So the edges of the
//! greatest lower end stay in the order in which an unstable quicksort, seeded with a constant, leaves them, and
//! an edge's partner is found only if no edge to another end lies between. Every engine's MikkTSpace does so, hence
//! so does this one: the tangents of a few triangles depend on it.
//!
//! "Lower" is as to the corners that represent welded vertices. To find the greatest lower end, only edges matter
//! whose ends both have high corners; and only where it has edges to more than one end, or more than two to one, is
//! the order worth knowing.

use super::Fabric;
use super::faces::Role;
use super::representatives::Representatives;
use super::rings::{NONE, pair};
use rayon::prelude::*;

/// The edges whose lower end is the greatest, and the partners that the reference finds for them.
#[derive(Debug)]
pub(super) struct LastEdges {
    /// The lower end.
    weld: u32,
    /// The upper ends, ascending.
    others: Vec<u32>,
    /// Two triangles that share an edge with an upper end: in the first one it runs from the lower end to the upper
    /// one. By upper ends.
    pairs: Vec<(u32, [u32; 2])>,
}

impl LastEdges {
    /// `None` if their order does not matter.
    pub fn of(fabric: &Fabric<'_>) -> Option<Self> {
        let mut representatives = Representatives::new(fabric);
        let weld = greatest_lower_end(fabric, &mut representatives)?;
        let mut edges = edges_above(fabric, weld, representatives.corners());
        edges.sort_unstable();
        let runs = || edges.chunk_by(|a, b| a.other == b.other).map(<[Edge]>::len);
        let is_in_order = runs().all(|edges| edges == 1) || (runs().count() == 1 && edges.len() == 2);
        if is_in_order {
            return None;
        }

        representatives.look_up_all();
        let order = reference_order(fabric, representatives.corners(), weld);
        Some(Self::paired(weld, order.into_iter().map(|corner| Edge::of(fabric, weld, corner)).collect()))
    }

    /// Pairs edges as the reference does: within runs, all but the last of which it sorts.
    fn paired(weld: u32, mut edges: Vec<Edge>) -> Self {
        let runs: Vec<usize> = edges.chunk_by(|a, b| a.other == b.other).map(<[Edge]>::len).collect();
        let mut pairs = Vec::new();
        let mut rest = edges.as_mut_slice();
        for (number, &length) in (1..).zip(&runs) {
            let (run, others) = rest.split_at_mut(length);
            rest = others;
            if number < runs.len() {
                run.sort_unstable();
            }
            let other = run[0].other;
            pair(run.iter().map(|edge| (edge.triangle, edge.leaves)), |leaving, coming| {
                pairs.push((other, [leaving, coming]));
            });
        }
        pairs.sort_unstable();
        let mut others: Vec<u32> = edges.iter().map(|edge| edge.other).collect();
        others.sort_unstable();
        others.dedup();
        Self { weld, others, pairs }
    }

    /// Whether a weld is an end of such an edge.
    pub fn concerns(&self, weld: u32) -> bool {
        self.weld == weld || self.others.binary_search(&weld).is_ok()
    }

    /// Whether the edges between two welds are such.
    pub fn includes(&self, weld: u32, other: u32) -> bool {
        (self.weld == weld && self.others.binary_search(&other).is_ok())
            || (self.weld == other && self.others.binary_search(&weld).is_ok())
    }

    /// Pairs of triangles around one of the welds: the edge they share leaves it in the first one.
    pub fn links(&self, weld: u32) -> impl Iterator<Item = (u32, u32)> {
        let is_lower = self.weld == weld;
        let begin = if is_lower { 0 } else { self.pairs.partition_point(|pair| pair.0 < weld) };
        let pairs = self.pairs[begin..].iter().take_while(move |pair| is_lower || pair.0 == weld);
        pairs.map(move |&(_, [leaving, coming])| if is_lower { (leaving, coming) } else { (coming, leaving) })
    }
}

/// An edge at the lower end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// The upper end.
    other: u32,
    triangle: u32,
    /// Whether it runs from the lower end to the upper one.
    leaves: bool,
}

impl Edge {
    /// The edge from a corner to the next one.
    fn of(fabric: &Fabric<'_>, weld: u32, corner: u32) -> Self {
        let (from, [to, _]) = (fabric.welds.of(corner), fabric.welds.beside(corner));
        let leaves = from == weld;
        Self { other: if leaves { to } else { from }, triangle: corner / 3, leaves }
    }
}

/// The weld that is the lower end of the greatest edge.
///
/// A weld's representative is at most its highest corner. So first only welds are looked at that have corners among
/// the last ones, until the greatest lower end found is above all that were left out.
fn greatest_lower_end(fabric: &Fabric<'_>, representatives: &mut Representatives<'_>) -> Option<u32> {
    let corners = 3 * fabric.faces.len() as u64;
    let welds = 0..fabric.rows.rows() as u32;
    let highest: Vec<u32> = welds
        .clone()
        .into_par_iter()
        .map(|weld| fabric.rows.row(weld as usize).last().map_or(0, |&last| last))
        .collect();
    let mut share = 64;
    loop {
        let least = corners.saturating_sub(share) as u32;
        let is_high = |&weld: &u32| highest[weld as usize] >= least;
        let ends: Vec<[u32; 2]> = welds
            .clone()
            .into_par_iter()
            .filter(is_high)
            .flat_map_iter(|weld| {
                let is_good = |corner: &&u32| fabric.faces[**corner as usize / 3].role != Role::Degenerate;
                let row = fabric.rows.row(weld as usize).iter().filter(is_good);
                let nexts = row.map(move |&corner| [weld, fabric.welds.beside(corner)[0]]);
                nexts.filter(|[_, to]| is_high(to))
            })
            .collect();
        representatives.look_up(ends.iter().flatten().copied());
        let known = representatives.corners();
        let lower = |&[a, b]: &[u32; 2]| known[a as usize].min(known[b as usize]);
        match ends.iter().map(lower).max() {
            Some(greatest) if greatest >= least => return Some(fabric.welds.of(greatest)),
            _ if least == 0 => return None,
            _ => share *= 4,
        }
    }
}

/// The edges of which a weld is the lower end. Ends whose representative is not known are lower.
fn edges_above(fabric: &Fabric<'_>, weld: u32, representatives: &[u32]) -> Vec<Edge> {
    let own = representatives[weld as usize];
    let is_above = |other: u32| representatives[other as usize] != NONE && representatives[other as usize] > own;
    let mut edges = Vec::new();
    for &corner in fabric.rows.row(weld as usize) {
        let triangle = corner / 3;
        if fabric.faces[triangle as usize].role != Role::Degenerate {
            let [to, from] = fabric.welds.beside(corner);
            edges.extend(is_above(to).then_some(Edge { other: to, triangle, leaves: true }));
            edges.extend(is_above(from).then_some(Edge { other: from, triangle, leaves: false }));
        }
    }
    edges
}

/// Edges, each as the corner it begins at, whose lower end is a weld that is the greatest of all: in the order in
/// which the reference's quicksort by lower ends leaves them.
fn reference_order(fabric: &Fabric<'_>, representatives: &[u32], weld: u32) -> Vec<u32> {
    let lower = |corner: u32| {
        let (from, [to, _]) = (fabric.welds.of(corner), fabric.welds.beside(corner));
        representatives[from as usize].min(representatives[to as usize])
    };
    let mut edges: Vec<(u32, u32)> = (0..3 * fabric.faces.len() as u32)
        .into_par_iter()
        .filter(|&corner| fabric.faces[corner as usize / 3].role != Role::Degenerate)
        .map(|corner| (lower(corner), corner))
        .collect();
    let greatest = representatives[weld as usize];
    sort_greatest(&mut edges, greatest);
    let begin = edges.iter().rposition(|edge| edge.0 != greatest).map_or(0, |last| last + 1);
    edges[begin..].iter().map(|edge| edge.1).collect()
}

/// What the reference's quicksort by the first parts does to those elements that are greatest.
///
/// Ranges without any are left as they are.
fn sort_greatest(edges: &mut [(u32, u32)], greatest: u32) {
    const SEED: u32 = 39_871_946;
    let mut ranges = vec![(0, edges.len(), SEED)];
    while let Some((begin, end, seed)) = ranges.pop() {
        let edges = &mut edges[begin..end];
        if !edges.iter().any(|edge| edge.0 == greatest) {
            continue;
        }
        if edges.len() <= 2 {
            edges.sort_by_key(|edge| edge.0);
            continue;
        }
        let turn = seed & 31;
        let turned = seed.wrapping_shl(turn) | seed.wrapping_shr(32u32.wrapping_sub(turn));
        let seed = seed.wrapping_add(turned).wrapping_add(3);
        let pivot = edges[seed as usize % edges.len()].0;

        let (mut left, mut right) = (0, edges.len() - 1);
        while left <= right {
            while edges[left].0 < pivot {
                left += 1;
            }
            while edges[right].0 > pivot {
                right -= 1;
            }
            if left <= right {
                edges.swap(left, right);
                left += 1;
                right = right.saturating_sub(1);
            }
        }
        ranges.push((begin, begin + right + 1, seed));
        ranges.push((begin + left, end, seed));
    }
}
