//! Lengyel's and Hegde's methods: a frame for each triangle, and their sums.

#![expect(clippy::needless_range_loop, reason = "an index for all planes of a lane")]

use super::{fill_blocks, of_blocks};
use crate::ops::tangents::{
    BLOCK, Fans, Frame, FrameSum, Plane, Surface, TangentMethod, TangentPlan, Triangles, frame,
};

/// What a triangle gives: t, b and the magnitude of t. Half a cache line, which one instruction adds.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
pub(super) struct Given([f32; 8]);

/// Where the frames of a block are computed.
pub(super) struct Room {
    triangles: Triangles,
    planes: [Plane; 8],
    given: [Given; BLOCK],
}

impl Default for Room {
    fn default() -> Self {
        Self { triangles: Triangles::default(), planes: [[0.0; BLOCK]; 8], given: [Given([0.0; 8]); BLOCK] }
    }
}

/// The frames of a block of triangles.
type OfBlock = fn(&Surface<'_>, usize, &mut Room);

/// The tangent of each fan.
pub(super) fn tangents(of_block: OfBlock, plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) {
    let TangentPlan { surface, fans, .. } = *plan;
    let given = of_blocks(surface.triangles.len(), |room: &mut Room, first| {
        of_block(surface, first, room);
        room.given
    });
    fill_blocks(tangents, |first, tangents| tangents_of_sums(surface, fans, given.as_flattened(), first, tangents));
}

vectorised! {
    pub(super) fn lengyel(surface: &Surface<'_>, first: usize, room: &mut Room) {
        frames(TangentMethod::Lengyel, surface, first, room);
    }
}

vectorised! {
    pub(super) fn hegde(surface: &Surface<'_>, first: usize, room: &mut Room) {
        frames(TangentMethod::Hegde, surface, first, room);
    }
}

#[inline(always)]
fn frames(method: TangentMethod, surface: &Surface<'_>, first: usize, room: &mut Room) {
    let Room { triangles, planes, given } = room;
    triangles.gather(surface, first);
    for i in 0..BLOCK {
        let frame = frame(method, &triangles.edges(surface, i));
        let Frame { t, b } = frame;
        for axis in 0..3 {
            planes[axis][i] = t[axis];
            planes[3 + axis][i] = b[axis];
        }
        planes[6][i] = frame.magnitude();
    }
    for i in 0..BLOCK {
        // All eight, or the stores are scattered one by one.
        for part in 0..8 {
            given[i].0[part] = planes[part][i];
        }
    }
}

vectorised! {
    fn tangents_of_sums(
        surface: &Surface<'_>,
        fans: &Fans<'_>,
        given: &[Given],
        first: usize,
        tangents: &mut [[f32; 4]],
    ) {
        let mut sums = [[0.0; 8]; BLOCK];
        let mut normals: [Plane; 3] = [[0.0; BLOCK]; 3];
        for i in 0..tangents.len().min(BLOCK) {
            let mut sum = [0.0; 8];
            for &corner in fans.corners.row(first + i) {
                let Given(given) = &given[corner as usize / 3];
                for part in 0..8 {
                    sum[part] += given[part];
                }
            }
            sums[i] = sum;
            let normal = surface.normals[fans.vertex(first + i)];
            for axis in 0..3 {
                normals[axis][i] = normal[axis];
            }
        }
        let mut planes: [Plane; 4] = [[0.0; BLOCK]; 4];
        for i in 0..BLOCK {
            let [tx, ty, tz, bx, by, bz, magnitude, _] = sums[i];
            let sum = FrameSum { t: [tx, ty, tz], b: [bx, by, bz], magnitude };
            let tangent = sum.tangent([normals[0][i], normals[1][i], normals[2][i]]);
            for part in 0..4 {
                planes[part][i] = tangent[part];
            }
        }
        for i in 0..tangents.len().min(BLOCK) {
            tangents[i] = [planes[0][i], planes[1][i], planes[2][i], planes[3][i]];
        }
    }
}
