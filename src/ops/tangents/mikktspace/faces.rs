//! What MikkTSpace makes of each triangle.

use super::Surface;
use crate::ops::tangents::pieces::of_pieces_mut;
use crate::ops::tangents::{BLOCK, TangentMethod, Triangles, frame, is_zero, mikktspace_area, project};
use crate::vector::dot;

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
    let none = Face { s: [0; 3], t: [0; 3], role: Role::Degenerate, is_positive: None };
    let mut faces = vec![none; surface.triangles.len()];
    of_pieces_mut(&mut faces, |first, faces| {
        let mut triangles = Triangles::default();
        for (block, faces) in faces.chunks_mut(BLOCK).enumerate() {
            triangles.gather(surface, first + block * BLOCK);
            judge(surface, &triangles, faces);
        }
    });
    faces
}

vectorised! {
    /// Judges a block of triangles.
    fn judge(surface: &Surface<'_>, triangles: &Triangles, faces: &mut [Face]) {
        let mut directions = [[0; BLOCK]; 6];
        let (mut is_degenerate, mut is_directed, mut is_positive) = ([0; BLOCK], [0; BLOCK], [0; BLOCK]);
        for i in 0..BLOCK {
            let edges = triangles.edges(surface, i);
            let frame = frame(TangentMethod::Mikktspace, &edges);
            for axis in 0..3 {
                directions[axis][i] = coarse(frame.t[axis]);
                directions[3 + axis][i] = coarse(frame.b[axis]);
            }
            let [a, b, c] = [triangles.position(0, i), triangles.position(1, i), triangles.position(2, i)];
            let two_are_equal = are_equal(a, b) | are_equal(b, c) | are_equal(c, a);
            is_degenerate[i] = i32::from(two_are_equal);
            is_directed[i] = i32::from(!two_are_equal & !is_zero(frame.t) & !is_zero(frame.b));
            is_positive[i] = i32::from(mikktspace_area([edges.d1, edges.d2]) > 0.0);
        }
        for i in 0..faces.len().min(BLOCK) {
            let [sx, sy, sz, tx, ty, tz] = &directions;
            let is_directed = is_directed[i] != 0;
            faces[i] = Face {
                s: [sx[i] as i8, sy[i] as i8, sz[i] as i8],
                t: [tx[i] as i8, ty[i] as i8, tz[i] as i8],
                role: match (is_directed, is_degenerate[i] != 0) {
                    (true, _) => Role::Directed,
                    (false, true) => Role::Degenerate,
                    (false, false) => Role::Anything,
                },
                is_positive: if is_directed { Some(is_positive[i] != 0) } else { None },
            };
        }
    }
}

#[inline(always)]
fn are_equal(a: [f32; 3], b: [f32; 3]) -> bool {
    (a[0] == b[0]) & (a[1] == b[1]) & (a[2] == b[2])
}

/// A part of a unit vector in steps of 1/127.
#[inline(always)]
fn coarse(part: f32) -> i32 {
    // Rounded by cutting what is above zero.
    (127.0 * part + 127.5) as i32 - 127
}

#[inline(always)]
fn fine([x, y, z]: [i8; 3]) -> [f32; 3] {
    [f32::from(x), f32::from(y), f32::from(z)]
}

/// A face's directions, projected along a normal: in steps of 1/127.
#[derive(Clone, Copy)]
pub(super) struct Projected {
    s: [f32; 3],
    t: [f32; 3],
}

impl Face {
    /// Its directions, projected along n.
    #[inline(always)]
    pub fn projected(&self, n: [f32; 3]) -> Projected {
        Projected { s: project(n, fine(self.s)), t: project(n, fine(self.t)) }
    }

    /// Whether its directions are clearly not opposite to another face's, if projected as those are: less than 79
    /// degrees apart.
    ///
    /// With n shorter or longer by 1% and the directions off by 0.007, the products below are off by at most 0.05.
    #[inline(always)]
    pub fn agrees(&self, other: &Projected) -> bool {
        const LEAST: f32 = 0.25 * 127.0 * 127.0;
        (dot(fine(self.s), other.s) > LEAST) & (dot(fine(self.t), other.t) > LEAST)
    }
}
