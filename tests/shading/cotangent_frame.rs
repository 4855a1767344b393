//! The cotangent frame beside the 3 x 3 system that it replaces, solved by elimination.

use super::examined::f64s::{self, Vector};
use super::examined::{Examined, above, reals};
use super::real::{self, Real};
use super::tangent_frame::{flat, frame_from};
use texbake::shading::{Frame, cotangent_frame, gradients, perturbed_normal, without_perspective};

/// n, dp1, dp2, duv1, duv2: a normal that leans from the face's by up to 60 degrees, on either side of it; differences
/// that turn either way, skewed, mirrored; at scales from 1e-6 to 1e6.
fn surfaces() -> Vec<[f32; 13]> {
    let mut real = reals(0x5c);
    let mut surfaces = Vec::new();
    while surfaces.len() < 3000 {
        let [n, dp1, dp2] = [0, 1, 2].map(|_| above(&mut real, -1.0));
        let [u1, v1, u2, v2] = [0, 1, 2, 3].map(|_| real() as f32);
        let face = f64s::cross(dp1.map(f64::from), dp2.map(f64::from));
        let lean = f64s::dot(face, n.map(f64::from)).abs();
        // Not next to parallel, in space or in the texture.
        if f64s::length(face) > 0.3 && lean > 0.5 * f64s::length(face) && (u1 * v2 - u2 * v1).abs() > 0.1 {
            let [of_p, of_uv] = [[1.0, 1.0], [1e6, 1e-6], [1e-6, 1e6], [1e6, 1e6], [1e-6, 1e-6]][surfaces.len() % 5];
            let [dp1, dp2] = [dp1, dp2].map(|d| d.map(|part| part * of_p));
            let [u1, v1, u2, v2] = [u1, v1, u2, v2].map(|part| part * of_uv);
            surfaces.push([n[0], n[1], n[2], dp1[0], dp1[1], dp1[2], dp2[0], dp2[1], dp2[2], u1, v1, u2, v2]);
        }
    }
    surfaces
}

fn vector<T: Copy>(a: &[T], at: usize) -> [T; 3] {
    [a[at], a[at + 1], a[at + 2]]
}

/// u and v along both differences.
fn pairs<T: Copy>(a: &[T], at: usize) -> [[T; 2]; 2] {
    [[a[at], a[at + 1]], [a[at + 2], a[at + 3]]]
}

/// The vectors of a plane across which these differences grow by these amounts: rows dp1, dp2, n against (du1, du2, 0).
fn solved(n: Vector, dp: [Vector; 2], duv: [[f64; 2]; 2]) -> [Vector; 2] {
    [0, 1].map(|axis| f64s::solve([dp[0], dp[1], n], [duv[0][axis], duv[1][axis], 0.0]))
}

/// The longer one of length one.
fn in_proportion([t, b]: [Vector; 2], n: Vector) -> [Vector; 3] {
    let longest = f64s::length(t).max(f64s::length(b));
    [f64s::times(1.0 / longest, t), f64s::times(1.0 / longest, b), n]
}

fn combined(across: [[Real; 3]; 2], duv: [[Real; 2]; 2]) -> [[Real; 3]; 2] {
    [0, 1].map(|axis| real::add(real::times(duv[0][axis], across[0]), real::times(duv[1][axis], across[1])))
}

fn scale_invariant([t, b]: [[Real; 3]; 2], n: [Real; 3]) -> [Real; 9] {
    let inverse = real::dot(t, t).max(real::dot(b, b)).inverse_sqrt();
    flat([real::times(inverse, t), real::times(inverse, b), n])
}

fn twin_of(a: [f32; 13], frame: impl Fn([f32; 3], [[f32; 3]; 2], [[f32; 2]; 2]) -> Frame) -> [f32; 9] {
    flat(frame(vector(&a, 0), [vector(&a, 3), vector(&a, 6)], pairs(&a, 9)))
}

