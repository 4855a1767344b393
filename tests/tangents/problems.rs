//! Hegde's mapping problems and the others, each on a mesh made for it: what the report counts, and that the result is
//! what geometry says.

use super::{METHODS, SUMS, as_to_v, assert_all, by, nothing_found, tangents};
use crate::support::{
    angle, assert_same_tangents, changed, corner_tangents, corners, cylinder, cylinder_with_a_jump,
    degenerate_triangles, direction, flat_mesh, hills, mesh, mirrored_halves, plane, pole, sphere, star,
    without_normals,
};
use std::f64::consts::TAU;
use texbake::{Mesh, MissingNormals, TangentMethod, TangentOptions, TangentReport};

const STEP: f64 = 1.0 / (1 << 23) as f64;

/// A plane of 2 x 1 squares, u 0, 1, 0 along x: the two vertices in the middle, 1 and 4, have both handednesses.
#[test]
fn vertices_between_mirrored_halves_are_split() {
    let positions = (0..6).map(|i| [(i % 3) as f32, (i / 3) as f32, 0.0]).collect();
    let texcoords = (0..6).map(|i| [(i % 3 % 2) as f32, 1.0 - (i / 3) as f32]).collect();
    let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let mesh = mesh(positions, vec![[0.0, 0.0, 1.0]; 6], texcoords, triangles);
    for method in METHODS {
        let made = tangents(&mesh, &by(method));
        assert_eq!(made.report, TangentReport { copies: 2, mirrored: 2, ..nothing_found(&mesh) }, "{method}");
        let mut copies = made.copies.clone();
        copies.sort();
        assert_eq!(copies, [1, 4], "{method}");
        // The left half keeps its vertices: it comes first.
        let triangles = made.triangles.as_ref().expect("copies are used");
        assert_eq!(triangles[..2], mesh.triangles()[..2], "{method}");
        let got = corners(&mesh, &made);
        for (corner, got) in got.iter().enumerate() {
            assert_eq!(got.source, mesh.triangles().as_flattened()[corner]);
            let side = if corner < 6 { 1.0 } else { -1.0 };
            let [x, y, z, w] = got.tangent;
            if method != TangentMethod::Hegde {
                assert!((f64::from(side * x) - 1.0).abs() <= STEP && y == 0.0, "{method}: {got:?}");
            }
            assert!(side * x > 0.7 && z == 0.0 && w == side, "{method}: {got:?}");
        }
    }
}

#[test]
fn mirrored_halves_are_mirrored() {
    let mesh = mirrored_halves(8, 5);
    for method in SUMS {
        let made = tangents(&mesh, &by(method));
        // Six vertices in the middle column.
        assert_eq!((made.report.mirrored, made.report.copies), (6, 6), "{method}");
        assert_eq!(made.report.undirected, 0);
        for copy in &made.copies {
            assert_eq!(mesh.positions()[*copy as usize][0], 0.5);
        }
        for (corner, got) in corners(&mesh, &made).iter().enumerate() {
            let [a, b, c] = mesh.triangles()[corner / 3].map(|vertex| mesh.positions()[vertex as usize][0]);
            let side = if a + b + c < 1.5 { 1.0 } else { -1.0 };
            assert!(got.tangent[3] == side && side * got.tangent[0] > 0.5, "{method}: {got:?}");
        }
    }
}

/// v from the bottom to the top: nothing is split, only the sign differs.
#[test]
fn upside_down_mapping_has_the_other_sign() {
    for mesh in [plane(4, 4), hills(7, 6, 3)] {
        let upside_down = changed(&mesh, |p| p, |n| n, |[u, v]| [u, 1.0 - v]);
        for method in METHODS {
            let (up, down) = (tangents(&mesh, &by(method)), tangents(&upside_down, &by(method)));
            assert_eq!(down.report, nothing_found(&mesh), "{method}");
            for (up, down) in up.tangents.iter().zip(&down.tangents) {
                assert_eq!((up[3], down[3]), (1.0, -1.0), "{method}");
                // 1 - v is rounded, by up to 2^-25 of differences of at least 1/10.
                assert!(angle(direction(*up), direction(*down)) < 2e-5, "{method}: {up:?} {down:?}");
            }
        }
    }
}

