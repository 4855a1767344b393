// Integer heights, correctly rounded: A / sqrt(S) with S = X^2 + Y^2 + Z^2 (DESIGN 3.1).
//
// A is X, Y, Z of the normal and Z (2H - M) / M of the parallax map. Their codes (fn normal_code, fn parallax_code) are
// those of integers.wgsl or of floats.wgsl.

// Whether all codes are integers, and m A, m^2 S and t^2 S always fit 32, 64 and 64 bits.
override NARROW: bool = false;

fn bake_texel(north: vec3<u32>, middle: vec3<u32>, south: vec3<u32>) -> Texel {
    let g = integer_sums(north, middle, south);
    let height = twice_above_middle(middle.y);
    if (NARROW) {
        return narrow_texel(g, height);
    }
    return wide_texel(g, height);
}

fn narrow_texel(g: vec2<i32>, height: i32) -> Texel {
    let negative = leans_negative(g);
    let a = vec2<u32>(abs(vec2(params.px, params.py))) * vec2<u32>(abs(g));
    let z = params.z_low;
    let s = sum64(sum64(product(a.x, a.x), product(a.y, a.y)), product(z, z));
    let scale = inverseSqrt(float64(s));
    var texel: Texel;
    if (NORMAL_CODES > 0u) {
        texel.normal = vec3(
            nearest_code64(params.normal, negative.x, a.x, s, scale),
            nearest_code64(params.normal, negative.y, a.y, s, scale),
            nearest_code64(params.normal, false, z, s, scale),
        );
    }
    if (PARALLAX_BITS > 0u) {
        let a = params.z_over_m * u32(abs(height));
        texel.parallax = nearest_code64(params.parallax, height < 0, a, s, scale);
    }
    return texel;
}

fn wide_texel(g: vec2<i32>, height: i32) -> Texel {
    let negative = leans_negative(g);
    let p = vec2<u32>(abs(vec2(params.px, params.py)));
    let x = product(p.x, u32(abs(g.x)));
    let y = product(p.y, u32(abs(g.y)));
    let z = vec2(params.z_low, params.z_high);
    let xx = square96(x);
    let yy = square96(y);
    let zz = square96(z);
    let s = sum96(sum96(xx, yy), zz);
    let scale = inverseSqrt(float96(s));
    var texel: Texel;
    if (NORMAL_CODES > 0u) {
        texel.normal = vec3(
            normal_code(negative.x, float64(x) * scale, xx, s),
            normal_code(negative.y, float64(y) * scale, yy, s),
            normal_code(false, float64(z) * scale, zz, s),
        );
    }
    if (PARALLAX_BITS > 0u) {
        let a = product(params.z_over_m, u32(abs(height)));
        texel.parallax = parallax_code(height < 0, float64(a) * scale, square96(a), s);
    }
    return texel;
}

// Whether px Gx and py Gy are below zero, or zero: a zero's sign does not matter.
fn leans_negative(g: vec2<i32>) -> vec2<bool> {
    return (vec2(params.px, params.py) < vec2(0)) != (g < vec2(0));
}
