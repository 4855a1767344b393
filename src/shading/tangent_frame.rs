//! Tangent space from a vertex's normal and tangent.

use crate::vector::{add, cross, dot, normalized, sub, times};

/// The vectors t, b and n of tangent space: the columns of FGED2 eq. 7.31.
pub type Frame = [[f32; 3]; 3];

/// The frame of a vertex, of its vectors as they come: b = w (n x t) (FGED2 listing 7.7).
///
/// `w` is the handedness, +1 or -1. With [`to_tangent`] it turns the vectors to the eye and to the light, which are
/// interpolated unnormalised and normalised for each pixel.
pub fn vertex_frame(n: [f32; 3], t: [f32; 3], w: f32) -> Frame {
    [t, times(w, cross(n, t)), n]
}

/// The orthonormal frame of a pixel from an interpolated normal and tangent (FGED2 listing 7.8).
///
/// n is normalised, t becomes orthogonal to it and of length one, and b is their cross product times `w`. The listing's
/// code takes the cross product of the vectors as they were interpolated, with which b leans and is not of length one.
/// `n` must not be zero, and `t` not along it.
pub fn pixel_frame(n: [f32; 3], t: [f32; 3], w: f32) -> Frame {
    let normal = normalized(n);
    let tangent = normalized(sub(t, times(dot(t, normal), normal)));
    [tangent, times(w, cross(normal, tangent)), normal]
}

/// A vector of the frame's space in tangent space: (t . v, b . v, n . v) (FGED2 eq. 7.32).
pub fn to_tangent(frame: Frame, v: [f32; 3]) -> [f32; 3] {
    frame.map(|axis| dot(axis, v))
}

/// A vector of tangent space in the frame's space: m_x t + m_y b + m_z n (FGED2 eq. 7.45).
///
/// ```
/// use texbake::shading::{pixel_frame, to_object, to_tangent};
///
/// let frame = pixel_frame([0.0, 0.0, 2.0], [3.0, 0.0, 1.0], -1.0);
/// assert_eq!(frame, [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
/// assert_eq!(to_object(frame, to_tangent(frame, [1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
/// ```
pub fn to_object(frame: Frame, m: [f32; 3]) -> [f32; 3] {
    let [t, b, n] = frame;
    add(add(times(m[0], t), times(m[1], b)), times(m[2], n))
}