/// 16 around, so u + 1 is exact. Of each of the 3 rows, the 2 triangles of the last column jump.
#[test]
fn unwrapping_is_the_same_as_vertices_at_the_seam() {
    let (jumping, proper) = (cylinder_with_a_jump(16, 3), cylinder(16, 3));
    // The seam's two halves as one vertex: the sums of the one cylinder, the vertices of the other.
    let u = |at: u32| proper.texcoords()[at as usize][0];
    for method in [TangentMethod::Lengyel, TangentMethod::Mikktspace] {
        let unwrapped = tangents(&jumping, &TangentOptions { unwrap: true, ..by(method) });
        assert_eq!(unwrapped.report, TangentReport { jumps: 6, ..nothing_found(&jumping) }, "{method}");
        let seamed = tangents(&proper, &by(method));
        for (got, expected) in corners(&jumping, &unwrapped).iter().zip(corners(&proper, &seamed)) {
            let is_at_seam = [0.0, 1.0].contains(&u(expected.source));
            let off = angle(direction(got.tangent), direction(expected.tangent));
            assert!(off < if is_at_seam { 1e-6 } else { 3e-7 }, "{method}: {got:?} and {expected:?}");
            assert_eq!(got.tangent[3], 1.0);
        }
    }
    // Without: the last column's u falls from 15/16 to 0, so it is mirrored, and both of its sides are split.
    for method in SUMS {
        let torn = tangents(&jumping, &by(method));
        assert_eq!(
            torn.report,
            TangentReport { jumps: 6, mirrored: 8, copies: 8, ..nothing_found(&jumping) },
            "{method}"
        );
    }
    // Where nothing jumps, nothing changes.
    for method in METHODS {
        let options = TangentOptions { unwrap: true, ..by(method) };
        assert_eq!(tangents(&proper, &options), tangents(&proper, &by(method)), "{method}");
    }
}

/// u runs .9375, 0, .5: whichever corner comes first, the second one counts as 1.
#[test]
fn unwrapping_does_not_depend_on_the_first_corner() {
    let positions = vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let texcoords = |second: f32| vec![[0.9375, 0.0], [second, 0.25], [0.5, 0.5]];
    let flat = |second, triangle| Mesh::new(positions.clone(), texcoords(second), vec![triangle]).unwrap();
    let flat = |second, triangle| flat(second, triangle).with_normals(vec![[0.0, 0.0, 1.0]; 3]).unwrap();
    for method in [TangentMethod::Lengyel, TangentMethod::Mikktspace] {
        for triangle in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            let unwrapped = tangents(&flat(0.0, triangle), &TangentOptions { unwrap: true, ..by(method) });
            assert_eq!(unwrapped.report.jumps, 1);
            assert_eq!(unwrapped.tangents, tangents(&flat(1.0, triangle), &by(method)).tangents, "{method}");
        }
    }
}

