// Float heights in IEEE binary32, in the order of src/ops/normal/reference.rs.
//
// Numbers are bit patterns for soft_float.wgsl. What repeats is a loop, so that drivers compile each step once.

const ONE: u32 = 0x3f800000u;
const SMALLEST_HEIGHT: u32 = 0x12800000u;     // 2^-90: heights below count as zero
const SMALLEST_SLOPE: u32 = 0x13000000u;      // 2^-89: slopes below 2^-25, over 2^64, count as zero
const STEEP: u32 = 0x3d800000u;               // 2^-4: slopes from 2^60 on, over 2^64
const SMALLEST_COMPONENT: u32 = 0x0d800000u;  // 2^-100: components below count as zero

fn normal_codes(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<u32> {
    let n = vec3(over_64(north.x), over_64(north.y), over_64(north.z));
    let m = vec3(over_64(middle.x), 0u, over_64(middle.z));
    let s = vec3(over_64(south.x), over_64(south.y), over_64(south.z));
    var slope: vec2<u32>;
    for (var axis = 0u; axis < 2u; axis++) {
        let down = axis == 1u;
        let outer = add(
            sub(select(n.z, s.x, down), n.x),
            sub(s.z, select(s.x, n.z, down)),
        );
        let centre = sub(select(m.z, s.y, down), select(m.x, n.y, down));
        let sum = add(mul(bits_of(f32(params.outer)), outer), mul(bits_of(f32(params.centre)), centre));
        slope[axis] = zero_below(SMALLEST_SLOPE, mul(sum, select(params.kx, params.ky, down)));
    }
    let steep = max(slope.x & ~SIGN, slope.y & ~SIGN) >= STEEP;
    let unit = select(64, -30, steep);
    var normal = vec3(scaled(slope.x, unit), scaled(slope.y, unit), select(ONE, 0x10800000u, steep));  // z: 1 or 2^-94
    var square = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        square = add(square, mul(normal[axis], normal[axis]));
    }
    let scale = inverse(square_root(square));
    var codes: vec3<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        codes[axis] = float_code(zero_below(SMALLEST_COMPONENT, mul(normal[axis], scale)));
    }
    return codes;
}

fn over_64(height: u32) -> u32 {
    return scaled(zero_below(SMALLEST_HEIGHT, height), -6);
}

// a, or zero if its magnitude is below `least`.
fn zero_below(least: u32, a: u32) -> u32 {
    return select(a, 0u, (a & ~SIGN) < least);
}

// The code of a component: itself, its half, or rounded half up to an integer.
fn float_code(component: u32) -> u32 {
    if (CODE_BITS == 32u) {
        return component;
    }
    if (CODE_IS_FLOAT) {
        return half_bits(component);
    }
    let factor = bits_of(f32(params.code_m) * 0.5);
    let centre = bits_of((f32(params.code_c) + 1.0) * 0.5);
    return stored_code(floor_to_int(add(mul(component, factor), centre)));
}

// The bits of a small integer or half of one: native arithmetic is exact on those.
fn bits_of(a: f32) -> u32 {
    return bitcast<u32>(a);
}
