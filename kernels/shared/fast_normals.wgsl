// Normals of any codes in native f32. The steps are those of float_normals.wgsl.

fn fast_normal(input: Input, codes_of_texel: u32, bits: u32, codes: vec3<u32>) -> vec3<f32> {
    if (bits < 32u) {
        return vec3<f32>(integer_normal(input, codes_of_texel, codes)) * bitcast<f32>(input.over_greatest);
    }
    let stored = bitcast<vec3<f32>>(codes);
    let v = select(stored.xy, vec2(0.0), abs(stored.xy) < vec2(0x1p-25f));
    let leaning = v * vec2(1.0, f32(input.green));
    if (codes_of_texel == 2u) {
        return vec3(leaning, sqrt(max(1.0 - dot(v, v), 0x1p-48f)));
    }
    return vec3(leaning, max(stored.z, 0x1p-24f));
}
