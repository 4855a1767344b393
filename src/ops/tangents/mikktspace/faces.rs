//! What MikkTSpace makes of each triangle.

use super::Surface;
use crate::ops::tangents::{TangentMethod, dot, frame, is_zero, mikktspace_area};
use rayon::prelude::*;

/// A triangle, in eight bytes: a fan reads those of all its corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Directions in which u and v grow, in steps of 1/127.
    s: [i8; 3],
    t: [i8; 3],
    pub role: Role,
    /// Whether the texture lies on the triangle unmirrored. Where it does not say, the first group decides; `None`
    /// until then.
    pub is_positive: Option<bool>,
}

/// What part a triangle takes in groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Contributes to its group's tangent.
    Directed,
    /// Has no direction, and joins a group of either handedness.
    Anything,
    /// Two corners have one position: in no group.
    Degenerate,
}

/// Triangles of one task.
const BLOCK: usize = 256;

/// What each triangle is.
pub(super) fn faces(surface: &Surface<'_>) -> Vec<Face> {
    let none = Face { s: [0; 3], t: [0; 3], role: Role::Degenerate, is_positive: None };
    let mut faces = vec![none; surface.triangles.len()];
    faces.par_chunks_mut(BLOCK).enumerate().for_each(|(block, faces)| {
        // A short first loop, of which the processor runs many turns at once: it waits for memory.
        for (face, triangle) in faces.iter_mut().zip(block * BLOCK..) {
            face.role = if is_degenerate(surface, triangle) { Role::Degenerate } else { Role::Anything };
            face.is_positive = Some(mikktspace_area(surface.texture_edges(triangle)) > 0.0);
        }
        for (face, triangle) in faces.iter_mut().zip(block * BLOCK..) {
            face.find_direction(surface, triangle);
        }
    });
    faces
}

/// Whether two corners have one position.
#[inline(always)]
fn is_degenerate(surface: &Surface<'_>, triangle: usize) -> bool {
    let [a, b, c] = surface.triangles[triangle];
    let at = |vertex: u32| surface.positions[vertex as usize];
    let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (at(a), at(b), at(c));
    // Without branches.
    ((ax == bx) & (ay == by) & (az == bz))
        | ((bx == cx) & (by == cy) & (bz == cz))
        | ((cx == ax) & (cy == ay) & (cz == az))
}

impl Face {
    #[inline(always)]
    fn find_direction(&mut self, surface: &Surface<'_>, triangle: usize) {
        let frame = frame(TangentMethod::Mikktspace, &surface.edges(triangle));
        if self.role == Role::Degenerate || is_zero(frame.t) || is_zero(frame.b) {
            self.is_positive = None;
            return;
        }
        self.role = Role::Directed;
        (self.s, self.t) = (coarse(frame.t), coarse(frame.b));
    }

    /// Whether two faces' directions, projected along n, are clearly not opposite: less than 79 degrees apart.
    ///
    /// With n shorter or longer by 1% and the directions off by 0.007, the products below are off by at most 0.05.
    #[inline(always)]
    pub fn agrees(&self, other: &Self, n: [f32; 3]) -> bool {
        let product = |a: [i8; 3], b: [i8; 3]| {
            let (a, b) = (fine(a), fine(b));
            dot(a, b) - dot(n, a) * dot(n, b)
        };
        product(self.s, other.s) > 0.25 && product(self.t, other.t) > 0.25
    }
}

#[inline(always)]
fn coarse([x, y, z]: [f32; 3]) -> [i8; 3] {
    let coarse = |part: f32| (127.0 * part).round_ties_even() as i8;
    [coarse(x), coarse(y), coarse(z)]
}

#[inline(always)]
fn fine([x, y, z]: [i8; 3]) -> [f32; 3] {
    [f32::from(x) / 127.0, f32::from(y) / 127.0, f32::from(z) / 127.0]
}
