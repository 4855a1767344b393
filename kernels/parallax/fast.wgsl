// Any maps in native f32: a code may be its neighbour. The steps are those of floats.wgsl.

fn parallax_code(height: u32, codes: vec3<u32>) -> u32 {
    let normal = fast_normal(params.normals, NORMAL_CODES, NORMAL_BITS, codes);
    let z = normal.z * inverseSqrt(dot(normal, normal));
    return fast_code(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, z * height_above_middle(height));
}

// 2h - 1.
fn height_above_middle(height: u32) -> f32 {
    if (HEIGHT_BITS < 32u) {
        return f32(twice_above_middle(height)) * bitcast<f32>(params.heights.over_greatest);
    }
    return 2.0 * clamp(bitcast<f32>(height), 0.0, 1.0) - 1.0;
}
