//! MikkTSpace's method: a share for each corner, and their sums.

use super::triangles::Triangles;
use super::{BLOCK, Plane, fill_blocks, of_blocks};
use crate::exact::acos;
use crate::ops::tangents::{
    Fans, Surface, TangentMethod, TangentPlan, add, frame, mikktspace_area, mikktspace_cosine, project, sign, times,
    unit,
};

/// What a corner adds to its fan's tangent, and in w its triangle's handedness.
type Share = [f32; 4];

/// The tangent of each fan.
pub(super) fn tangents(plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) {
    let TangentPlan { surface, fans, .. } = *plan;
    let shares = of_blocks(surface.triangles.len(), |first| {
        let mut shares = [[[0.0; 4]; 3]; BLOCK];
        shares_of_block(surface, fans, first, &mut shares);
        shares
    });
    let shares = shares.as_flattened().as_flattened();
    fill_blocks(tangents, |first, tangents| tangents_of_sums(fans, shares, first, tangents));
}

vectorised! {
    fn shares_of_block(surface: &Surface<'_>, fans: &Fans<'_>, first: usize, shares: &mut [[Share; 3]; BLOCK]) {
        let triangles = Triangles::gathered(surface, first);
        let normals = gathered_normals(surface, fans, first);
        let mut cosines: [Plane; 3] = [[0.0; BLOCK]; 3];
        let mut directions: [[Plane; 3]; 3] = [[[0.0; BLOCK]; 3]; 3];
        let mut signs: Plane = [0.0; BLOCK];
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
            let [x, y, z] = &directions[corner];
            for i in 0..BLOCK {
                let share = times(acos(cosines[corner][i]), [x[i], y[i], z[i]]);
                shares[i][corner] = [share[0], share[1], share[2], signs[i]];
            }
        }
    }
}

/// The normal of each corner's fan, for the triangles from `first`.
#[inline(always)]
fn gathered_normals(surface: &Surface<'_>, fans: &Fans<'_>, first: usize) -> [[Plane; 3]; 3] {
    let mut normals = [[[0.0; BLOCK]; 3]; 3];
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
    normals
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
