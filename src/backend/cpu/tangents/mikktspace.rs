//! MikkTSpace's method: a share for each corner, and their sums.

#![expect(clippy::needless_range_loop, reason = "an index for all planes of a lane")]

use super::{fill_blocks, of_blocks};
use crate::exact::{acos, acos_estimate, is_in_doubt};
use crate::ops::tangents::{
    BLOCK, Fans, Plane, Surface, TangentMethod, TangentPlan, Triangles, add, frame, mikktspace_area, mikktspace_cosine,
    project, sign, times, unit,
};

/// What a corner adds to its fan's tangent, and in w its triangle's handedness.
type Share = [f32; 4];

/// Where the shares of a block are computed.
struct Room {
    triangles: Triangles,
    normals: [[Plane; 3]; 3],
    s: [Plane; 3],
    signs: Plane,
    angles: Plane,
    of_corner: [Share; BLOCK],
    shares: [[Share; 3]; BLOCK],
}

impl Default for Room {
    fn default() -> Self {
        Self {
            triangles: Triangles::default(),
            normals: [[[0.0; BLOCK]; 3]; 3],
            s: [[0.0; BLOCK]; 3],
            signs: [0.0; BLOCK],
            angles: [0.0; BLOCK],
            of_corner: [[0.0; 4]; BLOCK],
            shares: [[[0.0; 4]; 3]; BLOCK],
        }
    }
}

/// The tangent of each fan.
pub(super) fn tangents(plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) {
    let TangentPlan { surface, fans, .. } = *plan;
    let shares = of_blocks(surface.triangles.len(), |room: &mut Room, first| {
        shares_of_block(surface, fans, first, room);
        room.shares
    });
    let shares = shares.as_flattened().as_flattened();
    fill_blocks(tangents, |first, tangents| tangents_of_sums(fans, shares, first, tangents));
}

vectorised! {
    fn shares_of_block(surface: &Surface<'_>, fans: &Fans<'_>, first: usize, room: &mut Room) {
        let Room { triangles, normals, s, signs, angles, of_corner, shares } = room;
        triangles.gather(surface, first);
        gather_normals(surface, fans, first, normals);
        directions(surface, triangles, s, signs);
        for (corner, normals) in normals.iter().enumerate() {
            cosines(surface.position_scale, triangles, corner, normals, angles);
            cosines_to_angles(angles);
            shares_of_corner(normals, s, angles, signs, of_corner);
            for i in 0..BLOCK {
                shares[i][corner] = of_corner[i];
            }
        }
    }
}

/// The direction in which each triangle's u grows, and its handedness.
#[inline(always)]
fn directions(surface: &Surface<'_>, triangles: &Triangles, s: &mut [Plane; 3], signs: &mut Plane) {
    for i in 0..BLOCK {
        let edges = triangles.edges(surface, i);
        signs[i] = sign(mikktspace_area([edges.d1, edges.d2]));
        [s[0][i], s[1][i], s[2][i]] = frame(TangentMethod::Mikktspace, &edges).t;
    }
}

/// The cosine of the angle at a corner of each triangle.
#[inline(always)]
fn cosines(scale: f32, triangles: &Triangles, corner: usize, normals: &[Plane; 3], cosines: &mut Plane) {
    let [next, previous] = [(corner + 1) % 3, (corner + 2) % 3];
    for i in 0..BLOCK {
        let position = |corner| times(scale, triangles.position(corner, i));
        let n = [normals[0][i], normals[1][i], normals[2][i]];
        cosines[i] = mikktspace_cosine(n, [position(corner), position(next), position(previous)]);
    }
}

/// Estimates the angles, and where that leaves doubt, computes them in integers.
#[inline(always)]
fn cosines_to_angles(angles: &mut Plane) {
    let cosines = *angles;
    let mut doubts = 0;
    for i in 0..BLOCK {
        let estimate = acos_estimate(cosines[i]);
        angles[i] = estimate as f32;
        doubts += u32::from(is_in_doubt(estimate));
    }
    if doubts > 0 {
        for i in 0..BLOCK {
            angles[i] = acos(cosines[i]);
        }
    }
}

/// What each triangle adds at a corner.
#[inline(always)]
fn shares_of_corner(normals: &[Plane; 3], s: &[Plane; 3], angles: &Plane, signs: &Plane, shares: &mut [Share; BLOCK]) {
    let mut planes: [Plane; 3] = [[0.0; BLOCK]; 3];
    for i in 0..BLOCK {
        let n = [normals[0][i], normals[1][i], normals[2][i]];
        let direction = unit(project(n, [s[0][i], s[1][i], s[2][i]]));
        [planes[0][i], planes[1][i], planes[2][i]] = times(angles[i], direction);
    }
    for i in 0..BLOCK {
        shares[i] = [planes[0][i], planes[1][i], planes[2][i], signs[i]];
    }
}

/// The normal of each corner's fan, for the triangles from `first`.
#[inline(always)]
fn gather_normals(surface: &Surface<'_>, fans: &Fans<'_>, first: usize, normals: &mut [[Plane; 3]; 3]) {
    for (i, triangle) in surface.triangles[first..].iter().take(BLOCK).enumerate() {
        for corner in 0..3 {
            let vertex = match &fans.owners {
                Some(owners) => owners.vertices[owners.fans[3 * (first + i) + corner] as usize],
                None => triangle[corner],
            };
            let normal = surface.normals[vertex as usize];
            for axis in 0..3 {
                normals[corner][axis][i] = normal[axis];
            }
        }
    }
}

vectorised! {
    fn tangents_of_sums(fans: &Fans<'_>, shares: &[Share], first: usize, tangents: &mut [[f32; 4]]) {
        let mut planes: [Plane; 4] = [[0.0; BLOCK]; 4];
        for i in 0..tangents.len().min(BLOCK) {
            let row = fans.corners.row(first + i);
            let mut sum = [0.0; 3];
            for &corner in row {
                let [x, y, z, _] = shares[corner as usize];
                sum = add(sum, [x, y, z]);
            }
            for axis in 0..3 {
                planes[axis][i] = sum[axis];
            }
            planes[3][i] = match row {
                [corner, ..] => shares[*corner as usize][3],
                [] => -1.0,
            };
        }
        for i in 0..BLOCK {
            let tangent = unit([planes[0][i], planes[1][i], planes[2][i]]);
            for axis in 0..3 {
                planes[axis][i] = tangent[axis];
            }
        }
        for i in 0..tangents.len().min(BLOCK) {
            tangents[i] = [planes[0][i], planes[1][i], planes[2][i], planes[3][i]];
        }
    }
}
