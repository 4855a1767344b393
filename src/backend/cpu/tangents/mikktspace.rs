//! MikkTSpace's method: a share for each corner, and their sums.

use super::triangles::Triangles;
use super::{BLOCK, Plane, fill_blocks, of_blocks};
use crate::exact::{acos, acos_estimate, is_in_doubt};
use crate::ops::tangents::{
    Fans, Surface, TangentMethod, TangentPlan, add, frame, mikktspace_area, mikktspace_cosine, project, sign, times,
    unit,
};

/// What a corner adds to its fan's tangent, and in w its triangle's handedness.
type Share = [f32; 4];

/// Where the shares of a block are computed.
struct Room {
    triangles: Triangles,
    normals: [[Plane; 3]; 3],
    cosines: [Plane; 3],
    directions: [[Plane; 3]; 3],
    signs: Plane,
    shares: [[Share; 3]; BLOCK],
}

impl Default for Room {
    fn default() -> Self {
        Self {
            triangles: Triangles::default(),
            normals: [[[0.0; BLOCK]; 3]; 3],
            cosines: [[0.0; BLOCK]; 3],
            directions: [[[0.0; BLOCK]; 3]; 3],
            signs: [0.0; BLOCK],
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
        let Room { triangles, normals, cosines, directions, signs, shares } = room;
        triangles.gather(surface, first);
        gather_normals(surface, fans, first, normals);
        for i in 0..BLOCK {
            let edges = triangles.edges(surface, i);
            signs[i] = sign(mikktspace_area([edges.d1, edges.d2]));
            let s = frame(TangentMethod::Mikktspace, &edges).t;
            let scale = surface.position_scale;
            let a = times(scale, triangles.position(0, i));
            let b = times(scale, triangles.position(1, i));
            let c = times(scale, triangles.position(2, i));
            let around = [[a, b, c], [b, c, a], [c, a, b]];
            for corner in 0..3 {
                let [x, y, z] = &normals[corner];
                let n = [x[i], y[i], z[i]];
                cosines[corner][i] = mikktspace_cosine(n, around[corner]);
                let direction = unit(project(n, s));
                for axis in 0..3 {
                    directions[corner][axis][i] = direction[axis];
                }
            }
        }
        for corner in 0..3 {
            let angles = angles(&cosines[corner]);
            let [x, y, z] = &directions[corner];
            for i in 0..BLOCK {
                let share = times(angles[i], [x[i], y[i], z[i]]);
                shares[i][corner] = [share[0], share[1], share[2], signs[i]];
            }
        }
    }
}

/// The angle of each cosine: estimated, and where that leaves doubt, computed in integers.
#[inline(always)]
fn angles(cosines: &Plane) -> Plane {
    let mut angles = [0.0; BLOCK];
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
    angles
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
