//! Tangent space with precomputed tangents: double cross products and elimination as the oracles.

use super::examined::f64s::{self, Vector};
use super::examined::{Examined, above, reals};
use super::real::{self, Real};
use texbake::shading::{pixel_frame, to_object, to_tangent, vertex_frame};

/// Normals and tangents as interpolation leaves them: of lengths from 0.25 to 1, t leaning up to 60 degrees out of the
/// plane; and either handedness.
fn vertices() -> Vec<[f32; 7]> {
    let mut real = reals(0x77);
    let mut vertices = Vec::new();
    while vertices.len() < 2000 {
        let [n, t] = [0, 1].map(|_| above(&mut real, -1.0));
        let along: f64 = (0..3).map(|axis| f64::from(n[axis]) * f64::from(t[axis])).sum();
        if along.abs() < 0.87 {
            let [long_n, long_t] = [0, 1].map(|_| (0.625 + 0.375 * real()) as f32);
            let w = if vertices.len() % 2 == 0 { 1.0 } else { -1.0 };
            let [n, t] = [n.map(|part| part * long_n), t.map(|part| part * long_t)];
            vertices.push([n[0], n[1], n[2], t[0], t[1], t[2], w]);
        }
    }
    vertices
}

fn frame_of(
    [nx, ny, nz, tx, ty, tz, w]: [f32; 7],
    frame: impl Fn([f32; 3], [f32; 3], f32) -> [[f32; 3]; 3],
) -> [f32; 9] {
    flat(frame([nx, ny, nz], [tx, ty, tz], w))
}

pub fn flat<T: Copy>([t, b, n]: [[T; 3]; 3]) -> [T; 9] {
    [t[0], t[1], t[2], b[0], b[1], b[2], n[0], n[1], n[2]]
}

