//! Surfaces whose tangents are known: planes, cylinders, spheres, and triangles with numbers by hand.

use super::{METHODS, as_to_v, assert_all, by, nothing_found, tangents};
use crate::support::{angle, changed, corners, cylinder, direction, flat_mesh, plane, sphere, torus};
use texbake::{Mesh, TangentMethod};

/// 1 may be missed by a step.
const STEP: f64 = 1.0 / (1 << 23) as f64;

#[test]
fn a_plane_has_its_axis_everywhere() {
    let mesh = plane(4, 3);
    for method in METHODS {
        if method == TangentMethod::Hegde {
            continue; // Along the first edge whose u changes, which is a diagonal in half of the triangles.
        }
        let made = tangents(&mesh, &by(method));
        assert_all(&mesh, &made, [1.0, 0.0, 0.0, 1.0], STEP);
        assert!(made.tangents.iter().all(|&[_, y, z, w]| (y, z, w) == (0.0, 0.0, 1.0)), "{method}: not exact");
        assert_eq!(made.report, nothing_found(&mesh));
        assert_eq!((made.normals, made.triangles, made.copies), (None, None, vec![]));
    }
}

/// (u, v) = A (x, y), so t is the first column of A's inverse and the handedness is the sign of A's determinant.
#[test]
fn sheared_and_scaled_mappings_have_the_inverse_matrix() {
    let matrices = [
        ([[2.0, 0.0], [0.0, 5.0]], [1.0, 0.0], 1.0),
        ([[1.0, 0.5], [0.0, 1.0]], [1.0, 0.0], 1.0),
        ([[1.0, 0.0], [0.5, 1.0]], [0.8f64.sqrt(), -0.2f64.sqrt()], 1.0),
        ([[0.0, 1.0], [-1.0, 0.0]], [0.0, 1.0], 1.0),
        ([[-1.0, 0.0], [0.0, 1.0]], [-1.0, 0.0], -1.0),
        ([[1.0, 0.0], [0.0, -1.0]], [1.0, 0.0], -1.0),
        ([[0.0, 4.0], [4.0, 0.0]], [0.0, 1.0], -1.0),
        ([[0.25, 0.75], [0.75, 0.25]], [-0.1f64.sqrt(), 0.9f64.sqrt()], -1.0),
    ];
    for (matrix, [x, y], w) in matrices {
        let base = plane(4, 4);
        let texcoords = base.positions().iter().map(|p| matrix.map(|row: [f32; 2]| row[0] * p[0] + row[1] * p[1]));
        let mesh = Mesh::new(base.positions().to_vec(), texcoords.collect(), base.triangles().to_vec());
        let mesh = mesh.expect("a mesh").with_normals(vec![[0.0, 0.0, 1.0]; 25]).expect("normals");
        for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel] {
            // All differences are multiples of 1/16 below 2^3: exact. A few roundings are left.
            assert_all(&mesh, &tangents(&mesh, &as_to_v(method)), [x, y, 0.0, w], 6.0 * STEP);
        }
    }
}

/// d position / du is (-sin, cos, 0): triangles have chords of it, and what is left at a right angle to the normal is
/// the tangent. f32 positions are off by 2^-25 each, so chords of 2 sin(pi / 20) turn by 2^-24 sqrt(2) / 0.31 at most.
#[test]
fn a_cylinder_has_the_direction_around() {
    let mesh = cylinder(20, 3);
    for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel] {
        let made = tangents(&mesh, &by(method));
        for corner in corners(&mesh, &made) {
            let [x, y, _] = corner.normal.map(f64::from);
            let off = angle(direction(corner.tangent), [-y, x, 0.0]);
            assert!(off < 2f64.powi(-24) * 10.0, "{method}: {corner:?} is off by {off:e}");
            assert_eq!(corner.tangent[3], 1.0);
        }
        assert_eq!(made.report, nothing_found(&mesh));
    }
}

/// The greatest angle to (-sin, cos, 0), of corners whose vertices are not at the border of the grid.
fn greatest_error(mesh: &Mesh, method: TangentMethod) -> f64 {
    let made = tangents(mesh, &by(method));
    let is_inside = |vertex: u32| mesh.texcoords()[vertex as usize].iter().all(|&part| part > 0.0 && part < 1.0);
    let inside = corners(mesh, &made).into_iter().filter(|corner| is_inside(corner.source));
    let errors: Vec<f64> = inside
        .map(|corner| {
            assert_eq!(corner.tangent[3], 1.0);
            let [x, y, _] = mesh.positions()[corner.source as usize].map(f64::from);
            angle(direction(corner.tangent), [-y, x, 0.0])
        })
        .collect();
    assert!(errors.len() > 100);
    errors.into_iter().fold(0.0, f64::max)
}

