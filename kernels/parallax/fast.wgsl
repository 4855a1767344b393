// Any maps in native f32: a code may be its neighbour. The steps are those of floats.wgsl.

fn parallax_four(heights: vec4<u32>, normals: Texels) -> vec4<u32> {
    let v = fast_normals(params.normals, NORMAL_CODES, NORMAL_BITS, normals);
    let z = v.z * inverseSqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return fast_codes(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, z * height_above_middle(heights));
}

// 2h - 1.
fn height_above_middle(heights: vec4<u32>) -> vec4<f32> {
    if (HEIGHT_BITS < 32u) {
        return vec4<f32>(twice_above_middle(heights)) * bitcast<f32>(params.heights.over_greatest);
    }
    return 2.0 * clamp(bitcast<vec4<f32>>(heights), vec4(0.0), vec4(1.0)) - 1.0;
}
