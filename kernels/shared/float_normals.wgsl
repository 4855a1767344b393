// Normals of any codes in IEEE binary32, in the order of `floats` (src/ops/layer.rs): bit patterns for soft_float.wgsl.

const SMALLEST_LEANING: u32 = 0x33000000u;  // 2^-25: x and y below count as zero
const LEAST_Z: u32 = 0x33800000u;           // 2^-24
const LEAST_ZZ: u32 = 0x27800000u;          // 2^-48

// What is left to do for each of four texels: floats as they are, or integers over L as floats.
fn float_texels(input: Input, codes_of_texel: u32, bits: u32, codes: Texels) -> Texels {
    if (bits == 32u) {
        return codes;
    }
    let u = integer_normals(input, codes_of_texel, codes);
    return Texels(
        bitcast<vec4<u32>>(vec4<f32>(u.x)),
        bitcast<vec4<u32>>(vec4<f32>(u.y)),
        bitcast<vec4<u32>>(vec4<f32>(u.z)),
    );
}

// The normal of one of them, its z above zero.
fn float_normal(input: Input, codes_of_texel: u32, bits: u32, codes: vec3<u32>) -> vec3<u32> {
    if (bits < 32u) {
        var u = codes;
        for (var axis = 0u; axis < 3u; axis++) {
            u[axis] = mul(u[axis], input.over_greatest);
        }
        return u;
    }
    let x = zero_below(SMALLEST_LEANING, codes.x);
    let y = zero_below(SMALLEST_LEANING, codes.y);
    let turned = y ^ select(0u, SIGN, input.green < 0);
    if (codes_of_texel == 2u) {
        let zz = sub(ONE, add(mul(x, x), mul(y, y)));
        return vec3(x, turned, square_root(at_least(LEAST_ZZ, zz)));
    }
    return vec3(x, turned, at_least(LEAST_Z, codes.z));
}

// a, or `least` above zero if a is below it.
fn at_least(least: u32, a: u32) -> u32 {
    return select(max(a, least), least, (a & SIGN) != 0u);
}
