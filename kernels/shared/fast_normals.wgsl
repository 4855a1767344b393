// Normals of any codes in native f32, four at a time. The steps are those of float_normals.wgsl.

struct Floats {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn fast_normals(input: Input, codes_of_texel: u32, bits: u32, codes: Texels) -> Floats {
    if (bits < 32u) {
        let u = integer_normals(input, codes_of_texel, codes);
        let over_greatest = bitcast<f32>(input.over_greatest);
        return Floats(vec4<f32>(u.x) * over_greatest, vec4<f32>(u.y) * over_greatest, vec4<f32>(u.z) * over_greatest);
    }
    let x = not_tiny(bitcast<vec4<f32>>(codes.x));
    let y = not_tiny(bitcast<vec4<f32>>(codes.y)) * f32(input.green);
    if (codes_of_texel == 2u) {
        return Floats(x, y, sqrt(max(vec4(1.0) - (x * x + y * y), vec4(0x1p-48f))));
    }
    return Floats(x, y, max(bitcast<vec4<f32>>(codes.z), vec4(0x1p-24f)));
}

fn not_tiny(v: vec4<f32>) -> vec4<f32> {
    return select(v, vec4(0.0), abs(v) < vec4(0x1p-25f));
}
