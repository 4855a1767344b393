// Any maps in native f32: a code may be its neighbour. The steps are those of floats.wgsl.

fn blended_four(base: Texels, detail: Texels, weights: Weights) -> Texels {
    let v1 = fast_normals(params.base, BASE_CODES, BASE_BITS, base);
    let v2 = fast_normals(params.detail, DETAIL_CODES, DETAIL_BITS, detail);
    let sum = fast_sums(v1, v2, weights);
    let x = not_smallest(sum.x);
    let y = not_smallest(sum.y);
    var z = not_smallest(sum.z);
    z = select(z, vec4(1.0), (x == vec4(0.0)) & (y == vec4(0.0)) & (z == vec4(0.0)));
    let scale = inverseSqrt(x * x + y * y + z * z);
    return Texels(
        fast_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, x * scale),
        fast_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, y * scale),
        fast_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, z * scale),
    );
}

fn not_smallest(sum: vec4<f32>) -> vec4<f32> {
    return select(sum, vec4(0.0), abs(sum) < vec4(0x1p-60f));
}

fn fast_sums(v1: Floats, v2: Floats, weights: Weights) -> Floats {
    switch METHOD {
        case WEIGHTED: {
            let p = vec4<f32>(weights.a) * v2.z;
            let r = vec4<f32>(weights.b) * v1.z;
            return Floats(p * v1.x + r * v2.x, p * v1.y + r * v2.y, f32(weights.q) * v1.z * v2.z);
        }
        case OVERLAY: {
            return Floats(
                v1.x + (1.0 - abs(v1.x)) * v2.x,
                v1.y + (1.0 - abs(v1.y)) * v2.y,
                v1.z + (1.0 - abs(v1.z)) * v2.z,
            );
        }
        case UDN: {
            return Floats(v1.x + v2.x, v1.y + v2.y, v1.z);
        }
        case WHITEOUT: {
            return Floats(v1.x + v2.x, v1.y + v2.y, v1.z * v2.z);
        }
        case RNM: {
            let tz = v1.z + 1.0;
            let tu = tz * v2.z - (v1.x * v2.x + v1.y * v2.y);
            return Floats(tu * v1.x + tz * v2.x, tu * v1.y + tz * v2.y, tz * (tu - v2.z));
        }
        default: {
            return Floats(v1.x + v2.x, v1.y + v2.y, v1.z + v2.z);
        }
    }
}
