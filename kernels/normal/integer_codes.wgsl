// Integer heights to integer codes, correctly rounded: a float estimate and one comparison of integers (DESIGN 3.1).

// Whether m X, m^2 S and t^2 S always fit 32, 64 and 64 bits.
override NARROW: bool = false;

fn normal_codes(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> vec3<u32> {
    let g = integer_sums(north, middle, south);
    if (NARROW) {
        let negative = leans_negative(g);
        let a = vec2<u32>(abs(vec2(params.px, params.py))) * vec2<u32>(abs(g));
        let z = params.z_low;
        let s = sum64(sum64(product(a.x, a.x), product(a.y, a.y)), product(z, z));
        let scale = inverseSqrt(float64(s));
        return vec3(
            narrow_code(negative.x, a.x, s, scale),
            narrow_code(negative.y, a.y, s, scale),
            narrow_code(false, z, s, scale),
        );
    }
    let n = wide_normal(g);
    return vec3(
        wide_code(n.negative.x, n.estimate.x, n.xx, n.s),
        wide_code(n.negative.y, n.estimate.y, n.yy, n.s),
        wide_code(false, n.estimate.z, n.zz, n.s),
    );
}

// The code of a / sqrt(s), or of its negative.
fn narrow_code(negative: bool, a: u32, s: vec2<u32>, scale: f32) -> u32 {
    let below = code_below(negative, f32(a) * scale);
    let t = 2 * below + 1 - params.code_c;
    let ma = u32(params.code_m) * a;
    let mmaa = product(ma, ma);
    let tt = u32(abs(t)) * u32(abs(t));
    let tts = product(tt, s.x) + vec2(0u, tt * s.y);
    return stored_code(below + i32(reaches(negative, t, at_least64(mmaa, tts), at_least64(tts, mmaa))));
}

// The code of sqrt(aa / s), or of its negative.
fn wide_code(negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    let below = code_below(negative, estimate);
    let t = 2 * below + 1 - params.code_c;
    let mmaa = times(aa, u32(params.code_m) * u32(params.code_m));
    let tts = times(s, u32(abs(t)) * u32(abs(t)));
    return stored_code(below + i32(reaches(negative, t, at_least128(mmaa, tts), at_least128(tts, mmaa))));
}

// The code or the one below it: the estimate is off by far less than half a code.
fn code_below(negative: bool, estimate: f32) -> i32 {
    let component = select(estimate, -estimate, negative);
    let below = i32(floor((f32(params.code_m) * component + f32(params.code_c)) * 0.5));
    return clamp(below, params.code_least, params.code_greatest - 1);
}

// Whether m A >= t sqrt(S), from the signs of A and t and the order of m^2 A^2 and t^2 S.
fn reaches(negative: bool, t: i32, at_least: bool, at_most: bool) -> bool {
    return select(t < 0 || at_least, t <= 0 && at_most, negative);
}
