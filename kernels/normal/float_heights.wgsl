// Float heights in IEEE binary32, in the order of src/ops/normal/reference.rs.

const SMALLEST_SLOPE: u32 = 0x13000000u;  // 2^-89: slopes below 2^-25, over 2^64, count as zero
const STEEP: u32 = 0x3d800000u;           // 2^-4: slopes from 2^60 on, over 2^64
const OVER_64: u32 = 0x3c800000u;         // 2^-6


fn normal_codes(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<u32> {
    let nw = mul(north.x, OVER_64);
    let n = mul(north.y, OVER_64);
    let ne = mul(north.z, OVER_64);
    let w = mul(middle.x, OVER_64);
    let e = mul(middle.z, OVER_64);
    let sw = mul(south.x, OVER_64);
    let s = mul(south.y, OVER_64);
    let se = mul(south.z, OVER_64);
    let gx = weighted(add(sub(ne, nw), sub(se, sw)), sub(e, w));
    let gy = weighted(add(sub(sw, nw), sub(se, ne)), sub(s, n));
    let slope_x = snapped(mul(gx, params.kx));
    let slope_y = snapped(mul(gy, params.ky));
    let steep = max(slope_x & ~SIGN, slope_y & ~SIGN) >= STEEP;
    let unit = select(0x5f800000u, 0x30800000u, steep);  // 2^64, 2^-30
    let z = select(0x3f800000u, 0x10800000u, steep);     // 1, 2^-94
    let x = mul(slope_x, unit);
    let y = mul(slope_y, unit);
    let scale = inverse(square_root(add(add(mul(x, x), mul(y, y)), mul(z, z))));
    return vec3(float_code(mul(x, scale)), float_code(mul(y, scale)), float_code(mul(z, scale)));
}

fn weighted(outer: u32, centre: u32) -> u32 {
    return add(mul(bits_of(f32(params.outer)), outer), mul(bits_of(f32(params.centre)), centre));
}

fn snapped(slope: u32) -> u32 {
    return select(slope, 0u, (slope & ~SIGN) < SMALLEST_SLOPE);
}

// The code of a component: itself, its half, or rounded half up to an integer.
fn float_code(component: u32) -> u32 {
    if (CODE_BITS == 32u) {
        return component;
    }
    if (CODE_IS_FLOAT) {
        return half_bits(component);
    }
    return stored_code(floor_to_int(add(mul(component, bits_of(f32(params.code_m) * 0.5)), bits_of((f32(params.code_c) + 1.0) * 0.5))));
}

// The bits of a small integer or half of one: native arithmetic is exact on those.
fn bits_of(a: f32) -> u32 {
    return bitcast<u32>(a);
}
