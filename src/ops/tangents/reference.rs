//! The specification: one fan after the other, in plain code.

use super::{
    Frame, FrameSum, Surface, TangentMethod, TangentPlan, frame, mikktspace_area, mikktspace_share, sign, unit,
};
use crate::vector::add;

/// The tangent of each fan, and its handedness as to growing v; zero where no direction is left.
pub(crate) fn tangents_of_fans(plan: &TangentPlan<'_>, tangents: &mut [[f32; 4]]) {
    for (fan, tangent) in tangents.iter_mut().enumerate() {
        *tangent = tangent_of_fan(plan, fan);
    }
}

/// The tangent of one fan.
pub(crate) fn tangent_of_fan(plan: &TangentPlan<'_>, fan: usize) -> [f32; 4] {
    let TangentPlan { method, surface, fans, .. } = *plan;
    let n = surface.normals[fans.vertex(fan)];
    let corners = fans.corners.row(fan);
    let frame = |corner: u32| frame(method, &surface.edges(corner as usize / 3));
    match method {
        TangentMethod::Mikktspace => mikktspace_tangent(surface, n, corners, frame),
        TangentMethod::Lengyel | TangentMethod::Hegde => {
            corners.iter().fold(FrameSum::default(), |sum, &corner| sum.plus(frame(corner))).tangent(n)
        }
    }
}

/// The weighted sum of the triangles' s, normalised; their common handedness.
fn mikktspace_tangent(surface: &Surface<'_>, n: [f32; 3], corners: &[u32], frame: impl Fn(u32) -> Frame) -> [f32; 4] {
    let share = |corner: u32| mikktspace_share(n, frame(corner).t, surface.corner_positions(corner));
    let sum = corners.iter().fold([0.0; 3], |sum, &corner| add(sum, share(corner)));
    let [x, y, z] = unit(sum);
    let w = corners.first().map_or(-1.0, |&corner| sign(mikktspace_area(surface.texture_edges(corner as usize / 3))));
    [x, y, z, w]
}
