//! MikkTSpace's groups: which corners its reference implementation gives one tangent, found in parallel.
//!
//! ```text
//! vertices of equal attributes are welded -> triangles are judged -> edges are paired -> groups around a vertex
//! ```
//!
//! The reference (Mikkelsen 2011, mikktspace.c, and its ports) walks over the whole mesh; every step of it but one
//! can be decided at each welded vertex alone, from the row of its corners. The exception are triangles without a
//! direction of their own, whose handedness goes to the first group that reaches them: `anything`.

mod anything;
mod faces;
mod groups;
mod last_edges;
mod representatives;
mod rings;
mod spokes;
mod subgroups;
#[cfg(test)]
mod tests;
mod weld;

use super::fans::Owners;
use super::{Fans, Surface};
use crate::mesh::CornerAdjacency;
use anything::orient_anything;
use faces::{Face, faces};
use groups::{Divided, divide};
use last_edges::LastEdges;
use std::borrow::Cow;
use weld::Welds;

/// A mesh whose vertices of equal attributes are welded: what rings and groups are found in.
struct Fabric<'a> {
    surface: &'a Surface<'a>,
    welds: Welds<'a>,
    /// The corners at each weld.
    rows: CornerAdjacency,
    /// What each triangle is.
    faces: Vec<Face>,
    /// Edges that the reference pairs in an order of its own.
    last: Option<LastEdges>,
}

impl Fans<'_> {
    /// MikkTSpace's groups, and within them its subgroups.
    ///
    /// Fan i is the first group around weld i; the groups that a weld has besides follow all welds. Corners that the
    /// reference gives no tangent have fans of no corners.
    pub fn of_mikktspace(surface: &Surface<'_>) -> Self {
        let mut fabric = Fabric::welded(surface);
        fabric.last = LastEdges::of(&fabric);
        orient_anything(&mut fabric);
        fabric.into_fans()
    }
}

impl<'a> Fabric<'a> {
    fn welded(surface: &'a Surface<'a>) -> Self {
        let welds = Welds::new(surface);
        let rows = CornerAdjacency::of_vertices(&welds.triangles, welds.count());
        Self { surface, welds, rows, faces: faces(surface), last: None }
    }

    fn into_fans(self) -> Fans<'static> {
        let divided = divide(&self);
        let Self { welds, rows, .. } = self;
        if divided.is_empty() {
            let owners = (!welds.are_vertices())
                .then(|| Owners { vertices: welds.vertices(), fans: welds.triangles.into_owned().into_flattened() });
            return Fans { corners: Cow::Owned(rows), owners };
        }

        let mut vertices = welds.vertices();
        let mut fans = welds.triangles.into_owned().into_flattened();
        let (corners, owners) = with_divided(&rows, &divided, &mut fans);
        let added: Vec<u32> = owners.iter().map(|&weld| vertices[weld as usize]).collect();
        vertices.extend(added);
        Fans { corners: Cow::Owned(corners), owners: Some(Owners { vertices, fans }) }
    }

    /// The normal of all corners at a weld.
    #[inline(always)]
    pub fn normal(&self, weld: u32) -> [f32; 3] {
        self.surface.normals[self.welds.vertex(weld) as usize]
    }
}

/// Replaces the rows of divided welds by their first fans and appends the others, whose welds are returned.
///
/// `fans` holds each corner's weld, and its fan afterwards.
fn with_divided(rows: &CornerAdjacency, divided: &[Divided], fans: &mut [u32]) -> (CornerAdjacency, Vec<u32>) {
    let mut added: Vec<u32> = Vec::new();
    let mut ids = Vec::new();
    for part in divided {
        ids.clear();
        for (fan, &weld) in part.welds.iter().enumerate() {
            let is_first = fan == 0 || part.welds[fan - 1] != weld;
            ids.push(if is_first { weld } else { (rows.rows() + added.len()) as u32 });
            if !is_first {
                added.push(weld);
            }
        }
        for &(corner, fan) in &part.members {
            fans[corner as usize] = ids[fan as usize];
        }
    }

    let all = || divided.iter().flat_map(|part| (0..part.welds.len()).map(move |fan| (part, fan)));
    let is_first = |&(part, fan): &(&Divided, usize)| fan == 0 || part.welds[fan - 1] != part.welds[fan];
    let replaced = all().filter(is_first);
    let replaced = replaced.map(|(part, fan)| (part.welds[fan] as usize, part.row(fan).iter().copied()));
    let others = all().filter(|fan| !is_first(fan)).map(|(part, fan)| part.row(fan).iter().copied());
    (rows.with_rows(replaced, others), added)
}
