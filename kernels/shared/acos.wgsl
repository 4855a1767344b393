// The angle of a cosine, in fixed point: the float nearest to the double nearest to it.
//
// CPU twin: src/exact/acos.rs, which says how and why. Here the root is up to 9 units less, and the series is summed in
// fewer limbs: its first terms, of which at most 2^-32 is left in the sum, in 32 bits, each step off by 2 units of
// 2^-31, of which z leaves a quarter to the next; the others without the lowest product, off by 3 units of 2^-63. So P
// is off by 7 units, and the angle by less than 12 of 2^-62. No float's angle is so near to where it would round
// otherwise: the nearest leaves 39 units.

const PI_62: vec2<u32> = vec2(0x2168c235u, 0xc90fdaa2u);       // pi in units of 2^-62
const HALF_PI_62: vec2<u32> = vec2(0x10b4611au, 0x6487ed51u);  // pi/2
const HALF: u32 = 0x3f000000u;

const TERMS: u32 = 28u;       // of the series
const LONG_TERMS: u32 = 16u;  // of these, what takes 64 bits

// acos(x), for x from -1 to 1.
fn angle(cosine: u32) -> u32 {
    let m = significand_of(cosine);
    let is_small = (cosine & ~SIGN) <= HALF;
    // w, and z = w^2, in units of 2^-64.
    var w: vec2<u32>;
    var z: vec2<u32>;
    if (is_small) {
        w = shifted64(m, exponent_of(cosine) - 86);
        z = high64(w, w);
    } else {
        // (1 - |x|) 2^24; the leading one of 1 stands a place higher.
        let n = 0x1000000u - (m << u32(exponent_of(cosine) - 126));
        w = root_of_half(n);
        z = vec2(0u, n << 7u);
    }
    // P(z) in units of 2^-63.
    // Counted upwards: then drivers know how often.
    var first = 0u;
    for (var k = 0u; k < TERMS - LONG_TERMS; k++) {
        first = product(first, z.y).y + SERIES[TERMS - 1u - k].y;
    }
    var p = vec2(0u, first);
    for (var k = 0u; k < LONG_TERMS; k++) {
        p = sum64(nearly_high64(p, z), SERIES[LONG_TERMS - 1u - k]);
    }
    let arcsine = high64(w, p);
    // Of acos(|x|), in units of 2^-62.
    let halved = vec2((arcsine.x >> 1u) | (arcsine.y << 31u), arcsine.y >> 1u);
    let of_magnitude = select(arcsine, difference64(HALF_PI_62, halved), is_small);
    let negative = (cosine & SIGN) != 0u;
    return twice_rounded(select(of_magnitude, difference64(PI_62, of_magnitude), negative));
}

// sqrt(n 2^-25) in units of 2^-64, or up to 9 less; n < 2^23.
fn root_of_half(n: u32) -> vec2<u32> {
    if (n == 0u) {
        return vec2(0u);
    }
    // v = n 2^(s - 32), from 1/4 to 1; s is odd, so that sqrt(n 2^-25) = sqrt(v) 2^((7 - s)/2).
    let s = (countLeadingZeros(n) - 1u) | 1u;
    let v = n << s;
    // h = 1 / (2 sqrt(v)) in units of 2^-64, never more: the native estimate, made less by 2^-18 of itself, which is
    // several times its error. Two of Newton's steps, 2 h (3/4 - v h^2), leave an error of 7 units.
    var h = vec2(0u, u32(inverseSqrt(f32(v)) * 140736951484416.0));
    for (var step = 0u; step < 2u; step++) {
        let vhh = times64(high64(h, h), v).yz;
        let next = high64(h, difference64(vec2(0xfffffffeu, 0xbfffffffu), vhh));
        h = vec2(next.x << 1u, (next.y << 1u) | (next.x >> 31u));
    }
    // sqrt(v) / 2 = v h.
    let half_root = times64(h, v).yz;
    let right = (s - 9u) >> 1u;
    return vec2((half_root.x >> right) | ((half_root.y << 1u) << (31u - right)), half_root.y >> right);
}

