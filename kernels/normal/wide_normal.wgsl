// The normal (X, Y, Z) / sqrt(S) of integer heights, as what an exact rounding needs (DESIGN 3.1).

struct WideNormal {
    negative: vec2<bool>,  // the signs of X and Y
    xx: vec3<u32>,         // X^2, 96 bits
    yy: vec3<u32>,
    zz: vec3<u32>,
    s: vec3<u32>,          // X^2 + Y^2 + Z^2
    estimate: vec3<f32>,   // the magnitudes of the components, nearly
}

fn wide_normal(g: vec2<i32>) -> WideNormal {
    let p = vec2<u32>(abs(vec2(params.px, params.py)));
    let x = product(p.x, u32(abs(g.x)));
    let y = product(p.y, u32(abs(g.y)));
    let z = vec2(params.z_low, params.z_high);
    let xx = square96(x);
    let yy = square96(y);
    let zz = square96(z);
    let s = sum96(sum96(xx, yy), zz);
    let estimate = vec3(float64(x), float64(y), float64(z)) * inverseSqrt(float96(s));
    return WideNormal(leans_negative(g), xx, yy, zz, s, estimate);
}

// Whether px Gx and py Gy are below zero, or zero: a zero's sign does not matter.
fn leans_negative(g: vec2<i32>) -> vec2<bool> {
    return (vec2(params.px, params.py) < vec2(0)) != (g < vec2(0));
}
