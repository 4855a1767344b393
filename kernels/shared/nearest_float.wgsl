// The float nearest to A / sqrt(S): cut to odd in integers, then rounded once.
//
// |A| < 2^53 and A^2 <= S < 2^107. CPU twin: src/exact/float.rs.

// Bits of a cut component: enough for one correct rounding to 24 bits, or exactly an f32 on the way to a half.
const CUT_TO_F32: i32 = 26;
const CUT_TO_F16: i32 = 22;

// The float of 16 or 32 `bits` nearest to sqrt(aa / s), or to its negative; zero is positive.
// `estimate` is nearly sqrt(aa / s).
fn nearest_float(bits: u32, negative: bool, estimate: f32, aa: vec4<u32>, s: vec4<u32>) -> u32 {
    if (all(aa == vec4(0u))) {
        return 0u;
    }
    let sign = select(0u, SIGN, negative);
    let cut_bits = select(CUT_TO_F32, CUT_TO_F16, bits == 16u);
    // estimate = significand 2^(e - 23), so it has `cut_bits` bits before the point when shifted by cut_bits - 1 - e.
    let estimated = bitcast<u32>(estimate);
    let shift = cut_bits - 1 - (exponent_of(estimated) - 127);
    let significand = significand_of(estimated);
    let guess = select(significand >> 2u, significand << 2u, bits != 16u);
    let goal = shifted160(aa, u32(2 * shift));
    // The greatest integer whose square over 4^shift is at most aa / s. The estimate is off by less than 64.
    var cut = guess - 64u;
    for (var step = 64u; step > 0u; step >>= 1u) {
        if (at_least160(goal, square_times(cut + step, s))) {
            cut += step;
        }
    }
    let inexact = u32(!at_least160(square_times(cut, s), goal));
    let odd = (cut << 1u) | inexact;
    if (bits == 16u) {
        return half_bits(rounded(sign, 149 - shift, odd << 3u));
    }
    return rounded(sign, 152 - shift, odd);
}

// n^2 s for a result below 2^160.
fn square_times(n: u32, s: vec4<u32>) -> U160 {
    let square = product(n, n);
    let low = times128(s, square.x);
    let high = times128(s, square.y);
    let upper = sum128(vec4(low.low.yzw, low.high), high.low);
    return U160(vec4(low.low.x, upper.xyz), upper.w);
}

// a 2^n for a result below 2^160.
fn shifted160(a: vec4<u32>, n: u32) -> U160 {
    var limbs = a;
    var high = 0u;
    for (var whole = n >> 5u; whole > 0u; whole -= 1u) {
        high = limbs.w;
        limbs = vec4(0u, limbs.xyz);
    }
    let bits = n & 31u;
    if (bits > 0u) {
        high = (high << bits) | (limbs.w >> (32u - bits));
        limbs = (limbs << vec4(bits)) | (vec4(0u, limbs.xyz) >> vec4(32u - bits));
    }
    return U160(limbs, high);
}
