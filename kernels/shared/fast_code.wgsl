// The code of a component in native f32: it may be its neighbour.

// The component itself, its half, or rounded half up to an integer.
fn fast_code(output: Output, is_float: bool, bits: u32, component: f32) -> u32 {
    if (bits == 32u) {
        return bitcast<u32>(component);
    }
    if (is_float) {
        return half_bits(bitcast<u32>(component));
    }
    let code = component * (f32(output.code_m) * 0.5) + (f32(output.code_c) + 1.0) * 0.5;
    return stored_code(output, i32(floor(code)));
}
