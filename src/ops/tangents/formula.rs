//! The three formulas, in f32, in a written order of operations without fused ones: the specification.
//!
//! FGED2's equations are Lengyel's; MikkTSpace's order is that of its reference implementation, which is why its
//! operations look as they do.

use super::{TangentMethod, TriangleEdges};
use crate::exact::acos;
use crate::ops::bake::zero_below;
use crate::vector::{add, cross, dot, sub, times};

/// What a triangle gives to each of its corners: the direction in which u grows, and that in which v grows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Frame {
    pub t: [f32; 3],
    pub b: [f32; 3],
}

impl Frame {
    /// The sum of the magnitudes of t's components.
    #[inline(always)]
    pub fn magnitude(&self) -> f32 {
        (self.t[0].abs() + self.t[1].abs()) + self.t[2].abs()
    }
}

/// The frame of a triangle. It is zero where the triangle has no direction.
#[inline(always)]
pub(crate) fn frame(method: TangentMethod, edges: &TriangleEdges) -> Frame {
    match method {
        TangentMethod::Mikktspace => mikktspace_frame(edges),
        TangentMethod::Lengyel => lengyel_frame(edges),
        TangentMethod::Hegde => hegde_frame(edges),
    }
}

/// FGED2 eq. 7.37. The inverse determinant stays below 2^64: see [`texture_edges`].
#[inline(always)]
fn lengyel_frame(edges: &TriangleEdges) -> Frame {
    let TriangleEdges { e1, e2, .. } = *edges;
    let [[x1, y1], [x2, y2]] = texture_edges([edges.d1, edges.d2]);
    let determinant = x1 * y2 - x2 * y1;
    if determinant == 0.0 {
        return Frame::default();
    }
    let r = 1.0 / determinant;
    Frame { t: times(r, sub(times(y2, e1), times(y1, e2))), b: times(r, sub(times(x1, e2), times(x2, e1))) }
}

/// Hegde's unit vectors of a face: t along the first edge whose u changes, towards growing u; b at a right angle to t
/// and to the face's normal, towards growing v.
#[inline(always)]
fn hegde_frame(edges: &TriangleEdges) -> Frame {
    let TriangleEdges { e1, e2, .. } = *edges;
    let [[x1, y1], [x2, y2]] = texture_edges([edges.d1, edges.d2]);
    let determinant = x1 * y2 - x2 * y1;
    let n = cross(unit(e1), unit(e2));
    if determinant == 0.0 || is_zero(n) {
        return Frame::default();
    }
    let (edge, x) = if x1 != 0.0 { (e1, x1) } else { (e2, x2) };
    let t = times(sign(x), unit(edge));
    // In a face, with t towards growing u, v grows to the left of t if and only if the determinant is positive.
    let b = times(sign(determinant), unit(cross(n, t)));
    Frame { t, b }
}

/// MikkTSpace's first order derivatives (equations 18 and 19 of the thesis), normalised.
#[inline(always)]
fn mikktspace_frame(edges: &TriangleEdges) -> Frame {
    let TriangleEdges { e1, e2, d1: [x1, y1], d2: [x2, y2] } = *edges;
    let area = mikktspace_area([edges.d1, edges.d2]);
    if area == 0.0 {
        return Frame::default();
    }
    let s = sub(times(y2, e1), times(y1, e2));
    let t = add(times(-x2, e1), times(x1, e2));
    Frame { t: times(sign(area), unit(s)), b: times(sign(area), unit(t)) }
}

/// Twice the area in texture, below zero for a mirrored triangle.
#[inline(always)]
pub(crate) fn mikktspace_area([[x1, y1], [x2, y2]]: [[f32; 2]; 2]) -> f32 {
    x1 * y2 - y1 * x2
}

/// The sign of the texture's area: 1 or, for a mirrored triangle, -1; 0 where there is none.
#[inline(always)]
pub(crate) fn handedness(texture: [[f32; 2]; 2]) -> i8 {
    let [[x1, y1], [x2, y2]] = texture_edges(texture);
    let determinant = x1 * y2 - x2 * y1;
    i8::from(determinant > 0.0) - i8::from(determinant < 0.0)
}

/// Differences of texture coordinates, of which those below 2^-20 count as zero: 2^-40 of the greatest coordinate.
///
/// Products that are not zero are then at least 2^-40. If both products of a determinant are, it is zero or at least
/// 2^-24 of the greater, so an inverse determinant is below 2^64, and y over it below 2^44; if one is zero, below
/// 2^40 and 2^62. With edges below 2^22 no component of a frame exceeds 2^85, nor a sum of 2^32 of them 2^117.
#[inline(always)]
fn texture_edges([[x1, y1], [x2, y2]]: [[f32; 2]; 2]) -> [[f32; 2]; 2] {
    let snapped = |difference| zero_below(2f32.powi(-20), difference);
    [[snapped(x1), snapped(y1)], [snapped(x2), snapped(y2)]]
}