#[test]
fn cotangents_solve_the_system_of_the_differences() {
    let frame = Examined {
        file: "cotangent_frame",
        call: "cotangent_frame(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), vec3(a[6], a[7], a[8]), \
               vec2(a[9], a[10]), vec2(a[11], a[12]))",
        twin: &|a| twin_of(a, cotangent_frame),
        exact: &|a| {
            let n = vector(&a, 0);
            flat(in_proportion(solved(n, [vector(&a, 3), vector(&a, 6)], pairs(&a, 9)), n))
        },
        formula: &|a| {
            let [n, dp1, dp2] = [0, 3, 6].map(|at| vector(&a, at));
            let across = [real::cross(dp2, n), real::cross(n, dp1)];
            let turn = real::dot(dp1, across[0]);
            assert!(turn.is_clear());
            let side = turn.constant(turn.value.signum());
            scale_invariant(combined(across, pairs(&a, 9)).map(|axis| real::times(side, axis)), n)
        },
        arguments: surfaces(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    frame.assert();
    frame.notices(&[
        ("select(-1.0, 1.0, dot(dp1, dp2perp) >= 0.0)", "1.0"),
        ("cross(dp2, n)", "cross(n, dp2)"),
        ("dp1perp * duv2.x", "dp1perp * duv2.y"),
        ("max(dot(t, t), dot(b, b))", "dot(t, t)"),
        ("t * inverse, b * inverse", "normalize(t), normalize(b)"),
    ]);
}

#[test]
fn gradients_are_the_inverse_of_the_matrix() {
    let gradient = Examined {
        file: "cotangent_frame",
        call: "gradients(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), vec2(a[6], a[7]), vec2(a[8], a[9]))",
        twin: &|a: [f32; 10]| {
            let [t, b] = gradients([vector(&a, 0), vector(&a, 3)], pairs(&a, 6));
            [t[0], t[1], t[2], b[0], b[1], b[2]]
        },
        exact: &|a| {
            let dp = [vector(&a, 0), vector(&a, 3)];
            let [t, b] = solved(f64s::normalized(f64s::cross(dp[0], dp[1])), dp, pairs(&a, 6));
            [t[0], t[1], t[2], b[0], b[1], b[2]]
        },
        formula: &|a| {
            let dp = [vector(&a, 0), vector(&a, 3)];
            let face = real::cross(dp[0], dp[1]);
            let determinant = real::dot(face, face);
            let across = [real::cross(dp[1], face), real::cross(face, dp[0])];
            let [t, b] = combined(across.map(|axis| axis.map(|part| part / determinant)), pairs(&a, 6));
            [t[0], t[1], t[2], b[0], b[1], b[2]]
        },
        // Of the scales 1 and 1e-6 of the texture: squares of areas overflow soon.
        arguments: surfaces()
            .into_iter()
            .step_by(5)
            .map(|a| std::array::from_fn(|at| if at < 6 { 3.0 * a[at + 3] } else { a[at + 3] }))
            .collect(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    gradient.assert();
    gradient.notices(&[("cross(face, dp1) / determinant", "cross(dp1, face) / determinant")]);
}

#[test]
fn perturbed_normals_are_of_length_one() {
    let mut real = reals(0x9e);
    let arguments = surfaces()
        .into_iter()
        .map(|a| {
            let frame = twin_of(a, cotangent_frame);
            let m = above(&mut real, 0.3);
            std::array::from_fn(|at| if at < 9 { frame[at] } else { m[at - 9] })
        })
        .filter(|a: &[f32; 12]| f64s::length(sum(a.map(f64::from))) > 0.2)
        .collect();
    fn sum(a: [f64; 12]) -> Vector {
        [0, 1, 2].map(|axis| a[9] * a[axis] + a[10] * a[3 + axis] + a[11] * a[6 + axis])
    }
    let normal = Examined {
        file: "cotangent_frame",
        call: "perturbed_normal(mat3x3(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8]), vec3(a[9], a[10], a[11]))",
        twin: &|a| perturbed_normal(frame_from(a[..9].try_into().unwrap()), vector(&a, 9)),
        exact: &|a| f64s::normalized(sum(a)),
        formula: &|a| {
            let terms = [0, 1, 2].map(|axis| real::times(a[9 + axis], vector(&a, 3 * axis)));
            real::normalized(real::add(real::add(terms[0], terms[1]), terms[2]))
        },
        arguments,
        #[cfg(feature = "gpu")]
        texture: None,
    };
    normal.assert();
    normal.notices(&[("normalize(m.x", "(m.x"), ("m.y * frame[1]", "m.y * frame[0]")]);
}

const UP: [f32; 3] = [0.0, 0.0, 1.0];
const X: [f32; 3] = [1.0, 0.0, 0.0];
const Y: [f32; 3] = [0.0, 1.0, 0.0];
const ALONG: [[f32; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

fn negated<const N: usize>(v: [f32; N]) -> [f32; N] {
    v.map(|part| 0.0 - part)
}

/// The same surface seen through differences that turn the other way: dpdy down the framebuffer, a triangle from behind.
#[test]
fn the_way_round_of_the_differences_does_not_matter() {
    let expected = [X, Y, UP];
    assert_eq!(cotangent_frame(UP, [X, Y], ALONG), expected);
    assert_eq!(cotangent_frame(UP, [X, negated(Y)], [[1.0, 0.0], [0.0, -1.0]]), expected);
    assert_eq!(cotangent_frame(UP, [Y, X], [[0.0, 1.0], [1.0, 0.0]]), expected);
    // As Schüler writes it, T = dp2perp du1 + dp1perp du2 points against growing u there.
    let dp2perp = f64s::cross(negated(Y).map(f64::from), UP.map(f64::from));
    assert_eq!(dp2perp, [-1.0, 0.0, 0.0]);
    // From behind: the normal is the other one, u and v still grow along x and y.
    assert_eq!(cotangent_frame(negated(UP), [X, Y], ALONG), [X, Y, negated(UP)]);
}

#[test]
fn mirrored_and_skewed_mappings_keep_their_gradients() {
    assert_eq!(cotangent_frame(UP, [X, Y], [[-1.0, 0.0], [0.0, 1.0]]), [negated(X), Y, UP]);
    // u = x + y / 2, v = y: |T| : |B| is 1.118 : 1. The tangent, dp/du, would be x alone.
    let [t, b, _] = cotangent_frame(UP, [X, Y], [[1.0, 0.0], [0.5, 1.0]]);
    let long = 1.25f32.sqrt();
    for (got, expected) in t.into_iter().chain(b).zip([1.0 / long, 0.5 / long, 0.0, 0.0, 1.0 / long, 0.0]) {
        assert!((got - expected).abs() < 2e-7, "{t:?}, {b:?}");
    }
    // v three times as fast as u.
    let [t, b, _] = cotangent_frame(UP, [X, Y], [[1.0, 0.0], [0.0, 3.0]]);
    assert_eq!((t, b), ([1.0 / 3.0, 0.0, 0.0], Y));
}

#[test]
fn the_scale_does_not_matter() {
    let duv = [[0.3, -0.1], [0.2, 0.7]];
    let n = [0.0, 0.6, 0.8];
    let frame = cotangent_frame(n, [[1.0, 0.1, 0.2], [-0.2, 0.8, -0.6]], duv);
    for scale in [1e6f32, 1e-6] {
        let scaled = cotangent_frame(n, [[1.0, 0.1, 0.2], [-0.2, 0.8, -0.6]].map(|d| d.map(|part| part * scale)), duv);
        for (got, expected) in flat(scaled).into_iter().zip(flat(frame)) {
            assert!((got - expected).abs() < 1e-6, "{scaled:?}, {frame:?}");
        }
    }
}

#[test]
fn without_an_area_there_is_no_direction() {
    let zero = [0.0; 3];
    assert_eq!(cotangent_frame(UP, [X, Y], [[0.0; 2]; 2]), [zero, zero, UP]);
    assert_eq!(cotangent_frame(UP, [zero, zero], ALONG), [zero, zero, UP]);
    // u alone changes.
    assert_eq!(cotangent_frame(UP, [X, Y], [[1.0, 0.0], [0.0, 0.0]]), [X, zero, UP]);
    // With such a frame the normal stays what it is.
    assert_eq!(perturbed_normal([zero, zero, UP], [0.6, 0.0, 0.8]), UP);
    #[cfg(feature = "gpu")]
    {
        let call = |dp: f32, duv: f32, expected: f32| crate::support::Call {
            arguments: [dp, duv],
            expected: [expected, 0.0, 0.0, 0.0, expected, 0.0, 0.0, 0.0, 1.0],
            bounds: [0.0; 9],
        };
        let function = crate::support::ShaderFunction {
            wgsl: super::examined::text_of("cotangent_frame"),
            call: "cotangent_frame(vec3(0.0, 0.0, 1.0), vec3(a[0], 0.0, 0.0), vec3(0.0, a[0], 0.0), \
                   vec2(a[1], 0.0), vec2(0.0, a[1]))",
            texture: None,
        };
        function.assert_on_every_device(&[call(1.0, 0.0, 0.0), call(0.0, 1.0, 0.0), call(0.0, 0.0, 0.0)], 0);
    }
}

#[test]
fn the_shortcut_is_right_for_orthogonal_differences_of_one_length() {
    let frame = Examined {
        file: "cotangent_frame",
        call: "without_perspective(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), vec3(a[6], a[7], a[8]), \
               vec2(a[9], a[10]), vec2(a[11], a[12]))",
        twin: &|a| twin_of(a, without_perspective),
        exact: &|a| {
            let (dp, duv) = ([vector(&a, 3), vector(&a, 6)], pairs(&a, 9));
            let [t, b] =
                [0, 1].map(|axis| [0, 1, 2].map(|part| dp[0][part] * duv[0][axis] + dp[1][part] * duv[1][axis]));
            flat(in_proportion([t, b], vector(&a, 0)))
        },
        formula: &|a| scale_invariant(combined([vector(&a, 3), vector(&a, 6)], pairs(&a, 9)), vector(&a, 0)),
        arguments: surfaces(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    frame.assert();
    frame.notices(&[("dp1 * duv1.x + dp2 * duv2.x", "dp2 * duv1.x + dp1 * duv2.x")]);

    // A square turned in its plane, differences of length 5, any mapping.
    let dp = [[3.0, 4.0, 0.0], [-4.0, 3.0, 0.0]];
    for duv in [ALONG, [[0.5, 0.25], [-1.0, 0.75]], [[1.0, 2.0], [2.0, 1.0]]] {
        let [short, general] = [without_perspective(UP, dp, duv), cotangent_frame(UP, dp, duv)];
        for (short, general) in flat(short).into_iter().zip(flat(general)) {
            assert!((short - general).abs() < 1e-6, "{short} {general}");
        }
    }
}

/// A floor seen at 60 degrees: a pixel is twice as long as it is wide. u runs along x + y; its gradient is at 45 degrees,
/// the shortcut's at arctan 4, 31 degrees off.
#[test]
fn the_shortcut_is_wrong_at_a_slant() {
    let dp = [X, [0.0, 2.0, 0.0]];
    let duv = [[1.0, -1.0], [2.0, 2.0]];
    let degrees = |frame: Frame, axis: usize, truth: [f64; 3]| f64s::angle(frame[axis].map(f64::from), truth);
    let general = cotangent_frame(UP, dp, duv);
    assert!(degrees(general, 0, [1.0, 1.0, 0.0]) < 1e-4 && degrees(general, 1, [-1.0, 1.0, 0.0]) < 1e-4);
    let short = without_perspective(UP, dp, duv);
    let off = 4f64.atan().to_degrees() - 45.0;
    assert!((off - 30.963_757).abs() < 1e-6);
    assert!((degrees(short, 0, [1.0, 1.0, 0.0]) - off).abs() < 1e-4);
    assert!((degrees(short, 1, [-1.0, 1.0, 0.0]) - off).abs() < 1e-4);
}
