// Unsigned integers of several 32-bit limbs, the lowest first. WGSL has no 64-bit integers and no high half of a product.

// a b, 64 bits.
fn product(a: u32, b: u32) -> vec2<u32> {
    let a0 = a & 0xffffu;
    let a1 = a >> 16u;
    let b0 = b & 0xffffu;
    let b1 = b >> 16u;
    let cross = a1 * b0 + ((a0 * b0) >> 16u);
    let middle = a0 * b1 + (cross & 0xffffu);
    return vec2(a * b, a1 * b1 + (cross >> 16u) + (middle >> 16u));
}

// a + b, 64 bits.
fn sum64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2(low, a.y + b.y + u32(low < a.x));
}

// a + b, 96 bits.
fn sum96(a: vec3<u32>, b: vec3<u32>) -> vec3<u32> {
    let low = a.x + b.x;
    let upper = sum64(sum64(a.yz, b.yz), vec2(u32(low < a.x), 0u));
    return vec3(low, upper);
}

// a + b, 128 bits.
fn sum128(a: vec4<u32>, b: vec4<u32>) -> vec4<u32> {
    let low = sum64(a.xy, b.xy);
    let carry = u32(!at_least64(low, a.xy));
    return vec4(low, sum64(sum64(a.zw, b.zw), vec2(carry, 0u)));
}

// a^2 for a below 2^48, 96 bits.
fn square96(a: vec2<u32>) -> vec3<u32> {
    let low = product(a.x, a.x);
    let cross = product(a.x, a.y);
    let twice = vec2(cross.x << 1u, (cross.y << 1u) | (cross.x >> 31u));
    let upper = sum64(vec2(low.y, a.y * a.y), twice);
    return vec3(low.x, upper);
}

// a^2, 128 bits.
fn square128(a: vec2<u32>) -> vec4<u32> {
    let low = product(a.x, a.x);
    let cross = product(a.x, a.y);
    let twice = vec3(cross.x << 1u, (cross.y << 1u) | (cross.x >> 31u), cross.y >> 31u);
    return vec4(low.x, sum96(vec3(low.y, product(a.y, a.y)), twice));
}

// a b, 96 bits, for a below 2^64.
fn times64(a: vec2<u32>, b: u32) -> vec3<u32> {
    let p0 = product(a.x, b);
    let p1 = product(a.y, b);
    return vec3(p0.x, sum64(p1, vec2(p0.y, 0u)));
}

// a b, 128 bits.
fn times96(a: vec3<u32>, b: u32) -> vec4<u32> {
    let p0 = product(a.x, b);
    let p1 = product(a.y, b);
    let p2 = product(a.z, b);
    let middle = sum64(p1, vec2(p0.y, 0u));
    return vec4(p0.x, middle.x, sum64(p2, vec2(middle.y, 0u)));
}

// 160 bits, the lowest limb first.
struct U160 {
    low: vec4<u32>,
    high: u32,
}

// a b, 160 bits.
fn times128(a: vec4<u32>, b: u32) -> U160 {
    let lower = times64(a.xy, b);
    let upper = sum96(times64(a.zw, b), vec3(lower.z, 0u, 0u));
    return U160(vec4(lower.xy, upper.xy), upper.z);
}

// a >= b, 64 bits.
fn at_least64(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.y > b.y || (a.y == b.y && a.x >= b.x);
}

// a >= b, 128 bits.
fn at_least128(a: vec4<u32>, b: vec4<u32>) -> bool {
    let upper_equal = all(a.zw == b.zw);
    return select(at_least64(a.zw, b.zw), at_least64(a.xy, b.xy), upper_equal);
}

// a >= b, 160 bits.
fn at_least160(a: U160, b: U160) -> bool {
    return a.high > b.high || (a.high == b.high && at_least128(a.low, b.low));
}

// Nearly a.
fn float64(a: vec2<u32>) -> f32 {
    return f32(a.x) + f32(a.y) * 4294967296.0;
}

// Nearly a.
fn float96(a: vec3<u32>) -> f32 {
    return f32(a.x) + (f32(a.y) + f32(a.z) * 4294967296.0) * 4294967296.0;
}

// Nearly a, for a below 2^127.
fn float128(a: vec4<u32>) -> f32 {
    return float64(a.xy) + float64(a.zw) * 18446744073709551616.0;
}
