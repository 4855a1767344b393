//! Light by angles.

use super::examined::f64s;
use super::examined::{Examined, above, reals};
use super::real::{self, Real};
use texbake::shading::{blinn_phong, diffuse, two_lights};

fn vector<T: Copy>(a: &[T], at: usize) -> [T; 3] {
    [a[at], a[at + 1], a[at + 2]]
}

/// The cosine of the angle between two vectors, 0 beyond a right one.
fn cosine(a: [f64; 3], b: [f64; 3]) -> f64 {
    let angle = f64s::angle(a, b).to_radians();
    (f64s::length(a) * f64s::length(b) * angle.cos()).max(0.0)
}

fn diffuse_formula(m: [Real; 3], l: [Real; 3]) -> Real {
    real::dot(m, l).max(m[0].constant(0.0))
}

#[test]
fn diffuse_light_is_the_cosine() {
    let mut real = reals(0x4e6);
    let light = Examined {
        file: "lighting",
        call: "diffuse(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]))",
        twin: &|a: [f32; 6]| [diffuse(vector(&a, 0), vector(&a, 3))],
        exact: &|a| [cosine(vector(&a, 0), vector(&a, 3))],
        formula: &|a| [diffuse_formula(vector(&a, 0), vector(&a, 3))],
        arguments: (0..2000)
            .map(|_| {
                let [m, l] = [0, 1].map(|_| above(&mut real, -1.0));
                [m[0], m[1], m[2], l[0], l[1], l[2]]
            })
            .collect(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    light.assert();
    light.notices(&[("max(dot(m, l), 0.0)", "dot(m, l)"), ("dot(m, l), 0.0", "abs(dot(m, l)), 0.0")]);
    assert_eq!(diffuse([0.0, 0.0, 1.0], [0.6, 0.0, 0.8]), 0.8);
    assert_eq!(diffuse([0.0, 0.0, 1.0], [0.6, 0.0, -0.8]), 0.0);
}

#[test]
fn two_lights_and_ambient_saturate() {
    let mut real = reals(0x2);
    let light = Examined {
        file: "lighting",
        call: "two_lights(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), vec3(a[6], a[7], a[8]), \
               vec3(a[9], a[10], a[11]), vec3(a[12], a[13], a[14]), vec3(a[15], a[16], a[17]))",
        twin: &|a: [f32; 18]| {
            let lights = [(vector(&a, 3), vector(&a, 6)), (vector(&a, 9), vector(&a, 12))];
            two_lights(vector(&a, 0), lights, vector(&a, 15))
        },
        exact: &|a| {
            [0, 1, 2].map(|part| {
                let lights =
                    [(3, 6), (9, 12)].map(|(l, colour)| cosine(vector(&a, 0), vector(&a, l)) * a[colour + part]);
                (lights[0] + lights[1] + a[15 + part]).min(1.0)
            })
        },
        formula: &|a| {
            let one = a[0].constant(1.0);
            let light = |l, colour| real::times(diffuse_formula(vector(&a, 0), vector(&a, l)), vector(&a, colour));
            real::add(real::add(light(3, 6), light(9, 12)), vector(&a, 15)).map(|part| part.min(one))
        },
        arguments: (0..2000)
            .map(|_| {
                let vectors = [0, 1, 2].map(|_| above(&mut real, -1.0));
                let mut colour = || [0, 1, 2].map(|_| (0.5 + 0.5 * real()) as f32);
                let [m, l1, l2] = vectors;
                let all = [m, l1, colour(), l2, colour(), colour().map(|part| 0.3 * part)];
                std::array::from_fn(|at| all[at / 3][at % 3])
            })
            .collect(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    light.assert();
    light.notices(&[("saturate(", "("), ("+ ambient", ""), ("diffuse(m, l2) * colour2", "diffuse(m, l1) * colour2")]);
    // 0.8 of red, 0.5 of grey, 0.1 everywhere; red is more than 1.
    let lights = [([0.6, 0.0, 0.8], [1.0, 0.0, 0.0]), ([0.0, 0.0, 1.0], [0.5; 3])];
    assert_eq!(two_lights([0.0, 0.0, 1.0], lights, [0.1; 3]), [1.0, 0.6, 0.6]);
}

#[test]
fn highlights_are_a_power_of_the_half_angle_s_cosine() {
    let mut real = reals(0xb11);
    let mut arguments: Vec<[f32; 10]> = Vec::new();
    while arguments.len() < 2000 {
        let [m, l, v] = [0, 1, 2].map(|_| above(&mut real, -1.0));
        let [m64, l64, v64] = [m, l, v].map(|vector| vector.map(f64::from));
        let half: [f64; 3] = std::array::from_fn(|axis| l64[axis] + v64[axis]);
        let is_clear = f64s::dot(m64, l64).abs() > 1e-4 && f64s::length(half) > 0.3;
        // A cosine next to 0 has a logarithm without a bound, and a power next to nothing.
        if is_clear && f64s::dot(m64, half) > 0.5 * f64s::length(half) {
            let shininess = 2f32.powi(arguments.len() as i32 / 2 % 7);
            arguments.push([m[0], m[1], m[2], l[0], l[1], l[2], v[0], v[1], v[2], shininess]);
            // The eye opposite to the light.
            arguments.push([m[0], m[1], m[2], l[0], l[1], l[2], -l[0], -l[1], -l[2], shininess]);
        }
    }
    let highlight = Examined {
        file: "lighting",
        call: "blinn_phong(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), vec3(a[6], a[7], a[8]), a[9])",
        twin: &|a| [blinn_phong(vector(&a, 0), vector(&a, 3), vector(&a, 6), a[9])],
        exact: &|a| {
            let [m, l, v] = [0, 3, 6].map(|at| vector(&a, at));
            // Halfway between the ends of vectors of one length is halfway between their directions.
            let half = [0, 1, 2].map(|axis| 0.5 * (l[axis] + v[axis]));
            let power = (f64s::length(m) * f64s::angle(m, half).to_radians().cos()).powf(a[9]);
            [if f64s::dot(m, l) > 0.0 && half != [0.0; 3] { power } else { 0.0 }]
        },
        formula: &|a| {
            let [m, l, v] = [0, 3, 6].map(|at| vector(&a, at));
            let sum = real::add(l, v);
            let is_dark = real::dot(m, l).value <= 0.0 || sum.iter().all(|part| part.value == 0.0);
            [if is_dark { a[9].constant(0.0) } else { real::dot(m, real::normalized(sum)).powf(a[9]) }]
        },
        arguments,
        #[cfg(feature = "gpu")]
        texture: None,
    };
    highlight.assert();
    highlight.notices(&[
        ("normalize(l + v)", "l"),
        (", shininess)", ", 2.0 * shininess)"),
        ("dot(m, l) <= 0.0", "false"),
    ]);
    // Light and eye 60 degrees apart around the normal: 30 degrees to each, none to the half vector; turned by 60, cos 60.
    let (sin, cos) = (30f32.to_radians().sin(), 30f32.to_radians().cos());
    let [l, v] = [[sin, 0.0, cos], [-sin, 0.0, cos]];
    assert!((blinn_phong([0.0, 0.0, 1.0], l, v, 8.0) - 1.0).abs() < 1e-6);
    assert!((blinn_phong([cos, 0.0, sin], l, v, 2.0) - 0.25).abs() < 1e-6);
    assert_eq!(
        blinn_phong([0.0, 0.0, 1.0], [sin, 0.0, -cos], v, 8.0),
        0.0,
        "a light behind the surface has no highlight"
    );
}
