// Any maps in native f32: a code may be its neighbour. The steps are those of floats.wgsl.

fn blended_codes(base: vec3<u32>, detail: vec3<u32>, weights: vec3<i32>) -> vec3<u32> {
    let v1 = fast_normal(params.base, BASE_CODES, BASE_BITS, base);
    let v2 = fast_normal(params.detail, DETAIL_CODES, DETAIL_BITS, detail);
    var sum = fast_sum(v1, v2, vec3<f32>(weights));
    sum = select(sum, vec3(0.0), abs(sum) < vec3(0x1p-60f));
    if (all(sum == vec3(0.0))) {
        sum.z = 1.0;
    }
    let normal = sum * inverseSqrt(dot(sum, sum));
    return vec3(
        fast_code(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.x),
        fast_code(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.y),
        fast_code(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, normal.z),
    );
}

fn fast_sum(v1: vec3<f32>, v2: vec3<f32>, weights: vec3<f32>) -> vec3<f32> {
    switch METHOD {
        case WEIGHTED: {
            let leaning = weights.x * v2.z * v1.xy + weights.y * v1.z * v2.xy;
            return vec3(leaning, weights.z * v1.z * v2.z);
        }
        case OVERLAY: {
            return v1 + (1.0 - abs(v1)) * v2;
        }
        case UDN: {
            return vec3(v1.xy + v2.xy, v1.z);
        }
        case WHITEOUT: {
            return vec3(v1.xy + v2.xy, v1.z * v2.z);
        }
        case RNM: {
            let tz = v1.z + 1.0;
            let tu = tz * v2.z - dot(v1.xy, v2.xy);
            return vec3(tu * v1.xy + tz * v2.xy, tz * (tu - v2.z));
        }
        default: {
            return v1 + v2;
        }
    }
}
