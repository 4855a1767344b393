// Light on a normal-mapped pixel. All vectors are of length one and in one space, tangent space or any other.
//
// diffuse: max(0, m . l) (Hegde, Messing with Tangent Space, 2007, section 4); times the colour of light and surface.
// two_lights: Welsh's pixel program: two coloured lights and ambient light, their sum at most 1; times the texture.
// blinn_phong: max(0, m . h)^shininess with h halfway between light and eye; nothing where the light is behind.
//
// m: the normal; l, l1, l2: towards the lights; v: towards the eye.
//
// Their twins: src/shading/lighting.rs.

fn diffuse(m: vec3<f32>, l: vec3<f32>) -> f32 {
    return max(dot(m, l), 0.0);
}

fn two_lights(
    m: vec3<f32>, l1: vec3<f32>, colour1: vec3<f32>, l2: vec3<f32>, colour2: vec3<f32>, ambient: vec3<f32>,
) -> vec3<f32> {
    return saturate(diffuse(m, l1) * colour1 + diffuse(m, l2) * colour2 + ambient);
}

fn blinn_phong(m: vec3<f32>, l: vec3<f32>, v: vec3<f32>, shininess: f32) -> f32 {
    // Opposite each other, light and eye have nothing halfway.
    if (dot(m, l) <= 0.0 || all(l == -v)) {
        return 0.0;
    }
    return pow(max(dot(m, normalize(l + v)), 0.0), shininess);
}
