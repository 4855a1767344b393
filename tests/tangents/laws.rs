//! What may change without changing the tangents.

use super::{METHODS, SUMS, by, tangents};
use crate::support::{
    Random, angle, assert_same_tangents, corner_tangents, direction, hills, mesh, mirrored_halves, torus,
};
use texbake::{Mesh, TangentMethod};

fn rebuilt(mesh_: &Mesh, triangles: Vec<[u32; 3]>) -> Mesh {
    let normals = mesh_.normals().expect("normals").to_vec();
    mesh(mesh_.positions().to_vec(), normals, mesh_.texcoords().to_vec(), triangles)
}

/// The differences are others, by a few roundings of each.
#[test]
fn the_first_corner_of_a_triangle_matters_by_rounding_only() {
    for original in [hills(9, 9, 21), torus(20, 12), mirrored_halves(6, 4)] {
        let rotated = rebuilt(&original, original.triangles().iter().map(|&[a, b, c]| [b, c, a]).collect());
        for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel] {
            let (made, turned) = (tangents(&original, &by(method)), tangents(&rotated, &by(method)));
            assert_eq!(turned.report, made.report, "{method}");
            let (all, turned) = (corner_tangents(&original, &made), corner_tangents(&rotated, &turned));
            for (corner, t) in all.iter().enumerate() {
                // Corner i of a triangle is corner i - 1 of the rotated one.
                let other = turned[corner / 3 * 3 + (corner + 2) % 3];
                let off = angle(direction(*t), direction(other));
                assert!(off < 1e-5 && t[3] == other[3], "{method}, corner {corner}: {t:?}, {other:?}");
            }
        }
    }
}

/// Sums run over triangles in order, so the order of vertices changes no bit.
#[test]
fn the_order_of_vertices_changes_nothing() {
    for original in [hills(9, 9, 22), mirrored_halves(6, 4)] {
        let vertices = original.positions().len();
        let mut random = Random::new(4);
        let mut order: Vec<u32> = (0..vertices as u32).collect();
        for i in (1..vertices).rev() {
            order.swap(i, random.below(i as u64 + 1) as usize);
        }
        // Vertex v of the original is vertex order[v] of the other.
        let (mut positions, mut normals, mut texcoords) =
            (vec![[0.0; 3]; vertices], vec![[0.0; 3]; vertices], vec![[0.0; 2]; vertices]);
        for (v, &to) in order.iter().enumerate() {
            positions[to as usize] = original.positions()[v];
            normals[to as usize] = original.normals().expect("normals")[v];
            texcoords[to as usize] = original.texcoords()[v];
        }
        let triangles = original.triangles().iter().map(|triangle| triangle.map(|v| order[v as usize])).collect();
        let permuted = mesh(positions, normals, texcoords, triangles);
        for method in METHODS {
            let (made, other) = (tangents(&original, &by(method)), tangents(&permuted, &by(method)));
            assert_same_tangents(method, &corner_tangents(&permuted, &other), &corner_tangents(&original, &made));
            assert_eq!(other.report, made.report, "{method}");
        }
    }
}

/// The order of triangles is the order of sums: rounding.
#[test]
fn the_order_of_triangles_matters_by_rounding_only() {
    let original = hills(9, 9, 23);
    let reversed = rebuilt(&original, original.triangles().iter().rev().copied().collect());
    for method in METHODS {
        let (made, other) = (tangents(&original, &by(method)), tangents(&reversed, &by(method)));
        for (a, b) in made.tangents.iter().zip(&other.tangents) {
            assert!(angle(direction(*a), direction(*b)) < 1e-6 && a[3] == b[3], "{method}: {a:?}, {b:?}");
        }
    }
}

/// Two of the same mesh in one have the tangents of one. It stands twice at the same place, so the scale stays.
#[test]
fn two_instances_are_twice_one() {
    for original in [hills(7, 7, 24), mirrored_halves(6, 4)] {
        let vertices = original.positions().len() as u32;
        let twice = |v: &[[f32; 3]]| [v, v].concat();
        let triangles = original.triangles().iter().copied();
        let shifted = triangles.clone().map(|triangle| triangle.map(|vertex| vertex + vertices));
        let both = mesh(
            twice(original.positions()),
            twice(original.normals().expect("normals")),
            [original.texcoords(), original.texcoords()].concat(),
            triangles.chain(shifted).collect(),
        );
        for method in SUMS {
            let (one, two) = (tangents(&original, &by(method)), tangents(&both, &by(method)));
            let one = corner_tangents(&original, &one);
            assert_same_tangents(method, &corner_tangents(&both, &two), &[one.clone(), one].concat());
        }
    }
}

/// Coordinates in 1/1024 below 1 that move by 2 stay exact, and the scale is another power of two.
#[test]
fn a_mesh_elsewhere_has_the_same_bits() {
    let snapped = |value: f32| (value * 1024.0).round() / 1024.0;
    let near = crate::support::changed(&hills(9, 9, 25), |p| p.map(snapped), |n| n, |uv| uv.map(snapped));
    let far =
        crate::support::changed(&near, |[x, y, z]| [x + 2.0, y - 64.0, z + 1.0], |n| n, |[u, v]| [u + 3.0, v - 2.0]);
    for method in METHODS {
        let (near_made, far_made) = (tangents(&near, &by(method)), tangents(&far, &by(method)));
        assert_same_tangents(method, &corner_tangents(&far, &far_made), &corner_tangents(&near, &near_made));
    }
}
