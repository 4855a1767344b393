// Parallax mapping in k steps through a parallax map (FGED2 section 7.7, eq. 7.51, listing 7.9).
//
//   u = exaggeration s / (2 k r)         eq. 7.52, for each axis: s the scale in texels, r texels of the map
//   k times: offset += v_xy u p(uv + offset)
//
// The map holds p = n_z (2h - 1); decode is (multiply, add), by which a sample s becomes p = s multiply + add: (1, 0) for
// snorm and float channels, (255/127, -128/127) for 8 biased bits. One step is eq. 7.51. level: the mip level that is
// sampled. uv: texture coordinates. v: towards the eye, of length one, in tangent space, its x and y along growing u and v.
// Result: what to add to the texture coordinates. An exaggeration above 1 makes relief look deeper than it is.
//
// Their twins: src/shading/stepped_offset.rs.

fn step_scale(scale: f32, size: vec2<f32>, k: u32, exaggeration: f32) -> vec2<f32> {
    return exaggeration * scale / (2.0 * f32(k) * size);
}

fn stepped_offset(
    map: texture_2d<f32>, map_sampler: sampler, level: f32, decode: vec2<f32>,
    uv: vec2<f32>, v: vec3<f32>, u: vec2<f32>, k: u32,
) -> vec2<f32> {
    let step = v.xy * u;
    var offset = vec2<f32>(0.0);
    for (var i = 0u; i < k; i++) {
        let sample = textureSampleLevel(map, map_sampler, uv + offset, level).r;
        offset += step * (sample * decode.x + decode.y);
    }
    return offset;
}
