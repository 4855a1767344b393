//! One wrong bit of a tangent, a wrong sign, a wrong source: every comparison of tangents catches it.

use crate::support::{
    assert_same_tangents, bevy_tangents, corner_tangents, corners, hills, mirrored_halves, result_differences,
    tangent_differences,
};
use texbake::{Baker, Mesh, TangentMethod, TangentOptions, Tangents};

fn made(mesh: &Mesh, method: TangentMethod) -> Tangents {
    Baker::reference().tangents(mesh, &TangentOptions { method, ..Default::default() }).expect("tangents")
}

#[test]
fn one_flipped_bit_of_a_tangent_is_caught_with_its_place() {
    let mesh = hills(4, 4, 1);
    let right = corner_tangents(&mesh, &made(&mesh, TangentMethod::Lengyel));
    for (corner, component) in [(0, 0), (37, 2), (95, 3)] {
        let mut wrong = right.clone();
        wrong[corner][component] = f32::from_bits(wrong[corner][component].to_bits() ^ 1);
        let report = super::failure(|| assert_same_tangents("hills", &wrong, &right));
        assert!(report.starts_with("hills: 1 of 96 corners differ"), "{report}");
        let place = format!("triangle {}, corner {}: got ", corner / 3, corner % 3);
        assert!(report.contains(&place) && report.contains("expected "), "{report}");
    }
}

#[test]
fn the_sign_and_that_of_zero_are_compared() {
    let one = [[1.0, 0.0, 0.0, 1.0]; 3];
    for other in [[1.0, 0.0, 0.0, -1.0], [1.0, -0.0, 0.0, 1.0]] {
        assert!(tangent_differences(&[one[0], other, one[0]], &one).is_err());
    }
    assert!(tangent_differences(&one, &one).is_ok());
}

#[test]
fn comparing_nothing_or_too_little_is_a_failure() {
    let one = [[1.0, 0.0, 0.0, 1.0]; 3];
    for (got, expected) in
        [(&one[..0], &one[..0]), (&one[..2], &one[..]), (&one[..], &one[..0]), (&one[..2], &one[..2])]
    {
        assert!(tangent_differences(got, expected).is_err());
    }
}

#[test]
fn every_part_of_a_result_is_compared() {
    let mesh = mirrored_halves(4, 3);
    let right = made(&mesh, TangentMethod::Lengyel);
    assert!(right.copies.len() > 1 && right.copies[0] != right.copies[1]);
    assert_eq!(result_differences(&mesh, &right, &right), Ok(()));
    let sabotages: [fn(&mut Tangents); 8] = [
        |it| it.copies.swap(0, 1),
        |it| it.tangents[3][0] = f32::from_bits(it.tangents[3][0].to_bits() ^ 1),
        |it| it.tangents[7][3] = -it.tangents[7][3],
        |it| it.triangles.as_mut().expect("copies are used")[5].rotate_left(1),
        |it| it.triangles = None,
        |it| it.normals = Some(vec![[0.0, 0.0, 1.0]; it.tangents.len()]),
        |it| it.report.mirrored -= 1,
        |it| it.report.undirected += 1,
    ];
    for (number, sabotage) in sabotages.into_iter().enumerate() {
        let mut wrong = right.clone();
        sabotage(&mut wrong);
        assert!(result_differences(&mesh, &wrong, &right).is_err(), "sabotage {number} is not seen");
    }
}

/// A vertex that no triangle uses is compared as well.
#[test]
fn vertices_without_triangles_are_compared() {
    let mesh = crate::support::degenerate_triangles();
    let right = made(&mesh, TangentMethod::Lengyel);
    let mut wrong = right.clone();
    let last = wrong.tangents.last_mut().expect("vertices");
    last[3] = -last[3];
    assert!(result_differences(&mesh, &wrong, &right).is_err());
}

/// The oracle of MikkTSpace sees another mesh: it really reads what it compares.
#[test]
fn the_reference_of_mikktspace_reads_every_attribute() {
    let mesh = hills(4, 4, 2);
    let made = corners(&mesh, &made(&mesh, TangentMethod::Mikktspace));
    let right = bevy_tangents(&mesh, &made);
    assert!(right.iter().all(Option::is_some));
    let identity = |v: [f32; 3]| v;
    let moved = crate::support::changed(&mesh, |[x, y, z]| [x + 0.3 * y, y, z], identity, |uv| uv);
    let remapped = crate::support::changed(&mesh, identity, identity, |[u, v]| [u, u + v]);
    let mut tilted = made.clone();
    tilted.iter_mut().for_each(|corner| corner.normal = [0.6, 0.0, 0.8]);
    for other in [bevy_tangents(&moved, &made), bevy_tangents(&remapped, &made), bevy_tangents(&mesh, &tilted)] {
        assert!(other != right);
    }
}