/// Triangles differ from the surface by the step h; around an inner vertex these errors are odd and cancel but for
/// h^2, so half the step leaves a quarter, and a bit more as the last inner row comes nearer
/// to the border. Hegde's edges are diagonals: not d position / du.
#[test]
fn a_sphere_away_from_its_poles_and_a_torus_converge_to_du() {
    for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel] {
        let coarse = greatest_error(&sphere(24, 12, 60.0), method);
        let fine = greatest_error(&sphere(48, 24, 60.0), method);
        // Nothing but rounding is left of MikkTSpace's: its weights are the same to the left and to the right.
        assert!(coarse < 0.05 && (fine < 0.35 * coarse || fine < 1e-6), "sphere, {method}: {coarse} and {fine}");
        let once_around = |mesh: Mesh| changed(&mesh, |p| p, |n| n, |[u, v]| [u / 3.0, v]);
        let coarse = greatest_error(&once_around(torus(24, 16)), method);
        let fine = greatest_error(&once_around(torus(48, 32)), method);
        assert!(coarse < 0.05 && (fine < 0.35 * coarse || fine < 1e-6), "torus, {method}: {coarse} and {fine}");
    }
}

/// Two triangles that share vertex 0 have t = (1, 0) and, with half the texture's density, t = (0, 2).
#[test]
fn lengyel_weighs_by_the_inverse_of_the_density() {
    let points = [
        ([0.0, 0.0], [0.0, 0.0]),
        ([1.0, 0.0], [1.0, 0.0]),
        ([0.0, 1.0], [0.0, 1.0]),
        ([-1.0, 0.0], [0.0, 0.5]),
        ([0.0, -1.0], [-0.5, 0.0]),
    ];
    let mesh = flat_mesh(&points, vec![[0, 1, 2], [0, 3, 4]]);
    let at_0 = |method| tangents(&mesh, &as_to_v(method)).tangents[0].map(f64::from);
    let is_near = |got: [f64; 4], x: f64, y: f64| (got[0] - x).abs() < 2.0 * STEP && (got[1] - y).abs() < 2.0 * STEP;
    // (1, 2) / sqrt(5).
    let lengyel = at_0(TangentMethod::Lengyel);
    assert!(is_near(lengyel, 0.2f64.sqrt(), 0.8f64.sqrt()), "{lengyel:?}");
    // (1, 1) / sqrt(2): unit vectors.
    let hegde = at_0(TangentMethod::Hegde);
    assert!(is_near(hegde, 0.5f64.sqrt(), 0.5f64.sqrt()), "{hegde:?}");
    assert_eq!([lengyel[3], hegde[3]], [1.0, 1.0]);
}

/// One triangle with e1 = (2, 1), e2 = (0, 1).
#[test]
fn hegde_takes_the_first_edge_whose_u_changes() {
    let triangle = |uv1, uv2| {
        let points = [([0.0, 0.0], [0.0, 0.0]), ([2.0, 1.0], uv1), ([0.0, 1.0], uv2)];
        flat_mesh(&points, vec![[0, 1, 2]])
    };
    let check = |mesh: &Mesh, method, x: f64, y: f64, w| {
        assert_all(mesh, &tangents(mesh, &as_to_v(method)), [x, y, 0.0, w], 2.0 * STEP);
    };
    let fifth = 0.2f64.sqrt();
    // e1 / 0.5 against (e1 y2 - e2 y1) / (x1 y2 - x2 y1) = (2, 0.75) / 0.5.
    let mesh = triangle([0.5, 0.25], [0.0, 1.0]);
    check(&mesh, TangentMethod::Hegde, 2.0 * fifth, fifth, 1.0);
    check(&mesh, TangentMethod::Lengyel, 2.0 / 4.5625f64.sqrt(), 0.75 / 4.5625f64.sqrt(), 1.0);
    // u falls along e1; v grows to the right of -e1.
    check(&triangle([-0.5, 0.25], [0.0, 1.0]), TangentMethod::Hegde, -2.0 * fifth, -fifth, -1.0);
    // u does not change along e1: e2, along which it grows or falls.
    check(&triangle([0.0, 1.0], [0.5, 0.25]), TangentMethod::Hegde, 0.0, 1.0, -1.0);
    check(&triangle([0.0, 1.0], [-0.5, 0.25]), TangentMethod::Hegde, 0.0, -1.0, 1.0);
}

/// The sum of listing 7.4 by hand: a roof of two triangles over the edge from (0, 0, 0) to (0, 1, 0), one flat and one
/// that rises at 45 degrees, with t of (1, 0, 0) and (1, 0, 1), and n upwards at the edge.
#[test]
fn a_sum_by_hand() {
    let positions = vec![[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]];
    let texcoords = vec![[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 0.0]];
    let mesh = Mesh::new(positions, texcoords, vec![[0, 1, 2], [1, 3, 2]]).expect("a mesh");
    // n is (-3/5, 0, 4/5): t = (2, 0, 1) - (-2/5) n = (2 - 6/25, 0, 1 + 8/25) = (44, 0, 33) / 25, or (4, 0, 3) / 5.
    let mesh = mesh.with_normals(vec![[-0.6, 0.0, 0.8]; 4]).expect("normals");
    let made = tangents(&mesh, &as_to_v(TangentMethod::Lengyel));
    for vertex in [1, 2] {
        let [x, y, z, w] = made.tangents[vertex].map(f64::from);
        assert!(
            (x - 0.8).abs() < 3.0 * STEP && y == 0.0 && (z - 0.6).abs() < 3.0 * STEP && w == 1.0,
            "{x} {y} {z} {w}"
        );
    }
}
