// Any heights in native f32: a code may be its neighbour. The steps are those of float_heights.wgsl.

fn bake_texel(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> Texel {
    let normal = fast_normal(north, middle, south);
    var texel: Texel;
    if (NORMAL_CODES > 0u) {
        texel.normal = vec3(
            fast_code(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.x),
            fast_code(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.y),
            fast_code(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.z),
        );
    }
    if (PARALLAX_BITS > 0u) {
        let parallax = normal.z * height_above_middle(middle.y);
        texel.parallax = fast_code(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, parallax);
    }
    return texel;
}

fn fast_normal(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<f32> {
    let slope = vec2(bitcast<f32>(params.kx), bitcast<f32>(params.ky)) * sums_over_64(north, middle, south);
    let steep = max(abs(slope.x), abs(slope.y)) >= 0x1p-4f;
    let leaning = slope * select(0x1p64f, 0x1p-30f, steep);
    let z = select(1.0, 0x1p-94f, steep);
    return vec3(leaning, z) * inverseSqrt(dot(leaning, leaning) + z * z);
}

// 2h - 1.
fn height_above_middle(height: u32) -> f32 {
    if (HEIGHT_BITS < 32u) {
        return f32(twice_above_middle(height)) * select(1.0 / 255.0, 1.0 / 65535.0, HEIGHT_BITS == 16u);
    }
    return 2.0 * clamp(bitcast<f32>(height), 0.0, 1.0) - 1.0;
}

// Gx / 64, Gy / 64.
fn sums_over_64(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec2<f32> {
    if (HEIGHT_BITS < 32u) {
        return vec2<f32>(integer_sums(north, middle, south)) * 0x1p-6f;
    }
    let n = bitcast<vec3<f32>>(north) * 0x1p-6f;
    let m = bitcast<vec3<f32>>(middle) * 0x1p-6f;
    let s = bitcast<vec3<f32>>(south) * 0x1p-6f;
    return vec2(
        f32(params.outer) * ((n.z - n.x) + (s.z - s.x)) + f32(params.centre) * (m.z - m.x),
        f32(params.outer) * ((s.x - n.x) + (s.z - n.z)) + f32(params.centre) * (s.y - n.y),
    );
}
