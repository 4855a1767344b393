//! Tangents of random meshes.

use super::*;
use crate::mesh::{CornerAdjacency, Mesh};
use crate::ops::tangents::{Faces, Fans, MissingNormals, Shading, Surface, TangentMethod, TangentPlan};

/// What random meshes are made of.
#[derive(Clone, Copy)]
struct Kind {
    vertices: usize,
    triangles: usize,
    /// Coordinates have this magnitude, or anything up to it.
    greatest: f32,
    /// Whether the magnitudes are spread over all exponents below the greatest.
    is_spread: bool,
    /// Whether all triangles meet at vertex 0.
    is_fan: bool,
}

/// From -1 to 1.
fn number(random: &mut SplitMix) -> f32 {
    (random.bits() >> 40) as f32 / (1 << 23) as f32 - 1.0
}

fn coordinate(random: &mut SplitMix, kind: Kind) -> f32 {
    let special = [0.0, -0.0, 1.0, -1.0, 2f32.powi(-22), f32::from_bits(1)];
    match random.bits() % 8 {
        0 => special[(random.bits() % 6) as usize] * kind.greatest.min(1.0),
        _ if kind.is_spread => number(random) * kind.greatest * 2f32.powi(-((random.bits() % 140) as i32)),
        _ => number(random) * kind.greatest,
    }
}

fn vector<const N: usize>(random: &mut SplitMix, kind: Kind) -> [f32; N] {
    std::array::from_fn(|_| coordinate(random, kind))
}

/// One triangle in eight has two equal vertices, one vertex in eight another's position or texture coordinate.
fn mesh(random: &mut SplitMix, kind: Kind) -> Mesh {
    let vertex = |random: &mut SplitMix| (random.bits() % kind.vertices as u64) as u32;
    let mut positions: Vec<[f32; 3]> = (0..kind.vertices).map(|_| vector(random, kind)).collect();
    let mut texcoords: Vec<[f32; 2]> = (0..kind.vertices).map(|_| vector(random, kind)).collect();
    let unit = Kind { greatest: 1.0, is_spread: false, ..kind };
    let normals = (0..kind.vertices).map(|_| vector(random, unit)).collect();
    for _ in 0..kind.vertices / 8 {
        positions[vertex(random) as usize] = positions[vertex(random) as usize];
        texcoords[vertex(random) as usize] = texcoords[vertex(random) as usize];
    }
    let triangle = |random: &mut SplitMix| {
        let [mut a, b, c] = [vertex(random), vertex(random), vertex(random)];
        if kind.is_fan {
            a = 0;
        }
        if random.bits().is_multiple_of(8) { [a, b, b] } else { [a, b, c] }
    };
    let triangles = (0..kind.triangles).map(|_| triangle(random)).collect();
    Mesh::new(positions, texcoords, triangles).unwrap().with_normals(normals).unwrap()
}

/// The bits of every fan's tangent.
fn tangents(backend: &dyn Backend, plan: &TangentPlan<'_>) -> Vec<[u32; 4]> {
    let mut tangents = vec![[f32::NAN; 4]; plan.fans.count()];
    backend.tangents(plan, &mut tangents).unwrap();
    tangents.iter().map(|tangent| tangent.map(f32::to_bits)).collect()
}

/// Holds each backend against the reference, for each method.
fn check(mesh: &Mesh, unwrap: bool) {
    let backends = [1, 2, 7].map(|threads| Cpu::with_threads(threads).unwrap());
    let shading = Shading::new(mesh, MissingNormals::Flat);
    let surface = Surface::new(mesh, &shading.normals, unwrap);
    let adjacency = CornerAdjacency::of(mesh);
    for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde] {
        let fans = match method {
            TangentMethod::Mikktspace => Fans::of_mikktspace(&surface),
            _ => Fans::by_handedness(&surface, &Faces::of(&surface), &adjacency),
        };
        for precision in [Precision::Exact, Precision::Fast] {
            let plan = TangentPlan { method, precision, surface: &surface, fans: &fans };
            let expected = tangents(&Reference, &plan);
            assert!(expected.iter().flatten().all(|bits| f32::from_bits(*bits).is_finite()), "{method}");
            for backend in &backends {
                assert!(tangents(backend, &plan) == expected, "{method} with {}", backend.device());
            }
        }
    }
}

#[test]
fn random_meshes_of_all_scales_have_the_bytes_of_the_reference() {
    let random = &mut SplitMix(4);
    for greatest in [f32::MAX, 1e38, 1e20, 1.0, 1e-20, 1e-38, 1e-44] {
        for is_spread in [false, true] {
            for [vertices, triangles] in [[1, 1], [4, 3], [50, 63], [50, 64], [700, 65], [4000, 6000]] {
                check(&mesh(random, Kind { vertices, triangles, greatest, is_spread, is_fan: false }), is_spread);
            }
        }
    }
}

#[test]
fn fans_of_any_length_have_the_bytes_of_the_reference() {
    let random = &mut SplitMix(5);
    for triangles in [0, 1, 2, 31, 1000] {
        let kind = Kind { vertices: 40, triangles, greatest: 3.0, is_spread: false, is_fan: true };
        check(&mesh(random, kind), false);
    }
}

/// A grid whose left half is mirrored, with vertices in common along the middle.
#[test]
fn mirrored_halves_have_the_bytes_of_the_reference() {
    const SIDE: u32 = 81;
    let (mut positions, mut texcoords, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for at in 0..SIDE * SIDE {
        let [x, y] = [(at % SIDE) as f32 - 40.0, (at / SIDE) as f32];
        positions.push([x, y, (x * 0.3).sin() + (y * 0.2).cos()]);
        texcoords.push([x.abs() / 40.0, y / 80.0]);
        normals.push([0.0, 0.0, 1.0]);
        if x < 40.0 && y < 80.0 {
            triangles.extend([[at, at + 1, at + SIDE], [at + 1, at + SIDE + 1, at + SIDE]]);
        }
    }
    let mesh = Mesh::new(positions, texcoords, triangles).unwrap().with_normals(normals).unwrap();
    let adjacency = CornerAdjacency::of(&mesh);
    let surface = Surface::new(&mesh, mesh.normals().unwrap(), false);
    assert_eq!(Fans::by_handedness(&surface, &Faces::of(&surface), &adjacency).count(), (SIDE * SIDE + SIDE) as usize);
    check(&mesh, false);
}
