// Integers of 64 bits with a sign: two's complement, the low limb first.

// a b.
fn signed_product(a: i32, b: i32) -> vec2<u32> {
    return signed_times(vec2(u32(a), u32(a >> 31u)), b);
}

// a b, if it fits.
fn signed_times(a: vec2<u32>, b: i32) -> vec2<u32> {
    let low = product(a.x, u32(b));
    // As an unsigned number, a negative b is 2^32 too great.
    return vec2(low.x, low.y + a.y * u32(b) - select(0u, a.x, b < 0));
}

fn negated(a: vec2<u32>) -> vec2<u32> {
    return vec2(0u - a.x, ~a.y + u32(a.x == 0u));
}

fn is_negative(a: vec2<u32>) -> bool {
    return (a.y >> 31u) != 0u;
}

fn magnitude(a: vec2<u32>) -> vec2<u32> {
    return select(a, negated(a), is_negative(a));
}
