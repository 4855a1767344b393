// Integer heights to float codes, correctly rounded: the components cut to odd in integers, then rounded once.
// CPU twin: src/exact/float.rs.

// Bits of a cut component: enough for one correct rounding to 24 bits, or exactly an f32 on the way to a half.
const CUT_TO_F32: i32 = 26;
const CUT_TO_F16: i32 = 22;

fn normal_codes(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<u32> {
    let n = wide_normal(integer_sums(north, middle, south));
    return vec3(
        nearest_float(n.negative.x, n.estimate.x, n.xx, n.s),
        nearest_float(n.negative.y, n.estimate.y, n.yy, n.s),
        nearest_float(false, n.estimate.z, n.zz, n.s),
    );
}

// The bits of the float nearest to sqrt(aa / s), or to its negative; zero is positive.
fn nearest_float(negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    if (all(aa == vec3(0u))) {
        return 0u;
    }
    let sign = select(0u, SIGN, negative);
    let bits = select(CUT_TO_F32, CUT_TO_F16, CODE_BITS == 16u);
    // estimate = significand 2^(e - 23), so it has `bits` bits before the point when shifted by bits - 1 - e.
    let estimated = bitcast<u32>(estimate);
    let shift = bits - 1 - (exponent_of(estimated) - 127);
    let significand = significand_of(estimated);
    let guess = select(significand >> 2u, significand << 2u, bits == CUT_TO_F32);
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
    if (CODE_BITS == 16u) {
        return half_bits(rounded(sign, 149 - shift, odd << 3u));
    }
    return rounded(sign, 152 - shift, odd);
}

// 160 bits, the lowest limb first.
struct U160 {
    low: vec4<u32>,
    high: u32,
}

// n^2 s for n below 2^28.
fn square_times(n: u32, s: vec3<u32>) -> U160 {
    let square = product(n, n);
    let a = times(s, square.x);
    let b = times(s, square.y);
    let low = sum64(a.yz, b.xy);
    let carry = u32(!at_least64(low, a.yz));
    let high = sum64(sum64(vec2(a.w, 0u), b.zw), vec2(carry, 0u));
    return U160(vec4(a.x, low, high.x), high.y);
}

// a 2^n for a result below 2^160.
fn shifted160(a: vec3<u32>, n: u32) -> U160 {
    var limbs = vec4(a, 0u);
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

fn at_least160(a: U160, b: U160) -> bool {
    return a.high > b.high || (a.high == b.high && at_least128(a.low, b.low));
}
