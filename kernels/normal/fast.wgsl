// Any heights in native f32: a code may be its neighbour. The steps are those of float_heights.wgsl.

fn normal_codes(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<u32> {
    let slope = vec2(bitcast<f32>(params.kx), bitcast<f32>(params.ky)) * sums_over_64(north, middle, south);
    let steep = max(abs(slope.x), abs(slope.y)) >= 0x1p-4f;
    let leaning = slope * select(0x1p64f, 0x1p-30f, steep);
    let z = select(1.0, 0x1p-94f, steep);
    let normal = vec3(leaning, z) * inverseSqrt(dot(leaning, leaning) + z * z);
    return vec3(fast_code(normal.x), fast_code(normal.y), fast_code(normal.z));
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

// The code of a component: itself, its half, or rounded half up to an integer.
fn fast_code(component: f32) -> u32 {
    if (CODE_BITS == 32u) {
        return bitcast<u32>(component);
    }
    if (CODE_IS_FLOAT) {
        return half_bits(bitcast<u32>(component));
    }
    return stored_code(i32(floor(component * (f32(params.code_m) * 0.5) + (f32(params.code_c) + 1.0) * 0.5)));
}