/// A triangle that would have no area left, and one that spans more than the whole texture, stay as they are.
#[test]
fn what_cannot_have_jumped_is_not_unwrapped() {
    for method in [TangentMethod::Lengyel, TangentMethod::Mikktspace] {
        for (repeats, jumps) in [(1.0, 2), (3.0, 0)] {
            let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
            let texcoords = vec![[0.0, repeats], [repeats, repeats], [repeats, 0.0], [0.0, 0.0]];
            let square = Mesh::new(square, texcoords, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
            let square = square.with_normals(vec![[0.0, 0.0, 1.0]; 4]).unwrap();
            let unwrapped = tangents(&square, &TangentOptions { unwrap: true, ..by(method) });
            assert_eq!(unwrapped.report, TangentReport { jumps, ..nothing_found(&square) }, "{method}");
            assert_eq!(unwrapped.tangents, [[1.0, 0.0, 0.0, 1.0]; 4], "{method}");
        }
    }
}

/// All tangents around the middle point away from it. MikkTSpace joins only triangles that share an edge: each keeps
/// its own.
#[test]
fn a_pole_gets_some_tangent() {
    let mesh = pole(16);
    for method in SUMS {
        let made = tangents(&mesh, &by(method));
        assert_eq!(made.report, TangentReport { undirected: 1, ..nothing_found(&mesh) }, "{method}");
        let [x, y, z, w] = made.tangents[0];
        assert!(z == 0.0 && (x, y) != (0.0, 0.0) && w.abs() == 1.0, "{method}: {:?}", made.tangents[0]);
    }
    let made = tangents(&mesh, &by(TangentMethod::Mikktspace));
    assert_eq!(made.report, TangentReport { copies: 15, ..nothing_found(&mesh) });
    assert_eq!(made.copies, [0; 15]);
}

/// The sphere's poles are rows of vertices with one triangle each that has an area; the other one has none in space,
/// but a t.
#[test]
fn a_spheres_poles_keep_their_direction() {
    let mesh = sphere(16, 8, 90.0);
    for method in METHODS {
        let made = tangents(&mesh, &by(method));
        assert!(made.tangents.iter().flatten().all(|part| part.is_finite()), "{method}");
        let away = corners(&mesh, &made).into_iter().filter(|c| c.normal[2].abs() < 0.9);
        for corner in away {
            assert_eq!(corner.tangent[3], 1.0, "{method}: {corner:?}");
            if method != TangentMethod::Hegde {
                let [x, y, _] = corner.normal.map(f64::from);
                assert!(angle(direction(corner.tangent), [-y, x, 0.0]) < 0.25, "{method}: {corner:?}");
            }
        }
    }
}

#[test]
fn triangles_without_area_are_counted_and_their_vertices_get_some_tangent() {
    let mesh = degenerate_triangles();
    for method in METHODS {
        let made = tangents(&mesh, &by(method));
        let report = made.report;
        assert_eq!((report.without_area, report.without_texture_area, report.unused), (2, 2, 1), "{method}");
        assert_eq!((report.mirrored, report.copies, report.jumps), (0, 0, nothing_found(&mesh).jumps), "{method}");
        // Lengyel: the triangle along a line has t along it. The three others leave 3 vertices each.
        if method == TangentMethod::Lengyel {
            assert_eq!(report.undirected, 9);
        }
        if method == TangentMethod::Hegde {
            assert_eq!(report.undirected, 12);
        }
        for (vertex, &[x, y, z, w]) in made.tangents.iter().enumerate() {
            let length = (f64::from(x).powi(2) + f64::from(y).powi(2)).sqrt();
            assert!((length - 1.0).abs() < 2.0 * STEP && z == 0.0 && w.abs() == 1.0, "{method}, vertex {vertex}");
        }
    }
}

/// Triangles that share vertices with whole ones change nothing there.
#[test]
fn degenerate_neighbours_change_nothing() {
    let whole = hills(5, 5, 14);
    let mut triangles = whole.triangles().to_vec();
    triangles.extend([[0, 0, 1], [7, 8, 7], [3, 3, 3]]);
    let positions = whole.positions().to_vec();
    let more = mesh(positions, whole.normals().expect("normals").to_vec(), whole.texcoords().to_vec(), triangles);
    for method in METHODS {
        let (made, expected) = (tangents(&more, &by(method)), tangents(&whole, &by(method)));
        let corners = whole.triangles().len() * 3;
        let got = &corner_tangents(&more, &made)[..corners];
        assert_same_tangents(method, got, &corner_tangents(&whole, &expected));
        // Without area in space, and in texture too, for their corners have equal coordinates.
        assert_eq!((made.report.without_area, made.report.without_texture_area), (3, 3), "{method}");
    }
}

#[test]
fn vertices_without_triangles_get_some_tangent() {
    let normals = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8]];
    let mesh = mesh(vec![[1.0; 3]; 4], normals.clone(), vec![[0.5; 2]; 4], vec![]);
    for method in METHODS {
        let made = tangents(&mesh, &by(method));
        assert_eq!(made.report, TangentReport { unused: 4, ..nothing_found(&mesh) }, "{method}");
        for (n, t) in normals.iter().zip(&made.tangents) {
            let dot: f64 = (0..3).map(|axis| f64::from(n[axis]) * f64::from(t[axis])).sum();
            assert!(dot.abs() < 1e-7 && t[3] == 1.0, "{method}: {t:?}");
        }
    }
    for method in METHODS {
        let nothing = tangents(&flat_mesh(&[], vec![]), &by(method));
        assert_eq!((nothing.tangents.len(), nothing.report), (0, TangentReport::default()), "{method}");
        assert!(nothing.bitangents(&flat_mesh(&[], vec![])).unwrap().is_empty());
    }
}