// The float nearest to the double nearest to a 2^-62; a is zero or at least 2^50.
fn twice_rounded(a: vec2<u32>) -> u32 {
    if (a.y == 0u) {
        return 0u;
    }
    let left = countLeadingZeros(a.y);
    let n = vec2(a.x << left, (a.y << left) | ((a.x >> 1u) >> (31u - left)));
    // 53 bits are kept, of which the last is the 12th.
    let kept = sum64(n, vec2(0x3ffu + ((n.x >> 11u) & 1u), 0u));
    let sticky = u32((kept.x >> 11u) != 0u || (kept.y & 31u) != 0u);
    return rounded(0u, 128 - i32(left), (kept.y >> 5u) | sticky);
}

// a 2^n cut to an integer, n <= 40, for a result below 2^64.
fn shifted64(a: u32, n: i32) -> vec2<u32> {
    if (n < 0) {
        return vec2(a >> u32(min(-n, 31)), 0u);
    }
    if (n < 32) {
        return product(a, 1u << u32(n));
    }
    return vec2(0u, a << u32(n - 32));
}

// The high half of a b.
fn high64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = product(a.x, b.x).y;
    let cross1 = product(a.x, b.y);
    let cross2 = product(a.y, b.x);
    let carried = sum64(sum64(vec2(low, 0u), vec2(cross1.x, 0u)), vec2(cross2.x, 0u)).y;
    let upper = sum64(product(a.y, b.y), vec2(carried, 0u));
    return sum64(sum64(upper, vec2(cross1.y, 0u)), vec2(cross2.y, 0u));
}

// The same, or up to 2 less.
fn nearly_high64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let crosses = sum64(vec2(product(a.x, b.y).y, 0u), vec2(product(a.y, b.x).y, 0u));
    return sum64(product(a.y, b.y), crosses);
}

// a - b.
fn difference64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2(a.x - b.x, a.y - b.y - u32(a.x < b.x));
}

// (2k)! / (4^k k!^2 (2k + 1)) in units of 2^-63.
const SERIES = array<vec2<u32>, 28>(
    vec2(0x00000000u, 0x80000000u),
    vec2(0x55555555u, 0x15555555u),
    vec2(0x9999999au, 0x09999999u),
    vec2(0xb6db6db7u, 0x05b6db6du),
    vec2(0xe38e38e4u, 0x03e38e38u),
    vec2(0xd1745d17u, 0x02dd1745u),
    vec2(0xd89d89d9u, 0x02389d89u),
    vec2(0x9999999au, 0x01c99999u),
    vec2(0x87878788u, 0x017a8787u),
    vec2(0xd79435e5u, 0x013fde50u),
    vec2(0xf3cf3cf4u, 0x0112ef3cu),
    vec2(0xbd37a6f5u, 0x00ef9de9u),
    vec2(0xb851eb85u, 0x00d3431eu),
    vec2(0x097b425fu, 0x00bc16edu),
    vec2(0x469ee584u, 0x00a8dd18u),
    vec2(0xef7bdef8u, 0x0098b41du),
    vec2(0xa2e8ba2fu, 0x008af74eu),
    vec2(0xedb6db6eu, 0x007f2be3u),
    vec2(0x383759f2u, 0x0074f4aau),
    vec2(0x5ec4ec4fu, 0x006c09bdu),
    vec2(0xfd831f38u, 0x006432ddu),
    vec2(0x935f417du, 0x005d4379u),
    vec2(0xbbeaaaabu, 0x005717d5u),
    vec2(0x543df51bu, 0x00519302u),
    vec2(0x1b17cbc1u, 0x004c9d56u),
    vec2(0x5c2b9697u, 0x0048234du),
    vec2(0x17ea5827u, 0x004414afu),
    vec2(0x8f08a6fbu, 0x004063e5u),
);
