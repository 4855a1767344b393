// Integer maps, correctly rounded: A / sqrt(S) with S the sum of the squares of the components A (DESIGN 3.1).
//
// Normals stand over L1 and L2, and what they become over what makes it an integer: the sum of both is multiplied by
// L1 L2, or q L1 L2, and so on.

// Whether estimates are near enough: |A| is below 2^31, and codes have 8 bits or S is below 2^49.
override ESTIMATED: bool = false;
// What S always fits. 64: codes are integers, and m A, m^2 S and t^2 S fit 32, 64 and 64 bits; 96: |A| < 2^48;
// 128: |A| < 2^53.
override S_BITS: u32 = 128u;

fn blended_four(base: Texels, detail: Texels, weights: Weights) -> Texels {
    let v1 = integer_normals(params.base, BASE_CODES, base);
    let v2 = integer_normals(params.detail, DETAIL_CODES, detail);
    var codes: Texels;
    var doubtful = vec4(true);
    if (ESTIMATED) {
        let estimate = estimated(four_sums(v1, v2, weights));
        codes = estimate.codes;
        doubtful = estimate.doubtful;
    }
    if (any(doubtful)) {
        // A loop, not four calls: drivers compile the arithmetic once.
        for (var i = 0u; i < TEXELS; i++) {
            if (doubtful[i]) {
                let exact = exact_codes(integers_of(v1, i), integers_of(v2, i), weights_of(weights, i));
                codes.x[i] = exact.x;
                codes.y[i] = exact.y;
                codes.z[i] = exact.z;
            }
        }
    }
    return codes;
}

struct Estimate {
    codes: Texels,
    doubtful: vec4<bool>,
}

// X, Y and Z of four texels that are below 2^31.
fn four_sums(v1: Integers, v2: Integers, weights: Weights) -> Integers {
    let l1 = params.base.greatest;
    let l2 = params.detail.greatest;
    switch METHOD {
        case WEIGHTED: {
            let p = weights.a * v2.z;
            let r = weights.b * v1.z;
            return Integers(p * v1.x + r * v2.x, p * v1.y + r * v2.y, weights.q * v1.z * v2.z);
        }
        case OVERLAY: {
            return Integers(
                l2 * v1.x + (l1 - abs(v1.x)) * v2.x,
                l2 * v1.y + (l1 - abs(v1.y)) * v2.y,
                l2 * v1.z + (l1 - abs(v1.z)) * v2.z,
            );
        }
        case UDN: {
            return Integers(l2 * v1.x + l1 * v2.x, l2 * v1.y + l1 * v2.y, l2 * v1.z);
        }
        case WHITEOUT: {
            return Integers(l2 * v1.x + l1 * v2.x, l2 * v1.y + l1 * v2.y, v1.z * v2.z);
        }
        case RNM: {
            let tz = v1.z + l1;
            let tu = tz * v2.z - (v1.x * v2.x + v1.y * v2.y);
            let ltz = l1 * tz;
            return Integers(tu * v1.x + ltz * v2.x, tu * v1.y + ltz * v2.y, tz * (tu - l1 * v2.z));
        }
        default: {
            return Integers(l2 * v1.x + l1 * v2.x, l2 * v1.y + l1 * v2.y, l2 * v1.z + l1 * v2.z);
        }
    }
}

fn estimated(a: Integers) -> Estimate {
    let x = vec4<f32>(a.x);
    let y = vec4<f32>(a.y);
    let nothing = (a.x == vec4(0)) & (a.y == vec4(0)) & (a.z == vec4(0));
    let whole_z = select(a.z, vec4(1), nothing);
    let z = vec4<f32>(whole_z);
    let s = x * x + y * y + z * z;
    let scale = inverseSqrt(s);
    let root = root_of(vec4<u32>(a.x * a.x + a.y * a.y + whole_z * whole_z), s, scale);
    let codes_x = estimated_normal(Component(x * scale, a.x, scale, root));
    let codes_y = estimated_normal(Component(y * scale, a.y, scale, root));
    var result = Estimate(Texels(codes_x.codes, codes_y.codes, vec4(0u)), codes_x.doubtful | codes_y.doubtful);
    // Of two codes, z is none.
    if (NORMAL_CODES > 2u) {
        let codes_z = estimated_normal(Component(z * scale, whole_z, scale, root));
        result.codes.z = codes_z.codes;
        result.doubtful = result.doubtful | codes_z.doubtful;
    }
    return result;
}

fn estimated_normal(component: Component) -> Codes {
    return nearest_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, component);
}

fn exact_codes(v1: vec3<i32>, v2: vec3<i32>, weights: vec3<i32>) -> vec3<u32> {
    if (S_BITS == 64u) {
        return narrow_codes(narrow_sum(v1, v2, weights));
    }
    if (METHOD == RNM) {
        return wide_codes(reoriented(v1, v2));
    }
    return wide_codes(wide_sum(v1, v2, weights));
}

// Every component of the sum is p f v1 + r g v2, where only f and g differ between components.
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
