//! Which corners share a tangent.

use super::pieces::of_pieces;
use super::{Faces, Surface};
use crate::mesh::CornerAdjacency;
use std::borrow::Cow;

/// The corners that share a tangent, for each tangent.
#[derive(Debug)]
pub(crate) struct Fans<'a> {
    /// The corners that each fan's tangent is made of, ascending; none where nothing has a direction.
    pub corners: Cow<'a, CornerAdjacency>,
    /// `None`: fan i belongs to vertex i and to all of its corners.
    pub owners: Option<Owners>,
}

/// Whose tangents the fans are.
#[derive(Debug)]
pub(crate) struct Owners {
    /// A vertex of each fan, for its normal.
    pub vertices: Vec<u32>,
    /// The fan of each corner of the mesh.
    pub fans: Vec<u32>,
}

impl<'a> Fans<'a> {
    /// A fan for each vertex, and one more for each that has triangles of either handedness.
    ///
    /// The triangles without area in the texture go with those that are not mirrored: they contribute nothing.
    pub fn by_handedness(surface: &Surface<'_>, faces: &Faces, adjacency: &'a CornerAdjacency) -> Self {
        let vertices = adjacency.rows();
        let handedness = |corner: u32| faces.handedness[corner as usize / 3];
        let is_negative = |corner: u32| handedness(corner) < 0;
        let is_mixed = |&vertex: &u32| {
            let row = adjacency.row(vertex as usize);
            row.iter().any(|&corner| is_negative(corner)) && row.iter().any(|&corner| handedness(corner) > 0)
        };
        let mixed_of_piece =
            |first: usize, ends: &[u32]| -> Vec<u32> { (first as u32..).take(ends.len()).filter(is_mixed).collect() };
        let mixed =
            if faces.are_mixed() { of_pieces(&adjacency.offsets()[1..], mixed_of_piece).concat() } else { Vec::new() };
        if mixed.is_empty() {
            return Self { corners: Cow::Borrowed(adjacency), owners: None };
        }

        let mut fans = surface.triangles.as_flattened().to_vec();
        for (&vertex, mirrored) in mixed.iter().zip(vertices as u32..) {
            for &corner in adjacency.row(vertex as usize).iter().filter(|&&corner| is_negative(corner)) {
                fans[corner as usize] = mirrored;
            }
        }
        let row = |vertex: u32| adjacency.row(vertex as usize).iter().copied();
        let others = mixed.iter().map(|&vertex| (vertex as usize, row(vertex).filter(|&corner| !is_negative(corner))));
        let negative = mixed.iter().map(|&vertex| row(vertex).filter(|&corner| is_negative(corner)));
        let corners = Cow::Owned(adjacency.with_rows(others, negative));
        let owners = (0..vertices as u32).chain(mixed).collect();
        Self { corners, owners: Some(Owners { vertices: owners, fans }) }
    }

    /// How many fans there are.
    pub fn count(&self) -> usize {
        self.corners.rows()
    }

    /// A vertex of a fan.
    #[inline(always)]
    pub fn vertex(&self, fan: usize) -> usize {
        self.owners.as_ref().map_or(fan, |owners| owners.vertices[fan] as usize)
    }
}
