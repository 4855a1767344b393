// The codes of four components in native f32: each may be its neighbour.

// The components themselves, their halves, or rounded half up to integers.
fn fast_codes(output: Output, is_float: bool, bits: u32, components: vec4<f32>) -> vec4<u32> {
    if (bits == 32u) {
        return bitcast<vec4<u32>>(components);
    }
    if (is_float) {
        let c = bitcast<vec4<u32>>(components);
        return vec4(half_bits(c.x), half_bits(c.y), half_bits(c.z), half_bits(c.w));
    }
    let codes = components * (f32(output.code_m) * 0.5) + (f32(output.code_c) + 1.0) * 0.5;
    return vec4<u32>(vec4<i32>(floor(codes)) + output.code_offset) & vec4(output.code_mask);
}
