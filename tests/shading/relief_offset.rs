//! Relief intersection beside closed forms: a plateau, an inclined plane, a wall, a cone, up and down.
//!
//! z is the height of the hit above the plane, in heights; a ray's places are uv + slant z with slant = |scale| v_xy / v_z.
//!
//! The bound of z: half of the last step, 2^-7 2^-16; the rounding of the steps and of h - 1/2, 4 u; and what the sample is
//! off, by the texture unit's subtexels and the rounding of the place, over how fast the ray and the surface part.

use super::examined::{above, reals, text_of};
use super::filtered::{filtered, steepest, texels};
use crate::support::Texels;
use texbake::shading::relief_offset;

const STEPS: u32 = 64;
const BISECTIONS: u32 = 16;
const U: f64 = 1.0 / (1 << 24) as f64;

/// A ray, and where it meets the surface.
#[derive(Debug, Clone, Copy)]
struct Hit {
    /// uv, v, scale.
    ray: [f32; 7],
    z: f64,
    /// How fast the ray comes closer to the surface, in heights per height of z: 1 above a plateau.
    closing: f64,
    /// What the texture's surface and the closed form differ by, in heights.
    apart: f64,
}

impl Hit {
    fn slant(&self) -> [f64; 2] {
        let [_, _, x, y, z, sx, sy] = self.ray.map(f64::from);
        [sx.abs() * x / z, sy.abs() * y / z]
    }

    fn offset(&self) -> [f64; 2] {
        self.slant().map(|slant| slant * self.z)
    }

    /// subtexel: of the filter, in texels; roundings: of a slant and a product, in u.
    fn bounds(&self, map: &Texels, subtexel: f64, roundings: f64) -> [f64; 2] {
        let sides = [map.size.width(), map.size.height()].map(|side| side as f64);
        let misplaced =
            [0, 1].map(|axis| subtexel + (roundings + 4.0) * U * (1.0 + self.slant()[axis].abs()) * sides[axis]);
        let [along, across] = [0, 1].map(|axis| misplaced[axis] * steepest(map)[axis]);
        let of_z = 2f64.powi(-23) + 4.0 * U + (along + across + self.apart + 8.0 * U) / self.closing;
        self.slant().map(|slant| slant.abs() * (of_z + roundings * U))
    }
}

/// Each ray's offset by the twin, and by every device.
fn assert_hits(map: &Texels, hits: &[Hit]) {
    assert!(hits.len() >= 200, "{}", hits.len());
    let height = |uv: [f32; 2]| filtered(map, uv.map(f64::from)) as f32;
    for hit in hits {
        let [u, v, x, y, z, sx, sy] = hit.ray;
        let got = relief_offset(height, [u, v], [x, y, z], [sx, sy], STEPS, BISECTIONS);
        let bounds = hit.bounds(map, 0.0, 4.0);
        for axis in [0, 1] {
            let (got, exact) = (f64::from(got[axis]), hit.offset()[axis]);
            assert!((got - exact).abs() <= bounds[axis], "{hit:?}: {got}, exactly {exact} within {}", bounds[axis]);
        }
    }
    #[cfg(feature = "gpu")]
    function(text_of("relief_offset"), map).assert_on_every_device(&calls(map, hits), 0);
}

#[cfg(feature = "gpu")]
fn function<'a>(wgsl: &'a str, map: &'a Texels) -> crate::support::ShaderFunction<'a> {
    let call =
        "relief_offset(map, map_sampler, 0.0, vec2(a[0], a[1]), vec3(a[2], a[3], a[4]), vec2(a[5], a[6]), 64u, 16u)";
    crate::support::ShaderFunction { wgsl, call, texture: Some(map) }
}

#[cfg(feature = "gpu")]
fn calls(map: &Texels, hits: &[Hit]) -> Vec<crate::support::Call<7, 2>> {
    let call = |hit: &Hit| {
        // A division of 5 u and products of 2 u.
        let bounds = hit.bounds(map, 1.0 / 256.0, 12.0).map(|bound| (1.000_001 * bound) as f32);
        crate::support::Call { arguments: hit.ray, expected: hit.offset().map(|part| part as f32), bounds }
    };
    hits.iter().map(call).collect()
}

#[cfg(feature = "gpu")]
fn assert_noticed(map: &Texels, hits: &[Hit], changes: &[(&str, &str)]) {
    for (from, to) in changes {
        let text = text_of("relief_offset");
        assert!(text.contains(from), "{from:?}");
        for (name, comparison) in function(&text.replacen(from, to, 1), map).on_every_device(&calls(map, hits), 0) {
            assert!(comparison.differing > 0, "{name}: {from:?} to {to:?}");
        }
    }
}

