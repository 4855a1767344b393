// IEEE binary32 in integers: round to nearest even. Numbers are bit patterns.
//
// WGSL's own + - * / sqrt may round otherwise, flush subnormals or be fused (DESIGN 3.2). No operand and no result is
// an infinity or NaN. What lies below 2^-126 is left to the file beside this one: gradual.wgsl is the whole of IEEE,
// flushing.wgsl is cheaper. Where a native estimate is used, integers correct it.
// CPU twin: Rust's f32.

const SIGN: u32 = 0x80000000u;

const ONE: u32 = 0x3f800000u;

// The bits of a small integer or half of one: native arithmetic is exact on those.
fn bits_of(a: f32) -> u32 {
    return bitcast<u32>(a);
}

// a, or zero if its magnitude is below `least`.
fn zero_below(least: u32, a: u32) -> u32 {
    return select(a, 0u, (a & ~SIGN) < least);
}

// a 2^n for a result that is zero or normal.
fn scaled(a: u32, n: i32) -> u32 {
    return select(a + (u32(n) << 23u), a, (a & ~SIGN) == 0u);
}

// a >> n whose lowest bit also says whether a one was shifted out.
fn shifted_sticky(a: u32, n: i32) -> u32 {
    let bits = u32(min(n, 31));
    return (a >> bits) | u32((a & ((1u << bits) - 1u)) != 0u);
}

fn add(a: u32, b: u32) -> u32 {
    let swap = (a & ~SIGN) < (b & ~SIGN);
    let x = select(a, b, swap);
    let y = select(b, a, swap);
    let subtract = ((x ^ y) & SIGN) != 0u;
    let mx = significand_of(x) << 3u;
    let my = shifted_sticky(significand_of(y) << 3u, exponent_of(x) - exponent_of(y));
    let m = select(mx + my, mx - my, subtract);
    return select(rounded(x & SIGN, exponent_of(x), m), select(x & SIGN, 0u, subtract), m == 0u);
}

fn sub(a: u32, b: u32) -> u32 {
    return add(a, b ^ SIGN);
}

fn mul(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    let ma = significand_of(a);
    let mb = significand_of(b);
    // 47 or 48 bits, of which 27 or 28 are kept and the others only noticed. Factors of 12 bits have a product that a
    // GPU computes fast.
    let a0 = ma & 0xfffu;
    let a1 = ma >> 12u;
    let b0 = mb & 0xfffu;
    let b1 = mb >> 12u;
    let low = a0 * b0;
    let middle = a1 * b0 + a0 * b1 + (low >> 12u);
    let m = ((a1 * b1) << 4u) + (middle >> 8u);
    let rest = (low & 0xfffu) | (middle & 0xffu);
    return select(rounded(sign, exponent_of(a) + exponent_of(b) - 127, m | u32(rest != 0u)), sign, m == 0u);
}

// The square root of a normal number above zero.
fn square_root(a: u32) -> u32 {
    // a = m 2^(2k), 2^24 <= m < 2^26.
    let e = exponent_of(a) - 151;
    let odd = e & 1;
    let m = significand_of(a) << u32(1 + odd);
    let k = (e - odd) >> 1u;
    // root = floor(sqrt(m 2^24)), 25 bits. The native estimate is off by a few of them, so the rest of 50 bits fits 32.
    var root = u32(sqrt(f32(m)) * 4096.0);
    var rest = i32((m << 24u) - root * root);
    root = u32(i32(root) + i32(floor(f32(rest) / f32(2u * root))));
    rest = i32((m << 24u) - root * root);
    if (rest < 0) {
        root -= 1u;
        rest += i32(2u * root + 1u);
    }
    if (rest > i32(2u * root)) {
        rest -= i32(2u * root + 1u);
        root += 1u;
    }
    return rounded(0u, k + 139, (root << 2u) | u32(rest != 0));
}

// 1 / a for a normal number a above zero whose inverse is normal.
fn inverse(a: u32) -> u32 {
    let m = significand_of(a);
    // quotient = floor(2^48 / m), at most 2^25. The native estimate is off by a few, so the rest of 48 bits fits 32.
    var quotient = u32(281474976710656.0 / f32(m));
    var rest = i32(0u - quotient * m);
    quotient = u32(i32(quotient) + i32(floor(f32(rest) / f32(m))));
    rest = i32(0u - quotient * m);
    if (rest < 0) {
        quotient -= 1u;
        rest += i32(m);
    }
    if (rest >= i32(m)) {
        quotient += 1u;
        rest -= i32(m);
    }
    return rounded(0u, 253 - exponent_of(a), (quotient << 2u) | u32(rest != 0));
}

// The greatest integer not above a, for |a| < 2^24.
fn floor_to_int(a: u32) -> i32 {
    let m = significand_of(a);
    let fraction_bits = u32(min(150 - exponent_of(a), 31));
    let whole = i32(m >> fraction_bits);
    let cut = i32((m & ((1u << fraction_bits) - 1u)) != 0u);
    return select(whole, -whole - cut, (a & SIGN) != 0u);
}

// The bits of the binary16 nearest to a, ties to even, |a| <= 1.
fn half_bits(a: u32) -> u32 {
    let sign = (a >> 16u) & 0x8000u;
    let e = exponent_of(a) - 112;  // exponent of a half
    // Ten bits of the 23 are kept; below the least normal half, fewer.
    let drop = 13 + max(1 - e, 0);
    let sticky = shifted_sticky(significand_of(a), drop - 2);
    let kept = sticky >> 2u;
    let up = u32((sticky & 3u) + (kept & 1u) > 2u);
    return sign | ((u32(max(e, 1) - 1) << 10u) + kept + up);
}
