//! Welsh's offsets: where the ray to the eye meets the plane at the height of the texel.

use super::examined::{Examined, above, reals};
use super::real::Real;
use texbake::shading::{limited_offset, plane_offset, welsh_offset};

/// h, scale, bias, v: scales and biases of their own for each axis, of either sign.
fn views() -> Vec<[f32; 8]> {
    let mut real = reals(0x2004);
    (0..2000)
        .map(|_| {
            let v = above(&mut real, 0.05);
            let [h, sx, sy, bx, by] = [0, 1, 2, 3, 4].map(|_| real() as f32);
            [0.5 + 0.5 * h, 0.1 * sx, 0.1 * sy, 0.05 * bx, 0.05 * by, v[0], v[1], v[2]]
        })
        .collect()
}

fn examined<'a>(
    call: &'static str,
    twin: &'a dyn Fn([f32; 8]) -> [f32; 2],
    exact: &'a dyn Fn([f64; 8]) -> [f64; 2],
    formula: &'a dyn Fn([Real; 8]) -> [Real; 2],
) -> Examined<'a, 8, 2> {
    Examined {
        file: "welsh_offset",
        call,
        twin,
        exact,
        formula,
        arguments: views(),
        #[cfg(feature = "gpu")]
        texture: None,
    }
}

#[test]
fn unlimited_offsets_end_at_the_height() {
    let offset = examined(
        "welsh_offset(a[0], vec2(a[1], a[2]), vec2(a[3], a[4]), vec3(a[5], a[6], a[7]))",
        &|[h, sx, sy, bx, by, x, y, z]| welsh_offset(h, [sx, sy], [bx, by], [x, y, z]),
        // The ray is at the height after height / z of its length.
        &|[h, sx, sy, bx, by, x, y, z]| [(h * sx + bx) / z * x, (h * sy + by) / z * y],
        &|[h, sx, sy, bx, by, x, y, z]| [(h * sx + bx) * (x / z), (h * sy + by) * (y / z)],
    );
    offset.assert();
    offset.notices(&[("v.xy / v.z", "v.xy"), ("+ bias) * (v.xy", "- bias) * (v.xy"), ("h * scale", "h * scale.xx")]);
}

#[test]
fn limited_offsets_are_no_longer_than_the_height() {
    let offset = examined(
        "limited_offset(a[0], vec2(a[1], a[2]), vec2(a[3], a[4]), vec3(a[5], a[6], a[7]))",
        &|[h, sx, sy, bx, by, x, y, z]| limited_offset(h, [sx, sy], [bx, by], [x, y, z]),
        &|[h, sx, sy, bx, by, x, y, _]| [x * h * sx + x * bx, y * h * sy + y * by],
        &|[h, sx, sy, bx, by, x, y, _]| [(h * sx + bx) * x, (h * sy + by) * y],
    );
    offset.assert();
    let limited = "-> vec2<f32> {\n    return (h * scale + bias) * v.xy;";
    offset.notices(&[(limited, "-> vec2<f32> {\n    return (h * scale + bias) * (v.xy / v.z);")]);
    for [h, s, _, _, _, x, y, z] in views() {
        let (scale, bias) = ([s; 2], [-0.5 * s; 2]);
        let [height, offset] = [f64::from(h * s - 0.5 * s), length(limited_offset(h, scale, bias, [x, y, z]))];
        assert!(offset <= height.abs() * (1.0 + 1e-6), "{h} {s} {x} {y} {z}");
        // From straight above both are nothing, and nearly one where z is nearly 1.
        let unlimited = length(welsh_offset(h, scale, bias, [x, y, z]));
        assert!((unlimited * f64::from(z) - offset).abs() <= 1e-6 * unlimited);
    }
}

fn length([x, y]: [f32; 2]) -> f64 {
    f64::from(x).hypot(y.into())
}

/// Welsh's text has a bias of +s/2; his programs have scale 0.04 and bias -0.02, by which a height of 1/2 moves nothing.
#[test]
fn the_bias_takes_the_middle_to_the_surface() {
    for v in [[0.6, 0.0, 0.8], [0.0, -0.96, 0.28]] {
        for offset in [welsh_offset, limited_offset] {
            assert_eq!(offset(0.5, [0.04; 2], [-0.02; 2], v).map(f32::abs), [0.0; 2]);
            let [up, down] = [1.0, 0.0].map(|h| offset(h, [0.04; 2], [-0.02; 2], v));
            assert_eq!(up, down.map(|part| 0.0 - part), "as far up as down");
        }
    }
    assert_eq!(welsh_offset(0.5, [0.04; 2], [0.02; 2], [0.6, 0.0, 0.8])[0], 0.04 * 0.75);
}

/// A rectangular map: 24 texels of height over 512 x 128 texels are 3/64 and 3/16 in texture coordinates.
#[test]
fn rectangular_maps_need_a_scale_for_each_axis() {
    let scale = [24.0 / 512.0, 24.0 / 128.0];
    let bias = scale.map(|s| -0.5 * s);
    let [x, y] = limited_offset(1.0, scale, bias, [0.6, 0.6, 0.529_150_26]);
    // In texels both are the same.
    assert!((x * 512.0 - 7.2).abs() < 1e-6 && (y * 128.0 - 7.2).abs() < 1e-6, "{x} {y}");
}

/// On a flat texel the plane's offset without a limit is Welsh's; with a limit it goes on as Welsh's limited one would if
/// v_xy had length one.
#[test]
fn on_a_flat_texel_the_plane_s_offset_is_welsh_s() {
    let flat = [0.0, 0.0, 1.0];
    for [h, s, _, _, _, x, y, z] in views() {
        let height = h * s - 0.5 * s;
        let [welsh, plane] =
            [welsh_offset(h, [s; 2], [-0.5 * s; 2], [x, y, z]), plane_offset(flat, height, [x, y, z], 1e6)];
        assert!(length([welsh[0] - plane[0], welsh[1] - plane[1]]) <= 1e-6 * length(welsh) + 1e-9);
        let limited = length(plane_offset(flat, height, [x, y, z], 1.0));
        assert!(limited <= f64::from(height.abs()) * (1.0 + 1e-6));
    }
    // At 11.5 degrees above the surface: 4.9 heights without a limit.
    let shallow = [0.98, 0.0, 0.2];
    assert!((plane_offset(flat, 1.0, shallow, 1e6)[0] - 4.9).abs() < 1e-5);
    assert_eq!(plane_offset(flat, 1.0, shallow, 1.0), [1.0, 0.0]);
    // Straight above nothing moves.
    assert_eq!(welsh_offset(1.0, [0.1; 2], [-0.05; 2], flat), [0.0; 2]);
    assert_eq!(limited_offset(1.0, [0.1; 2], [-0.05; 2], flat), [0.0; 2]);
}
