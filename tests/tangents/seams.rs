//! Welding seams (FGED2, end of section 7.5): duplicates at one position whose frames nearly agree.

use super::{SUMS, by, tangents};
use crate::support::{angle, direction, mesh};
use texbake::{Mesh, TangentMethod, TangentOptions, Tangents};

/// Separate triangles around the origin in the plane z = 0, of vertices 3i, whose u grows at these angles in degrees;
/// a mirrored one has v to the right of it.
fn triangles_at(degrees: &[f64], mirrored: &[bool], normals: &[[f32; 3]]) -> Mesh {
    let (mut positions, mut texcoords, mut all_normals) = (Vec::new(), Vec::new(), Vec::new());
    for (i, (angle, is_mirrored)) in degrees.iter().zip(mirrored).enumerate() {
        let (sin, cos) = angle.to_radians().sin_cos();
        let v = if *is_mirrored { 1.0 } else { -1.0 };
        for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
            // (u, v) of a point: its part along the angle, and against or along that a quarter further.
            let (along, across) = (x * cos + y * sin, -x * sin + y * cos);
            // Only the origin is shared.
            positions.push([x as f32 * (1.0 + i as f32), y as f32 * (1.0 + i as f32), 0.0]);
            texcoords.push([along as f32, (v * across) as f32]);
            all_normals.push(normals[i]);
        }
    }
    let triangles = (0..degrees.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(positions, all_normals, texcoords, triangles)
}

const UP: [f32; 3] = [0.0, 0.0, 1.0];

fn welded(mesh: &Mesh, degrees: f32) -> Tangents {
    tangents(mesh, &TangentOptions { weld_seams: Some(degrees), ..by(TangentMethod::Lengyel) })
}

fn degrees_of(made: &Tangents, vertex: usize) -> f64 {
    let [x, y, _, _] = made.tangents[vertex].map(f64::from);
    y.atan2(x).to_degrees()
}

#[test]
fn tangents_just_within_the_angle_become_one() {
    for apart in [0.01, 0.1, 1.0, 20.0, 60.0, 89.0] {
        let mesh = triangles_at(&[10.0, 10.0 + apart], &[false; 2], &[UP; 2]);
        let apart_f32 = apart as f32;
        // f32 directions are off by about 1e-5 degrees.
        let above = welded(&mesh, apart_f32 + 1e-4);
        assert_eq!(above.report.welded, 2, "{apart}");
        assert_eq!(above.tangents[0].map(f32::to_bits), above.tangents[3].map(f32::to_bits), "{apart}");
        assert!((degrees_of(&above, 0) - (10.0 + apart / 2.0)).abs() < 2e-5, "{apart}: {}", degrees_of(&above, 0));
        // The ends of the triangles are elsewhere.
        assert!((degrees_of(&above, 1) - 10.0).abs() < 2e-5 && (degrees_of(&above, 4) - 10.0 - apart).abs() < 2e-5);

        let below = welded(&mesh, apart_f32 - 1e-4);
        assert_eq!(below.report.welded, 0, "{apart}");
        assert_eq!(below.tangents, tangents(&mesh, &by(TangentMethod::Lengyel)).tangents);
    }
}

#[test]
fn never_across_handedness_nor_across_an_edge() {
    let same = triangles_at(&[10.0, 12.0], &[false, false], &[UP; 2]);
    assert_eq!(welded(&same, 10.0).report.welded, 2);
    let mirrored = triangles_at(&[10.0, 12.0], &[false, true], &[UP; 2]);
    let made = welded(&mirrored, 90.0);
    assert_eq!((made.report.welded, made.tangents[0][3], made.tangents[3][3]), (0, 1.0, -1.0));
    let tilted = triangles_at(&[10.0, 12.0], &[false, false], &[UP, [0.0, 0.6, 0.8]]);
    // The normals are 36.87 degrees apart.
    assert_eq!(welded(&tilted, 36.0).report.welded, 0);
    assert_eq!(welded(&tilted, 38.0).report.welded, 2);
}

/// 0, 30 and 60 degrees within 40: the first takes the second; the third is alone.
#[test]
fn the_first_decides_who_is_near() {
    let mesh = triangles_at(&[0.0, 30.0, 60.0], &[false; 3], &[UP; 3]);
    let made = welded(&mesh, 40.0);
    assert_eq!(made.report.welded, 2);
    for (vertex, expected) in [(0, 15.0), (3, 15.0), (6, 60.0)] {
        assert!((degrees_of(&made, vertex) - expected).abs() < 2e-5, "vertex {vertex}: {}", degrees_of(&made, vertex));
    }
    let all = welded(&mesh, 61.0);
    let changed =
        (0..9).filter(|&v| all.tangents[v] != tangents(&mesh, &by(TangentMethod::Lengyel)).tangents[v]).count();
    assert_eq!(all.report.welded, changed, "the middle one may have the average already");
    assert_eq!([all.tangents[3], all.tangents[6]], [all.tangents[0]; 2]);
    assert!((degrees_of(&all, 0) - 30.0).abs() < 2e-5, "{}", degrees_of(&all, 0));
}

#[test]
fn the_two_sides_of_a_seam_are_one_afterwards() {
    let mesh = crate::support::changed(
        &crate::support::torus(24, 16),
        // One position for both sides of the seam.
        |p| p.map(|part| (part * 4096.0).round() / 4096.0),
        |n| n.map(|part| (part * 4096.0).round() / 4096.0),
        |uv| uv,
    );
    for method in SUMS {
        let apart = tangents(&mesh, &by(method));
        let options = TangentOptions { weld_seams: Some(30.0), ..by(method) };
        let made = tangents(&mesh, &options);
        let mut shared = 0;
        for a in 0..mesh.positions().len() {
            for b in a + 1..mesh.positions().len() {
                let is_same = |v: &[[f32; 3]]| v[a].map(|x| x + 0.0) == v[b].map(|x| x + 0.0);
                if is_same(mesh.positions()) && is_same(mesh.normals().expect("normals")) {
                    shared += 1;
                    assert_eq!(made.tangents[a], made.tangents[b], "{method}: {a}, {b}");
                    let off = angle(direction(apart.tangents[a]), direction(apart.tangents[b]));
                    assert!(off < 30f64.to_radians(), "{method}: {off}");
                }
            }
        }
        // 17 pairs along one seam and 25 along the other, whose four corners are six pairs instead of 2 + 2.
        assert_eq!(shared, 17 - 2 + 25 - 2 + 6, "{method}");
        let changed = made.tangents.iter().zip(&apart.tangents).filter(|(a, b)| a != b).count();
        assert_eq!(made.report.welded, changed, "{method}");
        assert!(changed > 0);
    }
}
