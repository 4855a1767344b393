// Maps of which one or both hold floats, in IEEE binary32, in the order of src/ops/blend/reference.rs.
//
// Numbers are bit patterns for soft_float.wgsl. What repeats is a loop, so that drivers compile each step once.

const SMALLEST_PART: u32 = 0x21800000u;  // 2^-60: parts of the sum below count as zero

fn blended_four(base: Texels, detail: Texels, weights: Weights) -> Texels {
    let v1 = float_texels(params.base, BASE_CODES, BASE_BITS, base);
    let v2 = float_texels(params.detail, DETAIL_CODES, DETAIL_BITS, detail);
    var normals: Texels;
    for (var i = 0u; i < TEXELS; i++) {
        let codes = blended_codes(texel_of(v1, i), texel_of(v2, i), weights_of(weights, i));
        normals.x[i] = codes.x;
        normals.y[i] = codes.y;
        normals.z[i] = codes.z;
    }
    return normals;
}

// Every component of the sum is p f v1 + r g v2, where only f and g differ between components.
fn blended_codes(base: vec3<u32>, detail: vec3<u32>, weights: vec3<i32>) -> vec3<u32> {
    let v1 = float_normal(params.base, BASE_CODES, BASE_BITS, base);
    let v2 = float_normal(params.detail, DETAIL_CODES, DETAIL_BITS, detail);
    let by = terms(v1, v2, weights);
    var sum: vec3<u32>;
    for (var axis = 0u; axis < 3u; axis++) {
        let part = add(mul(mul(by.p, by.f[axis]), by.v1[axis]), mul(mul(by.r, by.g[axis]), v2[axis]));
        sum[axis] = zero_below(SMALLEST_PART, part);
    }
    if (all(sum == vec3(0u))) {
        sum.z = ONE;
    }
    return float_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, unit(sum));
}

struct Terms {
    p: u32,
    f: vec3<u32>,
    v1: vec3<u32>,
    r: u32,
    g: vec3<u32>,
}

// A product with 1 and a sum with 0 round nothing.
fn terms(v1: vec3<u32>, v2: vec3<u32>, weights: vec3<i32>) -> Terms {
    switch METHOD {
        case WEIGHTED: {
            let w = bitcast<vec3<u32>>(vec3<f32>(weights));
            // z is (z2 z1) q.
            return Terms(v2.z, vec3(w.xx, v1.z), vec3(v1.xy, w.z), v1.z, vec3(w.yy, 0u));
        }
        case OVERLAY: {
            var g: vec3<u32>;
            for (var axis = 0u; axis < 3u; axis++) {
                g[axis] = sub(ONE, v1[axis] & ~SIGN);
            }
            return Terms(ONE, vec3(ONE), v1, ONE, g);
        }
        case UDN: {
            return Terms(ONE, vec3(ONE), v1, ONE, vec3(ONE, ONE, 0u));
        }
        case WHITEOUT: {
            return Terms(ONE, vec3(ONE, ONE, 0u), v1, ONE, vec3(ONE, ONE, v1.z));
        }
        case RNM: {
            let tz = add(v1.z, ONE);
            let tu = sub(mul(tz, v2.z), add(mul(v1.x, v2.x), mul(v1.y, v2.y)));
            return Terms(ONE, vec3(tu, tu, tz), vec3(v1.xy, sub(tu, v2.z)), ONE, vec3(tz, tz, 0u));
        }
        default: {
            return Terms(ONE, vec3(ONE), v1, ONE, vec3(ONE));
        }
    }
}