#[test]
fn vertex_frames_are_the_listing_s() {
    let frame = Examined {
        file: "tangent_frame",
        call: "vertex_frame(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), a[6])",
        twin: &|arguments| frame_of(arguments, vertex_frame),
        exact: &|[nx, ny, nz, tx, ty, tz, w]| {
            let (n, t) = ([nx, ny, nz], [tx, ty, tz]);
            // The b of n . b = t . b = 0 and the volume det(t, b, n) = w |n x t|^2.
            let across = f64s::cross(n, t);
            let b = f64s::solve([n, t, across], [0.0, 0.0, w * f64s::dot(across, across)]);
            flat([t, b, n])
        },
        formula: &|[nx, ny, nz, tx, ty, tz, w]| {
            let (n, t) = ([nx, ny, nz], [tx, ty, tz]);
            flat([t, real::times(w, real::cross(n, t)), n])
        },
        arguments: vertices(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    frame.assert();
    frame.notices(&[("w * cross(n, t)", "cross(n, t)"), ("cross(n, t)", "cross(t, n)")]);
}

fn orthonormal(n: Vector, t: Vector, w: f64) -> [Vector; 3] {
    // What of t is across n, without a projection.
    let tangent = f64s::normalized(f64s::cross(f64s::cross(n, t), n));
    let normal = f64s::normalized(n);
    let across = f64s::cross(normal, tangent);
    [tangent, f64s::solve([normal, tangent, across], [0.0, 0.0, w]), normal]
}

#[test]
fn pixel_frames_are_orthonormal() {
    let frame = Examined {
        file: "tangent_frame",
        call: "pixel_frame(vec3(a[0], a[1], a[2]), vec3(a[3], a[4], a[5]), a[6])",
        twin: &|arguments| frame_of(arguments, pixel_frame),
        exact: &|[nx, ny, nz, tx, ty, tz, w]| flat(orthonormal([nx, ny, nz], [tx, ty, tz], w)),
        formula: &|[nx, ny, nz, tx, ty, tz, w]| {
            let (n, t) = (real::normalized([nx, ny, nz]), [tx, ty, tz]);
            let along = real::dot(t, n);
            let tangent = real::normalized([0, 1, 2].map(|axis| t[axis] - along * n[axis]));
            flat([tangent, real::times(w, real::cross(n, tangent)), n])
        },
        arguments: vertices(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    frame.assert();
    frame.notices(&[
        ("w * cross(normal, tangent)", "w * cross(n, t)"),
        ("normalize(n)", "n"),
        ("normalize(t - dot(t, normal) * normal)", "normalize(t)"),
    ]);
}

/// Listing 7.8 takes the cross product of n and t as they were interpolated. With n = (0, 0, 3/4) and t = (1/2, 0, 1/2)
/// its b is 3/8 long; with t = (1/2, 0, 1/2), n = (0, 3/5, 4/5) / 2 it points 12.4 degrees away, too.
#[test]
fn the_book_s_cross_product_comes_too_early() {
    let n = [0.0, 0.0, 0.75];
    let t = [0.5, 0.0, 0.5];
    assert_eq!(vertex_frame(n, t, 1.0)[1], [0.0, 0.375, 0.0]);
    assert_eq!(pixel_frame(n, t, 1.0), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    // The listing's order also keeps the length of what leans: |n x t| = |n| |t| sin.
    let leaning = [0.0, 0.3, 0.4];
    let early = vertex_frame(leaning, t, 1.0)[1].map(f64::from);
    assert!((f64s::length(early) - 0.25 * 1.36f64.sqrt()).abs() < 1e-7);
    let late = pixel_frame(leaning, t, 1.0)[1].map(f64::from);
    assert!((f64s::length(late) - 1.0).abs() < 1e-6);
    assert!(f64s::angle(early, late) < 1e-4, "the direction is the same");
}

/// t . v, b . v, n . v: the solution of (t b n) x = v for an orthonormal frame.
#[test]
fn vectors_are_turned_into_tangent_space_and_back() {
    let mut real = reals(0x732);
    let arguments: Vec<[f32; 12]> = vertices()
        .into_iter()
        .map(|[nx, ny, nz, tx, ty, tz, w]| {
            let frame = flat(pixel_frame([nx, ny, nz], [tx, ty, tz], w));
            let v = [real(), real(), real()].map(|part| (4.0 * part) as f32);
            std::array::from_fn(|at| if at < 9 { frame[at] } else { v[at - 9] })
        })
        .collect();
    let columns = |a: [f64; 12]| [0, 1, 2].map(|axis| [a[axis], a[3 + axis], a[6 + axis]]);
    // A frame in f32 is orthonormal within some roundings; its inverse is as far off its transpose.
    for a in &arguments {
        let [frame, v] = [a[..9].try_into().unwrap(), [a[9], a[10], a[11], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]];
        let got = to_tangent(frame_from(frame), [v[0], v[1], v[2]]);
        let exact = f64s::solve(columns(a.map(f64::from)), [a[9], a[10], a[11]].map(f64::from));
        let off = (0..3).map(|axis| (f64::from(got[axis]) - exact[axis]).abs()).fold(0.0, f64::max);
        assert!(off < 4e-6, "{a:?}: {got:?}, {exact:?}");
    }
    let frame = "mat3x3(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8])";
    let call = format!("to_tangent({frame}, vec3(a[9], a[10], a[11]))");
    let rows = |a: [Real; 12]| [[a[0], a[1], a[2]], [a[3], a[4], a[5]], [a[6], a[7], a[8]]];
    let turned = Examined {
        file: "tangent_frame",
        call: call.leak(),
        twin: &|a| to_tangent(frame_from(a[..9].try_into().unwrap()), [a[9], a[10], a[11]]),
        // |v| times the cosine, by the law of cosines.
        exact: &|a| {
            let v = [a[9], a[10], a[11]];
            [0, 3, 6].map(|at| {
                let axis = [a[at], a[at + 1], a[at + 2]];
                let across = f64s::length([0, 1, 2].map(|part| v[part] - axis[part]));
                0.5 * (f64s::dot(v, v) + f64s::dot(axis, axis) - across * across)
            })
        },
        formula: &|a| rows(a).map(|axis| real::dot(axis, [a[9], a[10], a[11]])),
        arguments: arguments.clone(),
        #[cfg(feature = "gpu")]
        texture: None,
    };
    turned.assert();
    turned.notices(&[("dot(frame[1], v)", "dot(frame[0], v)")]);
    let call = format!("to_object({frame}, vec3(a[9], a[10], a[11]))");
    let back = Examined {
        file: "tangent_frame",
        call: call.leak(),
        twin: &|a| to_object(frame_from(a[..9].try_into().unwrap()), [a[9], a[10], a[11]]),
        // The x whose parts along b x n, n x t, t x b over the volume are those of v: Cramer's rule backwards.
        exact: &|a| {
            let [t, b, n] = [0, 3, 6].map(|at| [a[at], a[at + 1], a[at + 2]]);
            let volume = f64s::dot(t, f64s::cross(b, n));
            let rows = [f64s::cross(b, n), f64s::cross(n, t), f64s::cross(t, b)];
            f64s::solve(rows, [a[9], a[10], a[11]].map(|part| part * volume))
        },
        formula: &|a| {
            let [t, b, n] = rows(a);
            real::add(real::add(real::times(a[9], t), real::times(a[10], b)), real::times(a[11], n))
        },
        arguments,
        #[cfg(feature = "gpu")]
        texture: None,
    };
    back.assert();
    back.notices(&[("m.z * frame[2]", "m.z * frame[1]"), ("m.y * frame[1]", "-m.y * frame[1]")]);
}

pub fn frame_from(a: [f32; 9]) -> [[f32; 3]; 3] {
    [[a[0], a[1], a[2]], [a[3], a[4], a[5]], [a[6], a[7], a[8]]]
}
