//! Light on a normal-mapped pixel.

use crate::vector::{add, dot, normalized, times};

/// The share of a light that a matt surface with the normal `m` sends on: max(0, m . l) (Hegde, Messing with Tangent
/// Space, 2007, section 4). `l` points to the light; both are of length one.
pub fn diffuse(m: [f32; 3], l: [f32; 3]) -> f32 {
    dot(m, l).max(0.0)
}

/// Two lights, each a direction of length one and a colour, and ambient light, their sum at most 1: the light of Terry
/// Welsh's pixel program, to be multiplied by the texture.
pub fn two_lights(m: [f32; 3], lights: [([f32; 3], [f32; 3]); 2], ambient: [f32; 3]) -> [f32; 3] {
    let [first, second] = lights.map(|(l, colour)| times(diffuse(m, l), colour));
    add(add(first, second), ambient).map(|part| part.clamp(0.0, 1.0))
}

/// The highlight of a shiny surface: max(0, m . h)^`shininess` with h halfway between the light `l` and the eye `v`
/// (Blinn's model with Phong's exponent); nothing where the light is behind the surface.
pub fn blinn_phong(m: [f32; 3], l: [f32; 3], v: [f32; 3], shininess: f32) -> f32 {
    if dot(m, l) <= 0.0 { 0.0 } else { dot(m, normalized(add(l, v))).max(0.0).powf(shininess) }
}
