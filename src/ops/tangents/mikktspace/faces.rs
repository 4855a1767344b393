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

/// What each triangle is.
pub(super) fn faces(surface: &Surface<'_>) -> Vec<Face> {
    (0..surface.triangles.len()).into_par_iter().map(|triangle| Face::of(surface, triangle)).collect()
}

impl Face {
    #[inline(always)]
    fn of(surface: &Surface<'_>, triangle: usize) -> Self {
        let none = |role| Self { s: [0; 3], t: [0; 3], role, is_positive: None };
        let [a, b, c] = surface.triangles[triangle];
        let at = |vertex: u32| surface.positions[vertex as usize];
        if at(a) == at(b) || at(b) == at(c) || at(c) == at(a) {
            return none(Role::Degenerate);
        }
        let edges = surface.edges(triangle);
        let frame = frame(TangentMethod::Mikktspace, &edges);
        if is_zero(frame.t) || is_zero(frame.b) {
            return none(Role::Anything);
        }
        Self {
            s: coarse(frame.t),
            t: coarse(frame.b),
            role: Role::Directed,
            is_positive: Some(mikktspace_area([edges.d1, edges.d2]) > 0.0),
        }
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
