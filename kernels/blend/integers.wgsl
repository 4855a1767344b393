// Integer maps, correctly rounded: A / sqrt(S) with S the sum of the squares of the components A (DESIGN 3.1).
//
// Normals stand over L1 and L2, and what they become over what makes it an integer: the sum of both is multiplied by
// L1 L2, or q L1 L2, and so on.

// What S always fits. 64: codes are integers, and m A, m^2 S and t^2 S fit 32, 64 and 64 bits; 96: |A| < 2^48;
// 128: |A| < 2^53.
override S_BITS: u32 = 128u;

fn blended_codes(base: vec3<u32>, detail: vec3<u32>, weights: vec3<i32>) -> vec3<u32> {
    let v1 = integer_normal(params.base, BASE_CODES, base);
    let v2 = integer_normal(params.detail, DETAIL_CODES, detail);
    if (S_BITS == 64u) {
        return narrow_codes(narrow_sum(v1, v2, weights));
    }
    if (METHOD == RNM) {
        return wide_codes(reoriented(v1, v2));
    }
    return wide_codes(wide_sum(v1, v2, weights));
}

struct Factors {
    p: i32,
    f: vec3<i32>,
    r: i32,
    g: vec3<i32>,
}

fn factors(v1: vec3<i32>, v2: vec3<i32>, weights: vec3<i32>) -> Factors {
    let l1 = params.base.greatest;
    let l2 = params.detail.greatest;
    switch METHOD {
        case WEIGHTED: {
            return Factors(v2.z, vec3(weights.xx, 0), v1.z, vec3(weights.yy, weights.z));
        }
        case OVERLAY: {
            return Factors(1, vec3(l2), 1, vec3(l1) - abs(v1));
        }
        case UDN: {
            return Factors(1, vec3(l2), 1, vec3(l1, l1, 0));
        }
        case WHITEOUT: {
            return Factors(1, vec3(l2, l2, 0), 1, vec3(l1, l1, v1.z));
        }
        default: {
            return Factors(1, vec3(l2), 1, vec3(l1));
        }
    }
}

fn narrow_sum(v1: vec3<i32>, v2: vec3<i32>, weights: vec3<i32>) -> vec3<i32> {
    let by = factors(v1, v2, weights);
    let sum = by.p * by.f * v1 + by.r * by.g * v2;
    return select(sum, vec3(0, 0, 1), all(sum == vec3(0)));
}

fn narrow_codes(sum: vec3<i32>) -> vec3<u32> {
    let a = vec3<u32>(abs(sum));
    let s = sum64(sum64(product(a.x, a.x), product(a.y, a.y)), product(a.z, a.z));
    let scale = inverseSqrt(float64(s));
    return vec3(
        nearest_code64(params.normal, sum.x < 0, a.x, s, scale),
        nearest_code64(params.normal, sum.y < 0, a.y, s, scale),
        nearest_code64(params.normal, sum.z < 0, a.z, s, scale),
    );
}

fn wide_sum(v1: vec3<i32>, v2: vec3<i32>, weights: vec3<i32>) -> array<vec2<u32>, 3> {
    let by = factors(v1, v2, weights);
    var sum: array<vec2<u32>, 3>;
    for (var axis = 0u; axis < 3u; axis++) {
        sum[axis] = sum64(
            signed_times(signed_product(by.p, by.f[axis]), v1[axis]),
            signed_times(signed_product(by.r, by.g[axis]), v2[axis]),
        );
    }
    return sum;
}

// With t = (x1, y1, z1 + 1) and u = (-x2, -y2, z2): t (t.u) / t_z - u, times t_z.
fn reoriented(v1: vec3<i32>, v2: vec3<i32>) -> array<vec2<u32>, 3> {
    let l1 = params.base.greatest;
    let tz = v1.z + l1;
    let leaning = sum64(signed_product(v1.x, v2.x), signed_product(v1.y, v2.y));
    let tu = sum64(signed_product(tz, v2.z), negated(leaning));
    let ltz = signed_product(l1, tz);
    return array(
        sum64(signed_times(tu, v1.x), signed_times(ltz, v2.x)),
        sum64(signed_times(tu, v1.y), signed_times(ltz, v2.y)),
        signed_times(sum64(tu, negated(signed_product(l1, v2.z))), tz),
    );
}

fn wide_codes(sum: array<vec2<u32>, 3>) -> vec3<u32> {
    var a: array<vec2<u32>, 3>;
    var aa: array<vec4<u32>, 3>;
    var s: vec4<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        a[axis] = magnitude(sum[axis]);
        aa[axis] = square128(a[axis]);
        s = sum128(s, aa[axis]);
    }
    if (all(s == vec4(0u))) {
        a[2] = vec2(1u, 0u);
        aa[2] = vec4(1u, 0u, 0u, 0u);
        s = aa[2];
    }
    let scale = inverseSqrt(float128(s));
    var codes: vec3<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        codes[axis] = nearest(is_negative(sum[axis]), float64(a[axis]) * scale, aa[axis], s);
    }
    return codes;
}

// The code of sqrt(aa / s), or of its negative. `estimate` is nearly sqrt(aa / s).
fn nearest(negative: bool, estimate: f32, aa: vec4<u32>, s: vec4<u32>) -> u32 {
    if (NORMAL_IS_FLOAT) {
        return nearest_float(NORMAL_BITS, negative, estimate, aa, s);
    }
    if (S_BITS == 96u) {
        return nearest_code96(params.normal, negative, estimate, aa.xyz, s.xyz);
    }
    return nearest_code128(params.normal, negative, estimate, aa, s);
}
