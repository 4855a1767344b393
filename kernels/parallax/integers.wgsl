// Integer maps, correctly rounded: A / sqrt(S) with A = z (2H - M) and S = M^2 (x^2 + y^2 + z^2) (DESIGN 3.1).

// Whether the code is an integer, and m A, m^2 S and t^2 S always fit 32, 64 and 64 bits.
override NARROW: bool = false;

fn parallax_code(height: u32, codes: vec3<u32>) -> u32 {
    let normal = vec3<u32>(abs(integer_normal(params.normals, NORMAL_CODES, codes)));
    let h = twice_above_middle(height);
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
