//! Parallax mapping in steps through a parallax map.

use std::num::NonZeroU32;

/// What a step multiplies the vector to the eye by, for each axis: u = `exaggeration` s / (2 k r) (FGED2 eq. 7.52), with
/// the scale s in texels and r texels of the map. An exaggeration above 1 makes relief look deeper than it is.
pub fn step_scale(scale: [f32; 2], size: [f32; 2], k: NonZeroU32, exaggeration: f32) -> [f32; 2] {
    [0, 1].map(|axis| exaggeration * scale[axis] / (2.0 * k.get() as f32 * size[axis]))
}

/// The offset after `k` steps, each of v_xy u p, p = n_z (2h - 1) being what `parallax` gives for texture coordinates
/// (FGED2 listing 7.9; a single step is eq. 7.51). To be added to the texture coordinates.
///
/// `v` points to the eye, in tangent space, its x and y along growing u and v; it is of length one. `u` is
/// [`step_scale`]'s.
///
/// ```
/// use texbake::shading::{step_scale, stepped_offset};
///
/// let u = step_scale([24.0; 2], [512.0; 2], 4.try_into()?, 1.0);
/// let high = |_| 1.0;
/// assert_eq!(stepped_offset(high, [0.5, 0.5], [0.8, 0.0, 0.6], u, 4.try_into()?), [0.8 * 24.0 / 1024.0, 0.0]);
/// # Ok::<(), std::num::TryFromIntError>(())
/// ```
pub fn stepped_offset(
    parallax: impl Fn([f32; 2]) -> f32,
    uv: [f32; 2],
    [vx, vy, _]: [f32; 3],
    u: [f32; 2],
    k: NonZeroU32,
) -> [f32; 2] {
    let step = [vx * u[0], vy * u[1]];
    (0..k.get()).fold([0.0; 2], |[x, y], _| {
        let p = parallax([uv[0] + x, uv[1] + y]);
        [x + step[0] * p, y + step[1] * p]
    })
}
