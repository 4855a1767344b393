// Integer heights to maps of which at least one holds floats.

fn estimated_normal(component: Component) -> Codes {
    return nearest_codes(params.normal, NORMAL_IS_FLOAT, NORMAL_BITS, component);
}

fn estimated_parallax(component: Component) -> Codes {
    return nearest_codes(params.parallax, PARALLAX_IS_FLOAT, PARALLAX_BITS, component);
}

// The code of sqrt(aa / s), or of its negative, in the normal map. `estimate` is nearly sqrt(aa / s).
fn normal_code(negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    if (NORMAL_IS_FLOAT) {
        return nearest_float(NORMAL_BITS, negative, estimate, vec4(aa, 0u), vec4(s, 0u));
    }
    return nearest_code96(params.normal, negative, estimate, aa, s);
}

// The same in the parallax map.
fn parallax_code(negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    if (PARALLAX_IS_FLOAT) {
        return nearest_float(PARALLAX_BITS, negative, estimate, vec4(aa, 0u), vec4(s, 0u));
    }
    return nearest_code96(params.parallax, negative, estimate, aa, s);
}
