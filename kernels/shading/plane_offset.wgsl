// Parallax by the plane of a texel (FGED2 section 7.7, eq. 7.50), limited as Welsh limits his offsets.
//
//   p = n_z h / (n . v) v        its part p_xy is the offset
//
// n: the normal of the texel, of length one, n_z above zero. h: the height of its plane above the surface, in any unit.
// v: towards the eye, in tangent space, of any length between 2^-40 and 2^40: the offset does not depend on it.
// limit: the longest offset in heights, between 2^-40 and 2^40; 1 is Welsh's, by which an offset is never longer than the
// height. At or below zero there is no offset. All arguments must be finite: WGSL lets a device take it that they are.
// Result: what to add to the texture coordinates, in the unit of h.
//
// Near n . v = 0 eq. 7.50 has no bound; below, the eye is behind the plane, sees none of it, and the offset would point
// away from the eye. Here both keep the direction of v_xy and the length limit |h|: there is no step as the eye passes
// through the plane. Where no direction is left (v_xy = 0 and v_z not above zero) there is no offset.
//
// Its twin: src/shading/plane_offset.rs.

fn plane_offset(n: vec3<f32>, h: f32, v: vec3<f32>, limit: f32) -> vec2<f32> {
    let along = n.z * v.xy;
    let rise = max(dot(n, v), sqrt(dot(along, along)) / limit);
    if (limit <= 0.0 || rise <= 0.0) {
        return vec2<f32>(0.0);
    }
    return h * (along / rise);
}
