// Vectors and their codes in IEEE binary32, in the order of `unit` (src/ops/bake/reference.rs) and `store_floats`.

const SMALLEST_COMPONENT: u32 = 0x0d800000u;  // 2^-100: components below count as zero

// (x, y, z) over its length.
fn unit(vector: vec3<u32>) -> vec3<u32> {
    var v = vector;
    // What repeats is a loop, so that drivers compile it once.
    var square = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        square = add(square, mul(v[axis], v[axis]));
    }
    let scale = inverse(square_root(square));
    for (var axis = 0u; axis < 3u; axis++) {
        v[axis] = zero_below(SMALLEST_COMPONENT, mul(v[axis], scale));
    }
    return v;
}

// The codes of three components.
fn float_codes(output: Output, is_float: bool, bits: u32, components: vec3<u32>) -> vec3<u32> {
    var codes = components;
    for (var axis = 0u; axis < 3u; axis++) {
        codes[axis] = float_code(output, is_float, bits, codes[axis]);
    }
    return codes;
}

// The code of a component: itself, its half, or rounded half up to an integer.
fn float_code(output: Output, is_float: bool, bits: u32, component: u32) -> u32 {
    if (bits == 32u) {
        return component;
    }
    if (is_float) {
        return half_bits(component);
    }
    let factor = bits_of(f32(output.code_m) * 0.5);
    let centre = bits_of((f32(output.code_c) + 1.0) * 0.5);
    return stored_code(output, floor_to_int(add(mul(component, factor), centre)));
}
