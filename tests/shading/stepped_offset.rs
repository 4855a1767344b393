//! Steps through a parallax map: eq. 7.51 for one step, a geometric sum for many steps up a slope.

use super::examined::{Examined, above, reals};
use super::filtered::{filtered, steepest, texels};
use super::real::Real;
use crate::support::{Random, Texels};
use std::num::NonZeroU32;
use texbake::shading::{step_scale, stepped_offset};

fn times(k: u32) -> NonZeroU32 {
    NonZeroU32::new(k).unwrap()
}

/// What is sampled at uv, with what it may be off.
fn sample(map: &Texels, steepest: [f64; 2], [u, v]: [Real; 2]) -> Real {
    let size = [map.size.width() as f64, map.size.height() as f64];
    // And the rounding of a place in texels.
    let off = [0, 1].map(|axis| ([u, v][axis].error + 2f64.powi(-20)) * size[axis]);
    u.sampled(filtered(map, [u.value, v.value]), off, steepest, 1.0)
}

fn formula(map: &Texels, steepest: [f64; 2], a: [Real; 9], k: u32) -> [Real; 2] {
    let [u, v, x, y, _, su, sv, multiply, add] = a;
    let step = [x * su, y * sv];
    let mut offset = [u.constant(0.0); 2];
    for _ in 0..k {
        let p = sample(map, steepest, [u + offset[0], v + offset[1]]) * multiply + add;
        offset = [offset[0] + step[0] * p, offset[1] + step[1] * p];
    }
    offset
}

fn twin(map: &Texels, [u, v, x, y, z, su, sv, multiply, add]: [f32; 9], k: u32) -> [f32; 2] {
    let parallax = |uv: [f32; 2]| filtered(map, uv.map(f64::from)) as f32 * multiply + add;
    stepped_offset(parallax, [u, v], [x, y, z], [su, sv], times(k))
}

const CALL: &str = "stepped_offset(map, map_sampler, 0.0, vec2(a[7], a[8]), vec2(a[0], a[1]), vec3(a[2], a[3], a[4]), \
                    vec2(a[5], a[6]), ";

/// p = n_z (2h - 1) in 64ths, by chance; a rectangle.
fn chance() -> Texels {
    let mut random = Random::new(0x79);
    let values: Vec<f32> = (0..16 * 8).map(|_| (random.below(129) as f32 - 64.0) / 64.0).collect();
    texels(16, 8, |x, y| values[16 * y + x])
}

/// uv everywhere, beyond the edges, too; the eye from everywhere; snorm samples, and biased codes of 8 bits.
fn views() -> Vec<[f32; 9]> {
    let mut real = reals(0x751);
    (0..2000)
        .map(|at| {
            let v = above(&mut real, 0.05);
            let [uv0, uv1, su, sv] = [2.0, 2.0, 0.1, 0.2].map(|scale| (scale * real()) as f32);
            let [multiply, add] = if at % 2 == 0 { [1.0, 0.0] } else { [255.0 / 127.0, -128.0 / 127.0] };
            [uv0, uv1, v[0], v[1], v[2], su, sv, multiply, add]
        })
        .collect()
}

#[test]
fn one_step_is_equation_7_51() {
    let map = chance();
    let call = format!("{CALL}1u)");
    let offset = Examined {
        file: "stepped_offset",
        call: call.leak(),
        twin: &|a| twin(&map, a, 1),
        exact: &|[u, v, x, y, _, su, sv, multiply, add]| {
            let p = filtered(&map, [u, v]) * multiply + add;
            [x * p * su, y * p * sv]
        },
        formula: &|a| formula(&map, steepest(&map), a, 1),
        arguments: views(),
        #[cfg(feature = "gpu")]
        texture: Some(&map),
    };
    offset.assert();
    offset.notices(&[
        ("decode.x + decode.y", "decode.x"),
        ("v.xy * u", "v.xy * u.xx"),
        ("map_sampler, uv + offset", "map_sampler, uv.yx + offset"),
    ]);
    // Written out, for p = 1/2 where the eye is at (0.6, 0, 0.8), s = 24 texels, a map of 512: 0.6 * 24 / 1024 / 2.
    let u = step_scale([24.0; 2], [512.0; 2], times(1), 1.0);
    assert_eq!(stepped_offset(|_| 0.5, [0.0; 2], [0.6, 0.0, 0.8], u, times(1)), [0.6 * 24.0 / 1024.0 / 2.0, 0.0]);
}

