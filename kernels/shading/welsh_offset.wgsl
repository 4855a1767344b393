// Parallax mapping (Terry Welsh, Parallax Mapping with Offset Limiting, 2004).
//
//   T_n = T_o + h_sb V_xy / V_z          h_sb = h scale + bias
//   T_n = T_o + h_sb V_xy                with offset limiting: never longer than the height
//
// h: the height in [0, 1]. scale: the height of h = 1 in texture coordinates, for each axis: s / r for a scale of s texels
// and a map of r. bias: -scale / 2, so that a height of 1/2 moves nothing. (Welsh's text has s / 2; the minus of his
// programs is right.) v: towards the eye, in tangent space, of length one, v.z above zero.
// Result: what to add to the texture coordinates.
//
// Their twins: src/shading/welsh_offset.rs.

fn welsh_offset(h: f32, scale: vec2<f32>, bias: vec2<f32>, v: vec3<f32>) -> vec2<f32> {
    return (h * scale + bias) * (v.xy / v.z);
}

fn limited_offset(h: f32, scale: vec2<f32>, bias: vec2<f32>, v: vec3<f32>) -> vec2<f32> {
    return (h * scale + bias) * v.xy;
}
