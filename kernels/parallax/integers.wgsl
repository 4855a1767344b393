// Integer maps, correctly rounded: A / sqrt(S) with A = z (2H - M) and S = M^2 (x^2 + y^2 + z^2) (DESIGN 3.1).

// Whether estimates are near enough: the code has 8 bits, or S is below 2^49.
override ESTIMATED: bool = false;
// Whether the code is an integer, and m A, m^2 S and t^2 S always fit 32, 64 and 64 bits.
override NARROW: bool = false;

fn parallax_four(heights: vec4<u32>, normals: Texels) -> vec4<u32> {
    let v = integer_normals(params.normals, NORMAL_CODES, normals);
    let h = twice_above_middle(heights);
    var codes: vec4<u32>;
    var doubtful = vec4(true);
    if (ESTIMATED) {
        let estimate = estimated(v, h);
        codes = estimate.codes;
        doubtful = estimate.doubtful;
    }
    if (any(doubtful)) {
        // A loop, not four calls: drivers compile the arithmetic once.
        for (var i = 0u; i < TEXELS; i++) {
            if (doubtful[i]) {
                codes[i] = exact_code(h[i], vec3<u32>(abs(integers_of(v, i))));
            }
        }
    }
    return codes;
}

fn estimated(v: Integers, h: vec4<i32>) -> Codes {
    let x = vec4<f32>(v.x);
    let y = vec4<f32>(v.y);
    let z = vec4<f32>(v.z);
    let m = params.heights.greatest;
    let s = (x * x + y * y + z * z) * (f32(m) * f32(m));
    let scale = inverseSqrt(s);
    let root = root_of(vec4<u32>((v.x * v.x + v.y * v.y + v.z * v.z) * (m * m)), s, scale);
    let component = Component(z * vec4<f32>(h) * scale, v.z * h, scale, root);
    return nearest_codes(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, component);
}

fn exact_code(h: i32, normal: vec3<u32>) -> u32 {
    let mm = u32(params.heights.greatest) * u32(params.heights.greatest);
    if (NARROW) {
        let s = product(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z, mm);
        let a = normal.z * u32(abs(h));
        return nearest_code64(params.parallax, h < 0, a, s, inverseSqrt(float64(s)));
    }
    let squares =
        sum64(sum64(product(normal.x, normal.x), product(normal.y, normal.y)), product(normal.z, normal.z));
    let s = times64(squares, mm);
    let a = product(normal.z, u32(abs(h)));
    let aa = square128(a);
    let estimate = float64(a) * inverseSqrt(float96(s));
    if (PARALLAX_IS_FLOAT) {
        return nearest_float(PARALLAX_BITS, h < 0, estimate, aa, vec4(s, 0u));
    }
    return nearest_code96(params.parallax, h < 0, estimate, aa.xyz, s);
}
