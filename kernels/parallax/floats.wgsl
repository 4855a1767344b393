// Maps of which one or both hold floats, in IEEE binary32, in the order of src/ops/parallax/reference.rs.

fn parallax_four(heights: vec4<u32>, normals: Texels) -> vec4<u32> {
    let texels = float_texels(params.normals, NORMAL_CODES, NORMAL_BITS, normals);
    var codes: vec4<u32>;
    for (var i = 0u; i < TEXELS; i++) {
        codes[i] = parallax_code(heights[i], texel_of(texels, i));
    }
    return codes;
}

fn parallax_code(height: u32, codes: vec3<u32>) -> u32 {
    let normal = float_normal(params.normals, NORMAL_CODES, NORMAL_BITS, codes);
    var h = height;
    if (HEIGHT_BITS < 32u) {
        h = mul(bits_of(f32(height)), params.heights.over_greatest);
    }
    let parallax = float_parallax(unit(normal).z, h);
    return float_code(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, parallax);
}