/// On p = 2u - 1 each step takes the offset closer by the same factor: after k of them it is
/// p0 ((1 + 2 step)^k - 1) / 2.
#[test]
fn steps_up_a_slope_are_a_geometric_sum() {
    let slope = texels(64, 4, |x, _| (2 * x + 1) as f32 / 64.0 - 1.0);
    let mut real = reals(0x79a);
    let mut arguments: Vec<[f32; 9]> = Vec::new();
    while arguments.len() < 1000 {
        let v = above(&mut real, 0.05);
        let [uv1, su, sv] = [1.0, 0.1, 0.1].map(|scale| (scale * real()) as f32);
        let u = 0.5 + 0.25 * real() as f32;
        // Where the slope ends no step comes.
        if f64::from(2.0 * u - 1.0).abs() * f64::from(1.0 + 2.0 * (v[0] * su).abs()).powi(9) < 0.95 {
            arguments.push([u, uv1, v[0], v[1], v[2], su, sv, 1.0, 0.0]);
        }
    }
    for k in [2, 4, 9] {
        let call = format!("{CALL}{k}u)");
        let offset = Examined {
            file: "stepped_offset",
            call: call.leak(),
            twin: &|a| twin(&slope, a, k),
            exact: &|[u, _, x, y, _, su, sv, _, _]| {
                let (p0, step) = (2.0 * u - 1.0, x * su);
                // The sum of p after each step, times the step of each axis.
                let sum =
                    if step == 0.0 { f64::from(k) } else { ((1.0 + 2.0 * step).powi(k as i32) - 1.0) / (2.0 * step) };
                [p0 * sum * step, p0 * sum * y * sv]
            },
            formula: &|a| formula(&slope, [1.0 / 32.0, 0.0], a, k),
            arguments: arguments.clone(),
            #[cfg(feature = "gpu")]
            texture: Some(&slope),
        };
        offset.assert();
        offset.notices(&[
            ("map_sampler, uv + offset", "map_sampler, uv"),
            ("i < k", "i + 1u < k"),
            ("offset += step", "offset -= step"),
        ]);
    }
}

/// Without slope the steps share what one step does, however many there are.
#[test]
fn steps_share_the_scale() {
    let v = [0.48, 0.64, 0.6];
    for k in [1, 2, 4, 16] {
        let u = step_scale([24.0; 2], [512.0, 128.0], times(k), 1.0);
        let [x, y] = stepped_offset(|_| -0.5, [0.3; 2], v, u, times(k));
        // In texels: 24/2 of v_xy times p; both axes of a rectangular map.
        assert!((x * 512.0 + 2.88).abs() < 1e-5 && (y * 128.0 + 3.84).abs() < 1e-5, "{k}: {x} {y}");
    }
    // Exaggerated by 2 the relief is as deep as that of twice the scale.
    assert_eq!(step_scale([24.0; 2], [512.0; 2], times(4), 2.0), step_scale([48.0; 2], [512.0; 2], times(4), 1.0));
    // Straight above nothing moves.
    assert_eq!(stepped_offset(|_| 1.0, [0.3; 2], [0.0, 0.0, 1.0], [0.1; 2], times(4)), [0.0; 2]);
}

#[test]
fn step_scales_are_equation_7_52() {
    let mut real = reals(0x752);
    let scale = Examined {
        file: "stepped_offset",
        call: "step_scale(vec2(a[0], a[1]), vec2(a[2], a[3]), u32(a[4]), a[5])",
        twin: &|[sx, sy, rx, ry, k, exaggeration]: [f32; 6]| {
            step_scale([sx, sy], [rx, ry], times(k as u32), exaggeration)
        },
        exact: &|[sx, sy, rx, ry, k, exaggeration]| [sx / rx, sy / ry].map(|share| share * exaggeration / (k + k)),
        formula: &|[sx, sy, rx, ry, k, exaggeration]| {
            [[sx, rx], [sy, ry]].map(|[s, r]| exaggeration * s / (k.constant(2.0) * k * r))
        },
        arguments: (0..500)
            .map(|at| {
                let [sx, sy] = [0, 1].map(|_| (40.0 * real()) as f32);
                let sizes = [64.0, 100.0, 512.0, 4096.0];
                [sx, sy, sizes[at % 4], sizes[at / 4 % 4], (1 + at % 16) as f32, (1.5 + real()) as f32]
            })
            .collect(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    scale.assert();
    scale.notices(&[("2.0 * f32(k)", "f32(k)"), ("exaggeration * scale", "scale"), ("* size)", "* size.yx)")]);
}