#[cfg(not(feature = "gpu"))]
fn assert_noticed(_: &Texels, _: &[Hit], _: &[(&str, &str)]) {}

/// Rays through anywhere, up and down, each axis with a scale of its own.
fn rays(seed: u64) -> impl FnMut() -> [f32; 7] {
    let mut real = reals(seed);
    move || {
        let [x, y, z] = above(&mut real, 0.2);
        let [u, v, sx, sy] = [real(), real(), real(), real()];
        let side = if sx < 0.0 { -1.0 } else { 1.0 };
        // Twice as long: the length of v does not matter.
        [u, v, 2.0 * f64::from(x), 2.0 * f64::from(y), 2.0 * f64::from(z), 0.15 * sx, 0.15 * side * (0.5 + 0.5 * sy)]
            .map(|part| part as f32)
    }
}

fn side(hit: &[f32; 7]) -> f64 {
    if hit[5] < 0.0 { -1.0 } else { 1.0 }
}

/// A plateau at h is the plane at h - 1/2, or 1/2 - h of a scale below zero: what Welsh's offset without a limit gives.
#[test]
fn a_plateau_is_met_at_its_height() {
    for h in [0.125, 0.5, 0.75, 0.984_375] {
        let map = texels(8, 8, |_, _| h);
        let mut ray = rays(0x9a);
        let hit = |ray: [f32; 7]| Hit { ray, z: side(&ray) * (f64::from(h) - 0.5), closing: 1.0, apart: 0.0 };
        let hits: Vec<Hit> = (0..400).map(|_| hit(ray())).collect();
        assert_hits(&map, &hits);
        assert_noticed(&map, &hits, &[("i < bisections", "i + 8u < bisections")]);
        for Hit { ray: [_, _, x, y, z, sx, sy], .. } in &hits {
            let welsh = texbake::shading::welsh_offset(h, [*sx, *sy], [-0.5 * sx, -0.5 * sy], [*x, *y, *z]);
            let relief = relief_offset(|_| h, [0.0; 2], [*x, *y, *z], [*sx, *sy], STEPS, BISECTIONS);
            let slant = f64::from(sx / z).abs().max(f64::from(sy / z).abs());
            assert!((0..2).all(|axis| f64::from(welsh[axis] - relief[axis]).abs() <= 4e-7 * slant));
        }
    }
    // Written out: 3/4 at a scale of 4/100 is 1/100 up, seen at 45 degrees; as a depth 1/100 down.
    let [up, down] = [0.04, -0.04].map(|s| relief_offset(|_| 0.75, [0.5; 2], [1.0, 0.0, 1.0], [s; 2], 64, 20)[0]);
    assert!((up - 0.01).abs() < 1e-7 && (down + 0.01).abs() < 1e-7, "{up} {down}");
    // Straight above nothing moves.
    assert_eq!(relief_offset(|_| 0.9, [0.5; 2], [0.0, 0.0, 1.0], [0.04; 2], 64, 20), [0.0; 2]);
}

/// h = u: the ray is at z = side (u + slant z - 1/2) at z = side (u - 1/2) / (1 - side slant).
#[test]
fn an_inclined_plane_is_met_where_lines_cross() {
    let map = texels(64, 4, |x, _| (2 * x + 1) as f32 / 128.0);
    let mut ray = rays(0x1c);
    let mut hits = Vec::new();
    while hits.len() < 1000 {
        let ray = ray();
        let side = side(&ray);
        let mut hit = Hit { ray, z: 0.0, closing: 0.0, apart: 0.0 };
        let [slant, _] = hit.slant();
        hit.closing = 1.0 - side * slant;
        hit.z = side * (f64::from(ray[0]) - 0.5) / hit.closing;
        // Where the plane goes on: from where the ray enters to a step below the hit.
        let is_on = |z: f64| (0.02..0.98).contains(&(f64::from(ray[0]) + slant * z));
        if is_on(0.5) && is_on(hit.z - 0.02) && (-0.48..0.5).contains(&hit.z) {
            hits.push(hit);
        }
    }
    assert!(hits.iter().any(|hit| hit.ray[5] < 0.0) && hits.iter().any(|hit| hit.ray[5] > 0.0));
    assert_hits(&map, &hits);
    assert_noticed(
        &map,
        &hits,
        &[
            ("select(1.0, -1.0, scale.x < 0.0)", "1.0"),
            ("v.xy / v.z", "v.xy"),
            ("uv + slant * middle", "uv"),
            ("above + below)", "below + below)"),
            ("(h - 0.5) >= middle", "h >= middle"),
        ],
    );
}

