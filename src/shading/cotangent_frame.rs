//! Normal mapping without precomputed tangents: the cotangent frame of a pixel.

use super::Frame;
use super::tangent_frame::to_object;
use crate::vector::{add, cross, dot, normalized, times};

/// The cotangent frame T, B, n (Christian Schüler, Followup: Normal Mapping Without Precomputed Tangents, 2013).
///
/// `n` is the interpolated normal, of length one; `dp` are differences of the position along two directions (edges of a
/// triangle, derivatives of a pixel's quad), `duv` those of the texture coordinates along the same. T and B are the
/// gradients of u and v, right for skewed and mirrored mappings; the longer one has length one, the ratio of their lengths
/// is kept. Where no direction is left both are zero.
///
/// Schüler's T is the gradient times n . (dp1 x dp2), which is below zero where the differences turn the other way
/// round. Its sign is taken out here, so that any two directions give the same frame.
///
/// ```
/// use texbake::shading::cotangent_frame;
///
/// // v grows twice as fast as u, and towards -y.
/// let frame = cotangent_frame([0.0, 0.0, 1.0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0], [0.0, -2.0]]);
/// assert_eq!(frame, [[0.5, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
/// ```
pub fn cotangent_frame(n: [f32; 3], [dp1, dp2]: [[f32; 3]; 2], duv: [[f32; 2]; 2]) -> Frame {
    let across = [cross(dp2, n), cross(n, dp1)];
    let side = if dot(dp1, across[0]) >= 0.0 { 1.0 } else { -1.0 };
    scale_invariant(combined(across, duv).map(|axis| times(side, axis)), n)
}

/// Schüler's shortcut: dp1 and dp2 in place of the vectors perpendicular to them. It is right where they are orthogonal
/// and of one length, so not at a slant or in perspective.
pub fn without_perspective(n: [f32; 3], dp: [[f32; 3]; 2], duv: [[f32; 2]; 2]) -> Frame {
    scale_invariant(combined(dp, duv), n)
}

/// The gradients of u and v on a triangle: the inverse of the matrix with the rows dp1, dp2 and dp1 x dp2, its adjugate
/// over its determinant, times (du1, du2, 0) and (dv1, dv2, 0). This is what [`cotangent_frame`] replaces; it is not
/// finite where the triangle has no area.
pub fn gradients([dp1, dp2]: [[f32; 3]; 2], duv: [[f32; 2]; 2]) -> [[f32; 3]; 2] {
    let face = cross(dp1, dp2);
    let determinant = dot(face, face);
    combined([cross(dp2, face), cross(face, dp1)].map(|axis| axis.map(|part| part / determinant)), duv)
}

/// The normal of a pixel: the map's normal `m` in a frame, normalised.
pub fn perturbed_normal(frame: Frame, m: [f32; 3]) -> [f32; 3] {
    normalized(to_object(frame, m))
}

/// For u and for v: both vectors, each times its difference.
fn combined(across: [[f32; 3]; 2], duv: [[f32; 2]; 2]) -> [[f32; 3]; 2] {
    [0, 1].map(|axis| add(times(duv[0][axis], across[0]), times(duv[1][axis], across[1])))
}

fn scale_invariant([t, b]: [[f32; 3]; 2], n: [f32; 3]) -> Frame {
    let square = dot(t, t).max(dot(b, b));
    let inverse = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
    [times(inverse, t), times(inverse, b), n]
}
