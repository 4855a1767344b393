//! Parallax by the plane of a texel.

/// The offset p_xy of p = n_z h / (n · v) v (FGED2 eq. 7.50), never longer than `limit` times |h|.
///
/// `n` is the normal of the texel, of length one, with z above zero; `h` the height of its plane above the surface, in
/// any unit; `v` points to the eye, in tangent space, and has any length between 2^-40 and 2^40, on which nothing
/// depends. The result is to be added to the texture coordinates, in the unit of `h`.
///
/// Where n · v comes near zero eq. 7.50 has no bound, and textures swim. Terry Welsh, Parallax Mapping with Offset
/// Limiting, 2004, lets no offset be longer than the height: that is a `limit` of 1, which leaves eq. 7.50 as it is up
/// to 45 degrees from above a flat texel; a limit of 3 leaves it up to 71. An eye below the plane sees none of it, and
/// eq. 7.50 would point away from it: there the offset stays as it is at the plane, so that none jumps where bumps turn
/// away. With `v` straight down, where no direction is left, it is zero.
///
/// `limit` is a number between 2^-40 and 2^40; at or below zero it lets no offset through, and the result is zero. All
/// arguments must be finite: WGSL lets a device take it that they are, so neither this nor the shader looks for NaN and
/// infinities, and what comes of them means nothing.
///
/// ```
/// use texbake::shading::plane_offset;
///
/// let flat = [0.0, 0.0, 1.0];
/// assert_eq!(plane_offset(flat, 0.5, [1.0, 0.0, 2.0], 1.0), [0.25, 0.0]);
/// assert_eq!(plane_offset(flat, 0.5, [4.0, 0.0, 2.0], 1.0), [0.5, 0.0]); // eq. 7.50 says 1
/// assert_eq!(plane_offset(flat, 0.5, [1.0, 0.0, 2.0], 0.0), [0.0, 0.0]);
/// ```
pub fn plane_offset([nx, ny, nz]: [f32; 3], h: f32, [vx, vy, vz]: [f32; 3], limit: f32) -> [f32; 2] {
    let along = [nz * vx, nz * vy];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    let rise = (nx * vx + ny * vy + nz * vz).max(length / limit);
    if limit <= 0.0 || rise <= 0.0 {
        return [0.0; 2];
    }
    along.map(|part| h * (part / rise))
}
