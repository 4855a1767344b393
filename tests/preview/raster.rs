//! Triangles in perspective beside rays in f64.

use texbake::preview::{Canvas, Corner, Viewpoint};

const SIDE: usize = 64;

fn viewpoint(points: &[[f32; 3]]) -> Viewpoint {
    let from = [0.48, 0.6, 0.64];
    Viewpoint::around(points, from, [0.0, 1.0, 0.0])
}

fn corner(position: [f32; 3], attribute: f32) -> Corner<1> {
    Corner { position, attributes: [attribute] }
}

/// A triangle's sample is where the ray through it meets the triangle's plane, and what is linear there is so here.
#[test]
fn samples_are_where_their_rays_meet_the_triangle() {
    let positions = [[-1.0, -0.2, 0.5], [1.2, 0.1, 0.4], [0.1, 0.9, -1.1]];
    let linear = |p: [f64; 3]| 0.3 * p[0] - 0.7 * p[1] + 0.2 * p[2] + 0.1;
    let viewpoint = viewpoint(&positions);
    let corners = positions.map(|p| corner(p, linear(p.map(f64::from)) as f32));
    let mut canvas = Canvas::new(SIDE, viewpoint, [0.0; 3]);
    canvas.triangle(corners.each_ref(), |[x, y, _], [attribute]| [x + 10.0, y + 10.0, attribute + 10.0]);

    let [a, b, c] = positions.map(|p| p.map(f64::from));
    let sub = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let n = cross(sub(b, a), sub(c, a));
    let eye = viewpoint.eye.map(f64::from);
    let mut covered = 0;
    for (i, colour) in canvas.colours().iter().enumerate() {
        if *colour == [0.0; 3] {
            continue;
        }
        let at = |pixel: usize| (2.0 * (pixel as f64 + 0.5) / SIDE as f64 - 1.0) * f64::from(viewpoint.field);
        let [right, down, ahead] = viewpoint.axes.map(|axis| axis.map(f64::from));
        let ray = [0, 1, 2].map(|k| at(i % SIDE) * right[k] + at(i / SIDE) * down[k] + ahead[k]);
        let t = dot(sub(a, eye), n) / dot(ray, n);
        let met = [0, 1, 2].map(|k| eye[k] + t * ray[k]);
        let expected = [met[0] + 10.0, met[1] + 10.0, linear(met) + 10.0];
        let off = (0..3).map(|k| (f64::from(colour[k]) - expected[k]).abs()).fold(0.0, f64::max);
        // A few roundings of numbers near 10.
        assert!(off < 2e-5, "{i}: {colour:?}, not {expected:?}");
        covered += 1;
    }
    assert!(covered > SIDE * SIDE / 20, "{covered}");
}

/// What is nearer hides what is behind, whichever is drawn first.
#[test]
fn the_nearest_is_in_front() {
    let triangle = |z: f32| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]];
    let points = [triangle(0.0), triangle(1.0)].concat();
    let viewpoint = Viewpoint::around(&points, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let middle = SIDE / 2 * SIDE + SIDE / 2;
    for order in [[0.0, 1.0], [1.0, 0.0]] {
        let mut canvas = Canvas::new(SIDE, viewpoint, [0.0; 3]);
        for z in order {
            canvas.triangle(triangle(z).map(|p| corner(p, z)).each_ref(), |_, [z]| [z + 1.0; 3]);
        }
        assert_eq!(canvas.colours()[middle], [2.0; 3]);
        // A line behind is hidden, one in front is not.
        canvas.line([-1.0, 0.0, 0.5], [1.0, 0.0, 0.5], 1, [9.0; 3]);
        assert_eq!(canvas.colours()[middle], [2.0; 3]);
        canvas.line([-1.0, 0.0, 1.2], [1.0, 0.0, 1.2], 2, [9.0; 3]);
        assert_eq!(canvas.colours()[middle], [9.0; 3]);
    }
}

/// Whatever the mesh, all of it is in the picture, and it fills the picture.
#[test]
fn a_mesh_fits_the_picture() {
    for size in [1e-6, 1.0, 1e6] {
        let points = [[0.0, 0.0, 0.0], [size, 0.0, 0.0], [0.0, size, 0.5 * size], [size, size, -size]];
        let viewpoint = viewpoint(&points);
        let mut canvas = Canvas::new(SIDE, viewpoint, [0.0; 3]);
        for triangle in [[0, 1, 2], [1, 3, 2], [0, 3, 1], [0, 2, 3]] {
            canvas.triangle(triangle.map(|i: usize| corner(points[i], 0.0)).each_ref(), |_, _| [1.0; 3]);
        }
        let seen: Vec<usize> = (0..SIDE * SIDE).filter(|i| canvas.colours()[*i] == [1.0; 3]).collect();
        let is_border = |i: &usize| [0, SIDE - 1].contains(&(i % SIDE)) || [0, SIDE - 1].contains(&(i / SIDE));
        assert!(!seen.iter().any(is_border) && seen.len() > SIDE * SIDE / 8, "{size}: {}", seen.len());
    }
}