/// The sums over a fan's corners, in ascending order.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct FrameSum {
    pub t: [f32; 3],
    pub b: [f32; 3],
    /// Of the magnitudes of all components of t: what the sum would be if nothing cancelled.
    pub magnitude: f32,
}

impl FrameSum {
    /// With one more triangle.
    #[inline(always)]
    pub fn plus(self, frame: Frame) -> Self {
        let magnitude = self.magnitude + frame.magnitude();
        Self { t: add(self.t, frame.t), b: add(self.b, frame.b), magnitude }
    }

    /// The tangent of a vertex with normal n, and the handedness (FGED2 eq. 7.38 and 7.40, listing 7.4); zero where
    /// no direction is left.
    ///
    /// Tangents cancel if their sum is below 2^-16 of what it could be: what is left are rounding errors. So they are
    /// if the part at a right angle to n is below 2^-16.
    #[inline(always)]
    pub fn tangent(self, n: [f32; 3]) -> [f32; 4] {
        let n = unit(n);
        let [x, y, z] = self.t;
        let cancels = (x.abs() + y.abs()) + z.abs() < 2f32.powi(-16) * self.magnitude;
        let (t, b) = (unit(self.t), unit(self.b));
        let projected = project(n, t);
        let w = sign(dot(cross(t, b), n));
        if cancels || dot(projected, projected) < 2f32.powi(-32) {
            return [0.0, 0.0, 0.0, w];
        }
        let [x, y, z] = unit(projected);
        [x, y, z, w]
    }
}

/// What a triangle adds at its corner at `p` to MikkTSpace's tangent of a vertex with normal n: its s in the tangent
/// plane, weighted by the angle between the edges to the corners at `next` and `previous`.
#[inline(always)]
pub(crate) fn mikktspace_share(n: [f32; 3], s: [f32; 3], corner: [[f32; 3]; 3]) -> [f32; 3] {
    times(acos(mikktspace_cosine(n, corner)), unit(project(n, s)))
}

/// The cosine of the angle in the tangent plane.
#[inline(always)]
pub(crate) fn mikktspace_cosine(n: [f32; 3], [p, next, previous]: [[f32; 3]; 3]) -> f32 {
    let a = unit(project(n, sub(next, p)));
    let b = unit(project(n, sub(previous, p)));
    dot(a, b).clamp(-1.0, 1.0)
}

/// v without its part along n.
#[inline(always)]
pub(crate) fn project(n: [f32; 3], v: [f32; 3]) -> [f32; 3] {
    sub(v, times(dot(n, v), n))
}

/// v over its length; zero stays zero.
///
/// v is multiplied by a power of two first, so that no square matters that overflows or is subnormal. Where none
/// would, the bits are those of v times the inverse of its length.
#[inline(always)]
pub(crate) fn unit(v: [f32; 3]) -> [f32; 3] {
    let v = scaled_to_one(v);
    if is_zero(v) {
        return [0.0; 3];
    }
    times(1.0 / dot(v, v).sqrt(), v)
}

/// v times a power of two that brings its greatest component from 1 to 2, or nearer to it if that is subnormal.
#[inline(always)]
pub(crate) fn scaled_to_one(v: [f32; 3]) -> [f32; 3] {
    let greatest = (v[0].to_bits() & MAGNITUDE).max(v[1].to_bits() & MAGNITUDE).max(v[2].to_bits() & MAGNITUDE);
    // 2^-e for a greatest component from 2^e to 2^(e + 1); 2^-126, the least that is no subnormal, for 2^127.
    times(f32::from_bits(((254 << 23) - (greatest & EXPONENT)).max(1 << 23)), v)
}

const MAGNITUDE: u32 = 0x7fff_ffff;
const EXPONENT: u32 = 0x7f80_0000;

/// Bits that equal vectors have in common: minus zero is zero.
pub(crate) fn bits_of_value(v: [f32; 3]) -> [u32; 3] {
    v.map(|part| (part + 0.0).to_bits())
}

#[inline(always)]
pub(crate) fn is_zero(v: [f32; 3]) -> bool {
    (v[0] == 0.0) & (v[1] == 0.0) & (v[2] == 0.0)
}

/// 1 above zero, else -1.
#[inline(always)]
pub(crate) fn sign(value: f32) -> f32 {
    if value > 0.0 { 1.0 } else { -1.0 }
}