/// A wall of one texel's slope between the top on the left and the bottom on the right: from the right the ray meets it,
/// from the left it passes over and meets the bottom.
#[test]
fn a_wall_hides_what_is_behind_it() {
    let map = texels(64, 4, |x, _| if x < 32 { 1.0 } else { 0.0 });
    let mut ray = rays(0x57e9);
    let (mut hits, mut bottoms) = (Vec::new(), 0);
    while hits.len() < 1000 {
        let mut ray = ray();
        (ray[5], ray[6]) = (ray[5].abs(), ray[6].abs());
        let mut hit = Hit { ray, z: 0.0, closing: 1.0, apart: 0.0 };
        let ([slant, _], u) = (hit.slant(), f64::from(ray[0]));
        // h - 1/2 = 1/2 - 64 (u - 31.5/64) on the wall.
        let wall = (0.5 - 64.0 * (u - 31.5 / 64.0)) / (1.0 + 64.0 * slant);
        let is_inside = |z: f64| (0.52..0.98).contains(&(u + slant * z));
        if slant > 0.02 && is_inside(0.5) && (-0.45..0.45).contains(&wall) {
            (hit.z, hit.closing) = (wall, 1.0 + 64.0 * slant);
            hits.push(hit);
        } else if is_inside(0.5) && is_inside(-0.5) {
            hit.z = -0.5;
            hits.push(hit);
            bottoms += 1;
        }
    }
    assert!(bottoms > 200 && hits.len() - bottoms > 50, "{bottoms}");
    assert_hits(&map, &hits);
    // Bisection alone, without steps from above, finds what is behind.
    assert_noticed(&map, &hits, &[("i <= steps", "i < 1u"), ("0.5 - f32(i)", "0.5 - 0.5 * f32(i)")]);
}

/// A cone, h = 1 - r / R: the nearer of two roots of a quadratic.
#[test]
fn a_cone_is_met_at_a_root() {
    const RADIUS: f64 = 20.0 / 64.0;
    let r = |x: usize, y: usize| (x as f64 - 31.5).hypot(y as f64 - 31.5) / 64.0;
    let map = texels(64, 64, |x, y| ((1.0 - r(x, y) / RADIUS).max(0.0) * 1024.0).round() as f32 / 1024.0);
    let mut ray = rays(0xc0);
    let mut hits = Vec::new();
    while hits.len() < 1000 {
        let mut ray = ray();
        (ray[5], ray[6]) = (ray[5].abs(), ray[6].abs());
        (ray[0], ray[1]) = (0.5 + 0.4 * ray[0], 0.5 + 0.4 * ray[1]);
        let mut hit = Hit { ray, z: 0.0, closing: 0.0, apart: 0.0 };
        let slant = hit.slant();
        let place = [f64::from(ray[0]) - 0.5, f64::from(ray[1]) - 0.5];
        // |place + slant z| = R (1/2 - z), squared: a z^2 + 2 b z + c = 0.
        let a = slant[0] * slant[0] + slant[1] * slant[1] - RADIUS * RADIUS;
        let b = place[0] * slant[0] + place[1] * slant[1] + 0.5 * RADIUS * RADIUS;
        let c = place[0] * place[0] + place[1] * place[1] - 0.25 * RADIUS * RADIUS;
        // The ray is steeper than the cone, a < 0, so that it meets each side once: where R (1/2 - z) is above zero.
        let root = (b * b - a * c).max(0.0).sqrt();
        let steep = slant[0].hypot(slant[1]) / RADIUS;
        let Some(z) = [(-b + root) / a, (-b - root) / a].into_iter().find(|z| *z < 0.5) else { continue };
        let radius = RADIUS * (0.5 - z) * 64.0;
        // Neither at the apex nor at the foot, which a filter rounds off.
        if steep < 0.7 && (3.0..19.0).contains(&radius) && b * b > a * c {
            hit.z = z;
            hit.closing = 1.0 - steep;
            // Between texels a line instead of an arc, along both axes, 1/8 of the second derivative; and codes of 1024.
            hit.apart = 2.0 / (8.0 * (radius - 1.5) * RADIUS * 64.0) + 1.0 / 2048.0;
            hits.push(hit);
        }
    }
    assert_hits(&map, &hits);
}
