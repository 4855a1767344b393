// Integer heights to maps of integer codes.

fn estimated_normal(component: Component) -> Codes {
    return integer_codes(params.normal, NORMAL_BITS, component);
}

fn estimated_parallax(component: Component) -> Codes {
    return integer_codes(params.parallax, PARALLAX_BITS, component);
}

// The code of sqrt(aa / s), or of its negative, in the normal map. `estimate` is nearly sqrt(aa / s).
fn normal_code(negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    return nearest_code96(params.normal, negative, estimate, aa, s);
}

// The same in the parallax map.
fn parallax_code(negative: bool, estimate: f32, aa: vec3<u32>, s: vec3<u32>) -> u32 {
    return nearest_code96(params.parallax, negative, estimate, aa, s);
}