/// A tent: two sides of 45 degrees, which share an edge along y.
fn tent() -> Mesh {
    let positions =
        vec![[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    let texcoords = positions.iter().map(|&[x, y, _]: &[f32; 3]| [x, -y]).collect();
    Mesh::new(positions, texcoords, vec![[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]).expect("a mesh")
}

#[test]
fn missing_normals_are_flat() {
    let mesh = tent();
    for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel] {
        let made = tangents(&mesh, &by(method));
        // Both vertices of the ridge are split.
        assert_eq!(made.report, TangentReport { copies: 2, normals_made: 6, ..nothing_found(&mesh) }, "{method}");
        assert_eq!(made.copies, [1, 2], "{method}");
        let half = 0.5f64.sqrt();
        for (corner, got) in corners(&mesh, &made).iter().enumerate() {
            let side = if corner < 6 { 1.0 } else { -1.0 };
            for (got, expected) in got.normal.iter().zip([-side * half, 0.0, half]) {
                assert!((f64::from(*got) - expected).abs() < STEP, "{method}, corner {corner}: {got:?}");
            }
            for (got, expected) in got.tangent.iter().zip([half, 0.0, side * half, 1.0]) {
                assert!((f64::from(*got) - expected).abs() < STEP, "{method}, corner {corner}: {got:?}");
            }
        }
    }
}

#[test]
fn missing_normals_are_smooth() {
    let mesh = tent();
    for method in [TangentMethod::Mikktspace, TangentMethod::Lengyel] {
        let made = tangents(&mesh, &TangentOptions { missing_normals: MissingNormals::Smooth, ..by(method) });
        assert_eq!(made.report, TangentReport { normals_made: 6, ..nothing_found(&mesh) }, "{method}");
        let normals = made.normals.expect("made");
        let half = 0.5f64.sqrt();
        // The ridge at vertex 1 has one triangle on the left, and two on the right; at vertex 2 it is mirrored.
        let (left, right) = ([-half, 0.0, half], [half, 0.0, half]);
        let third = |side: f64| [side * 0.1f64.sqrt(), 0.0, 0.9f64.sqrt()];
        for (vertex, expected) in [left, third(1.0), third(-1.0), left, right, right].into_iter().enumerate() {
            let got = normals[vertex].map(f64::from);
            assert!(angle(got, expected) < 3e-7, "vertex {vertex}: got {got:?}, expected {expected:?}");
            let t = direction(made.tangents[vertex]);
            assert!(angle(t, [expected[2], 0.0, -expected[0]]) < 1e-6, "{method}, vertex {vertex}: {t:?}");
        }
    }
}

/// Duplicates at a seam, at (1, 0) and (1, -0), have one smooth normal, the same as all around. The flat normals beside
/// a vertex are half a column away on either side: those of three triangles each in the middle row; of two and of one
/// in the first, and the other way round in the last.
#[test]
fn smooth_normals_have_no_seam() {
    let mesh = without_normals(&cylinder(16, 2));
    let mesh = changed(&mesh, |p| p.map(|part| if part.abs() < 1e-6 { 0.0 * part } else { part }), |n| n, |uv| uv);
    let options = TangentOptions { missing_normals: MissingNormals::Smooth, ..by(TangentMethod::Lengyel) };
    let normals = tangents(&mesh, &options).normals.expect("made");
    let column = TAU / 16.0;
    let turned = ((column / 2.0).tan() / 3.0).atan();
    for (row, turned) in [turned, 0.0, -turned].into_iter().enumerate() {
        let [first, last] = [17 * row, 17 * row + 16];
        assert_eq!(mesh.positions()[first], mesh.positions()[last]);
        assert_ne!(mesh.positions()[first][1].to_bits(), mesh.positions()[last][1].to_bits(), "0 and -0");
        assert_eq!(normals[first].map(f32::to_bits), normals[last].map(f32::to_bits), "row {row}");
        for (at, normal) in normals[first..=last].iter().enumerate() {
            let (sin, cos) = (column * at as f64 + turned).sin_cos();
            // Chords of 0.39 between positions that are off by 2^-25, and a few roundings.
            let off = angle(normal.map(f64::from), [cos, sin, 0.0]);
            assert!(off < 1e-6, "row {row}, column {at}: {normal:?} is off by {off:e}");
        }
    }
}

/// A triangle in the plane z = 0 with t = (1, 0, 0), and normals (sin, 0, cos) L with L off 1 by a hundredth at most.
/// Lengyel and Hegde normalise them. MikkTSpace takes them as they are: t - (n.t) n leaves n (1 - L^2) of n's part of t,
/// 2% of it, over the length that is left.
#[test]
fn normals_that_are_slightly_off_unit_leave_a_right_angle_slightly_off() {
    let points = [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [1.0, 1.0]), ([0.0, 1.0], [0.0, 0.0])];
    let flat = flat_mesh(&points, vec![[0, 1, 2]]);
    let mut greatest = 0.0f64;
    for length in [0.9901, 0.995, 1.0, 1.005, 1.0099] {
        for degrees in [0.0, 10.0, 45.0, 60.0, 80.0f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let n = [(length * sin) as f32, 0.0, (length * cos) as f32];
            let mesh = changed(&flat, |p| p, |_| n, |uv| uv);
            for method in METHODS {
                let length = if method == TangentMethod::Mikktspace { length } else { 1.0 };
                let left = [1.0 - length * length * sin * sin, 0.0, -length * length * sin * cos];
                let rest = left[0].hypot(left[2]);
                let bound = if length == 1.0 { 0.0 } else { 0.0201 * 1.01 * sin / rest };
                let made = tangents(&mesh, &by(method));
                assert_eq!(made.report, nothing_found(&mesh), "{method}");
                for &tangent in &made.tangents {
                    let what = format!("{method}, {length} at {degrees} degrees: {tangent:?}");
                    // Five roundings of at most 1, over what is left.
                    let off = angle(direction(tangent), left);
                    assert!(off < 5.0 * 0.5 * STEP / rest + 5.0 * STEP, "{what} is off {left:?} by {off:e}");
                    let dot = direction(tangent)[0] * sin + direction(tangent)[2] * cos;
                    assert!(dot.abs() <= bound + 5.0 * STEP / rest, "{what}: {dot} is above {bound}");
                    greatest = greatest.max(dot.abs());
                }
            }
            // Further off, they become unit vectors.
            let further = changed(&flat, |p| p, |_| n.map(|part| 1.03 * part), |uv| uv);
            for method in METHODS {
                let made = tangents(&further, &by(method));
                assert_eq!(made.report.normals_normalised, 3, "{method}");
                for &tangent in &made.tangents {
                    let off = angle(direction(tangent), [cos, 0.0, -sin]);
                    assert!(off < 10.0 * STEP / cos, "{method}, {length} at {degrees} degrees: {tangent:?}");
                }
            }
        }
    }
    // The bound is near: 0.02 tan(80 degrees) is 0.11.
    assert!(greatest > 0.1, "{greatest}");
}

#[test]
fn zero_normals_are_made_and_long_ones_normalised() {
    let proper = hills(6, 6, 15);
    let set = |normal: &dyn Fn(usize, [f32; 3]) -> [f32; 3]| {
        let normals = proper.normals().expect("normals").iter().enumerate();
        without_normals(&proper).with_normals(normals.map(|(i, &n)| normal(i, n)).collect()).expect("normals")
    };
    let with_zero = set(&|i, n| if i == 24 { [0.0, -0.0, 0.0] } else { n });
    for method in METHODS {
        let expected = tangents(&proper, &by(method));
        let made = tangents(&with_zero, &by(method));
        assert_eq!(made.report, TangentReport { normals_made: 1, ..nothing_found(&proper) }, "{method}");
        let normals = made.normals.expect("one was made");
        // Area-weighted, on a hill of 6 x 6 squares: near the true one.
        let (got, given) = (normals[24].map(f64::from), proper.normals().expect("normals")[24].map(f64::from));
        assert!(angle(got, given) < 0.1 && normals[23] == proper.normals().expect("normals")[23]);

        // By a power of two, the bits are the same but for the normalisation.
        for factor in [3.0, 0.25, 1e-30, 1e30, 3e37, 1e-44 / 2.0, 2f32.powi(127)] {
            let long = set(&|_, n| n.map(|part| factor * part));
            let made = tangents(&long, &by(method));
            let report = TangentReport { normals_normalised: 49, ..nothing_found(&proper) };
            assert_eq!(made.report, report, "{method}, {factor}");
            // Subnormals have few bits: the normal itself is off.
            if factor > 1e-37 {
                for (got, expected) in made.tangents.iter().zip(&expected.tangents) {
                    assert!(angle(direction(*got), direction(*expected)) < 1e-6, "{method}, {factor}");
                    assert_eq!(got[3], expected[3]);
                }
            } else {
                assert!(made.tangents.iter().flatten().all(|part| part.is_finite()), "{method}, {factor}");
            }
        }
        // Off by less than a hundredth: as they are.
        let slightly = set(&|_, n| n.map(|part| 1.007 * part));
        assert_eq!(tangents(&slightly, &by(method)).report, nothing_found(&proper), "{method}");
    }
}

#[test]
fn powers_of_two_change_no_bit() {
    let mesh = hills(9, 9, 16);
    for method in METHODS {
        let expected = tangents(&mesh, &by(method));
        for (p, t) in [(66, 0), (-66, 0), (0, 66), (0, -66), (66, -66), (-66, 66), (100, 90), (-100, -90)] {
            let scaled = changed(&mesh, |v| v.map(|x| x * 2f32.powi(p)), |n| n, |v| v.map(|x| x * 2f32.powi(t)));
            assert_eq!(tangents(&scaled, &by(method)), expected, "{method}, 2^{p}, 2^{t}");
        }
    }
}

/// The products are rounded, by 2^-24 of coordinates up to 9 times as large as the differences, a few times.
#[test]
fn powers_of_ten_change_next_to_nothing() {
    let mesh = hills(9, 9, 16);
    for method in METHODS {
        let expected = tangents(&mesh, &by(method));
        for (p, t) in
            [(1e20f32, 1.0f32), (1e-20, 1.0), (1.0, 1e20), (1.0, 1e-20), (1e20, 1e-20), (1e-20, 1e20), (1e35, 1e35)]
        {
            let scaled = changed(&mesh, |v| v.map(|x| x * p), |n| n, |v| v.map(|x| x * t));
            let made = tangents(&scaled, &by(method));
            assert_eq!(made.report, expected.report, "{method}, {p}, {t}");
            for (got, expected) in made.tangents.iter().zip(&expected.tangents) {
                let off = angle(direction(*got), direction(*expected));
                assert!(off < 1e-5 && got[3] == expected[3], "{method}, {p}, {t}: {off:e}");
            }
        }
    }
}

/// The greatest and the least of everything: nothing overflows.
#[test]
fn extremes_stay_finite() {
    let max = f32::MAX;
    let least = f32::from_bits(1);
    let values = [0.0, -0.0, max, -max, least, -least, 1.0, -1.0, f32::MIN_POSITIVE, 1e-20, 1e20];
    let mut random = crate::support::Random::new(0x7a6e);
    for _ in 0..20 {
        let mut value = || values[random.below(values.len() as u64) as usize];
        let positions = (0..40).map(|_| [value(), value(), value()]).collect();
        let normals = (0..40).map(|_| [value(), value(), value()]).collect();
        let texcoords = (0..40).map(|_| [value(), value()]).collect();
        let triangles = (0..100).map(|_| [0; 3].map(|_| random.below(40) as u32)).collect();
        let mesh = mesh(positions, normals, texcoords, triangles);
        for method in METHODS {
            for missing_normals in [MissingNormals::Flat, MissingNormals::Smooth] {
                let options = TangentOptions { missing_normals, weld_seams: Some(30.0), unwrap: true, ..by(method) };
                for mesh in [&mesh, &without_normals(&mesh)] {
                    let made = tangents(mesh, &options);
                    for &[x, y, z, w] in &made.tangents {
                        let length = [x, y, z].map(|part| f64::from(part).powi(2)).iter().sum::<f64>();
                        assert!((length - 1.0).abs() < 1e-6 && w.abs() == 1.0, "{method}: {:?}", [x, y, z, w]);
                    }
                }
            }
        }
    }
}

/// Texture coordinates that differ by little in one direction, and by much in the other, give the longest t.
#[test]
fn the_longest_tangents_do_not_overflow() {
    for exponent in [-20, -30, -39, -40, -41, -50, -59, -60, -61, -70] {
        let little = 2f32.powi(exponent);
        let positions = vec![[-1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0]];
        let texcoords = vec![[0.0, 0.0], [little, 1.0], [0.0, little]];
        let mesh = mesh(positions, vec![[0.0, 0.0, 1.0]; 3], texcoords, vec![[0, 1, 2]; 200]);
        for method in METHODS {
            let made = tangents(&mesh, &by(method));
            for &[x, y, z, w] in &made.tangents {
                let length = [x, y, z].map(|part| f64::from(part).powi(2)).iter().sum::<f64>();
                assert!((length - 1.0).abs() < 1e-6 && w.abs() == 1.0, "{method}, 2^{exponent}: {:?}", [x, y, z, w]);
            }
        }
    }
}

#[test]
fn one_triangle_has_one_tangent() {
    let triangle =
        flat_mesh(&[([0.0, 0.0], [0.0, 1.0]), ([2.0, 0.0], [1.0, 1.0]), ([0.0, 1.0], [0.0, 0.0])], vec![[0, 1, 2]]);
    for method in METHODS {
        let made = tangents(&triangle, &by(method));
        assert_all(&triangle, &made, [1.0, 0.0, 0.0, 1.0], STEP);
        assert_eq!(made.report, nothing_found(&triangle));
    }
}

/// A vertex of a hundred thousand triangles. Each has its t along x but for rounding: of coordinates, by 2^-25 over a
/// sine of 0.86, and 20 u of Lengyel's formula, 2e-6 in all; and so has their sum, for what rounding makes of x turns
/// nothing, and y's parts are as small as their sum. Hegde's edges point everywhere to the right, as many up as down
/// but for one or two.
#[test]
fn a_fan_of_a_hundred_thousand_triangles() {
    let mesh = star(100_000);
    for method in METHODS {
        let made = tangents(&mesh, &by(method));
        assert_eq!(made.report.copies, 0, "{method}");
        let [x, y, z, w] = made.tangents[0];
        assert!(z == 0.0 && w == 1.0, "{method}: {:?}", made.tangents[0]);
        let bound = if method == TangentMethod::Hegde { 4e-5 } else { 2e-6 };
        assert!((f64::from(x) - 1.0).abs() <= STEP && y.abs() < bound, "{method}: {:?}", made.tangents[0]);
    }
}

/// Whole triangles and upside-down ones meet nowhere here, so nothing is mirrored, though one vertex has no direction.
#[test]
fn a_vertex_without_direction_is_not_mirrored() {
    let points = [
        ([0.0, 0.0], [0.0, 0.0]),
        ([1.0, 0.0], [1.0, 0.0]),
        ([0.0, 1.0], [0.0, 1.0]),
        ([-1.0, 0.0], [0.0, 0.0]),
        ([0.0, -1.0], [0.0, 0.0]),
    ];
    let given = flat_mesh(&points, vec![[0, 1, 2], [0, 3, 4]]);
    for method in SUMS {
        for (mesh, options) in [(given.clone(), as_to_v(method)), (without_normals(&given), by(method))] {
            let made = tangents(&mesh, &options);
            assert_eq!((made.report.mirrored, made.report.without_texture_area), (0, 1), "{method}");
        }
    }
}
