//! What every tangent is, whatever the mesh.
//!
//! A unit vector: `v (1 / sqrt(v.v))` has relative errors of 3u in v.v (u = 2^-24), half of which is left in the root,
//! u in the root, u in the inverse and u in the product: 4.5u, so |t|^2 is off by 9u.
//!
//! A right angle to n: `v - (n.v) n` with |v| = 1 is off by at most 3u |n| in n.v, u in the product and u in the
//! difference: 5u of at most 1, then n of a length that differs from 1 leaves |1 - n.n| |n.v|; both over the length p
//! of what is left, which the last unit vector adds 4.5u to. Lengyel and Hegde leave at least p = 2^-16; the test
//! meshes at least 1/16 except where the angle is counted.

use super::{METHODS, SUMS, as_to_v, by, tangents};
use crate::support::{corners, every_mesh, hills, mirrored_halves, without_normals};
use texbake::{Mesh, MissingNormals, TangentMethod, TangentOptions};

const U: f64 = 1.0 / (1 << 24) as f64;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[test]
fn every_tangent_is_a_unit_vector_with_a_sign() {
    for method in METHODS {
        for (name, mesh) in every_mesh() {
            for (vertex, &[x, y, z, w]) in tangents(&mesh, &by(method)).tangents.iter().enumerate() {
                let t = [x, y, z].map(f64::from);
                let off = (dot(t, t) - 1.0).abs();
                assert!(off <= 9.1 * U, "{name}, {method}, vertex {vertex}: |t|^2 of {t:?} is off by {off:e}");
                assert!(w == 1.0 || w == -1.0, "{name}, {method}, vertex {vertex}: w = {w}");
            }
        }
    }
}

#[test]
fn every_sum_is_at_a_right_angle_to_its_normal() {
    for method in SUMS {
        for (name, mesh) in every_mesh() {
            let made = tangents(&mesh, &by(method));
            let mut steep = 0;
            for corner in corners(&mesh, &made) {
                let [x, y, z, _] = corner.tangent;
                let n = corner.normal.map(f64::from);
                let off = dot([x, y, z].map(f64::from), n).abs();
                // Normals that are given as f32 have n.n within 4u of 1.
                let bound = |p: f64| 1.1 * (5.0 * U + 4.0 * U) / p + 4.5 * U;
                steep += usize::from(off > bound(1.0 / 16.0));
                assert!(off <= bound(2f64.powi(-16)), "{name}, {method}: {corner:?} is off by {off:e}");
            }
            let allowed = if name.contains("soup") { mesh.triangles().len() / 10 } else { 0 };
            assert!(steep <= allowed, "{name}, {method}: {steep} corners are not at a right angle");
        }
    }
}

#[test]
fn green_down_has_the_other_sign() {
    for method in METHODS {
        for (name, mesh) in every_mesh() {
            let (up, down) = (tangents(&mesh, &by(method)), tangents(&mesh, &as_to_v(method)));
            let negated: Vec<_> = up.tangents.iter().map(|&[x, y, z, w]| [x, y, z, -w]).collect();
            assert_eq!(down.tangents, negated, "{name}, {method}");
            assert_eq!((down.copies, down.triangles), (up.copies, up.triangles), "{name}, {method}");
            assert_eq!(down.report, up.report, "{name}, {method}");
        }
    }
}

/// FGED2 eq. 7.40, in f32: three roundings in each component of the cross product.
#[test]
fn bitangents_are_w_n_cross_t() {
    for missing_normals in [MissingNormals::Flat, MissingNormals::Smooth] {
        for mesh in [hills(6, 5, 9), without_normals(&hills(6, 5, 9)), mirrored_halves(4, 4)] {
            for method in METHODS {
                let made = tangents(&mesh, &TangentOptions { missing_normals, ..by(method) });
                let sources: Vec<u32> = made.sources().collect();
                let bitangents = made.bitangents(&mesh);
                assert_eq!((bitangents.len(), sources.len()), (made.tangents.len(), made.tangents.len()));
                for (vertex, b) in bitangents.iter().enumerate() {
                    let n = match &made.normals {
                        Some(normals) => normals[vertex],
                        None => mesh.normals().expect("normals")[sources[vertex] as usize],
                    };
                    let ([n0, n1, n2], [x, y, z, w]) = (n.map(f64::from), made.tangents[vertex].map(f64::from));
                    let cross = [n1 * z - n2 * y, n2 * x - n0 * z, n0 * y - n1 * x];
                    let off = (0..3).map(|axis| (f64::from(b[axis]) - w * cross[axis]).abs()).fold(0.0, f64::max);
                    assert!(off <= 3.0 * U, "vertex {vertex}: {b:?} is off by {off:e}");
                }
            }
        }
    }
}

#[test]
fn green_up_points_against_v() {
    // v grows against y: the bitangent of a plane is y.
    let plane = crate::support::plane(2, 2);
    let made = tangents(&plane, &by(TangentMethod::Lengyel));
    assert!(made.bitangents(&plane).iter().all(|b| *b == [0.0, made.tangents[0][0], 0.0]), "{made:?}");
}

#[test]
fn the_sign_in_the_lowest_bit_is_read_back() {
    for (name, mesh) in every_mesh() {
        let made = tangents(&mesh, &by(TangentMethod::Lengyel));
        let packed = made.with_sign_in_lowest_bit();
        assert_eq!(packed.len(), made.tangents.len(), "{name}");
        for (&[px, py, pz], &[x, y, z, w]) in packed.iter().zip(&made.tangents) {
            assert_eq!(if px.to_bits() & 1 == 1 { -1.0 } else { 1.0 }, w, "{name}");
            assert_eq!((px.to_bits() >> 1, py.to_bits(), pz.to_bits()), (x.to_bits() >> 1, y.to_bits(), z.to_bits()));
        }
    }
    let both = tangents(&mirrored_halves(4, 2), &by(TangentMethod::Lengyel));
    let odd = both.with_sign_in_lowest_bit().iter().filter(|t| t[0].to_bits() & 1 == 1).count();
    assert_eq!(odd, both.tangents.iter().filter(|t| t[3] < 0.0).count());
    assert!(odd > 0 && odd < both.tangents.len());
}

/// The first vertices are the mesh's own, every corner has its own vertex or a copy of it, and none is there twice.
#[test]
fn vertices_are_the_meshs_own_and_then_copies() {
    for method in METHODS {
        for (name, mesh) in every_mesh() {
            let made = tangents(&mesh, &by(method));
            let own = mesh.positions().len();
            assert_eq!(made.tangents.len(), own + made.copies.len(), "{name}, {method}");
            assert_eq!((made.report.copies, made.report.vertices), (made.copies.len(), own), "{name}, {method}");
            assert_eq!(made.triangles.is_none(), made.copies.is_empty(), "{name}, {method}");
            assert!(made.normals.as_ref().is_none_or(|normals| normals.len() == made.tangents.len()));
            check_corners(name, &mesh, &corners(&mesh, &made));
        }
    }
}

fn check_corners(name: &str, mesh: &Mesh, corners: &[crate::support::Corner]) {
    let indices = mesh.triangles().as_flattened();
    assert_eq!(corners.len(), indices.len(), "{name}");
    for (corner, &vertex) in corners.iter().zip(indices) {
        assert_eq!(corner.source, vertex, "{name}");
    }
}
