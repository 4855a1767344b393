// Integer heights, correctly rounded: A / sqrt(S) with S = X^2 + Y^2 + Z^2 (DESIGN 3.1).
//
// A is X, Y, Z of the normal and Z (2H - M) / M of the parallax map. A float estimate gives most codes; where it is too
// near to a boundary, integers do. Codes of either kind (fn estimated_normal, fn normal_code and so on) are those of
// integers.wgsl or of floats.wgsl.

// Whether estimates are near enough: all codes have 8 bits, or S is below 2^49.
override ESTIMATED: bool = false;
// Whether all codes are integers, and m A, m^2 S and t^2 S always fit 32, 64 and 64 bits.
override NARROW: bool = false;

fn bake_four(north: Heights, middle: Heights, south: Heights) -> Four {
    let g = integer_sums(north, middle, south);
    let height = twice_above_middle(middle.here);
    var four: Four;
    var doubtful = vec4(true);
    if (ESTIMATED) {
        let estimate = estimated(g, height);
        four = estimate.four;
        doubtful = estimate.doubtful;
    }
    if (any(doubtful)) {
        // A loop, not four calls: drivers compile the arithmetic once.
        for (var i = 0u; i < TEXELS; i++) {
            if (doubtful[i]) {
                let texel = exact_texel(vec2(g.x[i], g.y[i]), height[i]);
                four.normals.x[i] = texel.normal.x;
                four.normals.y[i] = texel.normal.y;
                four.normals.z[i] = texel.normal.z;
                four.parallaxes[i] = texel.parallax;
            }
        }
    }
    return four;
}

struct Estimate {
    four: Four,
    doubtful: vec4<bool>,
}

fn estimated(g: Sums, height: vec4<i32>) -> Estimate {
    let x = vec4<f32>(g.x) * f32(params.px);
    let y = vec4<f32>(g.y) * f32(params.py);
    let z = float64(vec2(params.z_low, params.z_high));
    let s = x * x + y * y + vec4(z * z);
    let scale = inverseSqrt(s);
    let whole_x = g.x * params.px;
    let whole_y = g.y * params.py;
    let whole_z = vec4(i32(params.z_low));
    let root = root_of(vec4<u32>(whole_x * whole_x + whole_y * whole_y + whole_z * whole_z), s, scale);
    var result: Estimate;
    if (NORMAL_CODES > 0u) {
        let codes_x = estimated_normal(Component(x * scale, whole_x, scale, root));
        let codes_y = estimated_normal(Component(y * scale, whole_y, scale, root));
        result.four.normals.x = codes_x.codes;
        result.four.normals.y = codes_y.codes;
        result.doubtful = codes_x.doubtful | codes_y.doubtful;
        // Of two codes, z is none.
        if (NORMAL_CODES > 2u) {
            let codes_z = estimated_normal(Component(z * scale, whole_z, scale, root));
            result.four.normals.z = codes_z.codes;
            result.doubtful = result.doubtful | codes_z.doubtful;
        }
    }
    if (PARALLAX_BITS > 0u) {
        let component = f32(params.z_over_m) * vec4<f32>(height) * scale;
        let codes = estimated_parallax(Component(component, i32(params.z_over_m) * height, scale, root));
        result.four.parallaxes = codes.codes;
        result.doubtful = result.doubtful | codes.doubtful;
    }
    return result;
}

// The codes of a texel.
struct Texel {
    normal: vec3<u32>,
    parallax: u32,
}

fn exact_texel(g: vec2<i32>, height: i32) -> Texel {
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
