//! Parallax mapping, with and without offset limiting.

/// The offset (h scale + bias) v_xy / v_z (Terry Welsh, Parallax Mapping with Offset Limiting, 2004), to be added to the
/// texture coordinates.
///
/// `h` is the height in [0, 1]; `scale` the height of h = 1 in texture coordinates, for each axis: s / r for a scale of s
/// texels and a map of r; `bias` is -scale / 2, so that a height of 1/2 moves nothing. (Welsh's text has s / 2; the minus
/// of his programs is right.) `v` points to the eye, in tangent space; it is of length one, with z above zero.
pub fn welsh_offset(h: f32, scale: [f32; 2], bias: [f32; 2], [vx, vy, vz]: [f32; 3]) -> [f32; 2] {
    [(h * scale[0] + bias[0]) * (vx / vz), (h * scale[1] + bias[1]) * (vy / vz)]
}

/// The same with offset limiting, (h scale + bias) v_xy: never longer than the height, right from straight above, too
/// short but steady at shallow angles.
///
/// ```
/// use texbake::shading::{limited_offset, welsh_offset};
///
/// let (scale, bias, eye) = ([0.04; 2], [-0.02; 2], [0.8, 0.0, 0.6]);
/// assert_eq!(limited_offset(1.0, scale, bias, eye), [0.016, 0.0]);
/// assert_eq!(welsh_offset(0.5, scale, bias, eye), [0.0, 0.0]);
/// ```
pub fn limited_offset(h: f32, scale: [f32; 2], bias: [f32; 2], [vx, vy, _]: [f32; 3]) -> [f32; 2] {
    [(h * scale[0] + bias[0]) * vx, (h * scale[1] + bias[1]) * vy]
}
