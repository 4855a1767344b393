//! Lengyel's and Hegde's tangents within the bound that the oracle derives, corner by corner.

use super::{SUMS, as_to_v, tangents};
use crate::oracle::{TangentFormula, real_tangents};
use crate::support::{angle, corners, cylinder_with_a_jump, direction, every_mesh};
use texbake::{Mesh, MissingNormals, TangentMethod, TangentOptions, Tangents};

fn formula(method: TangentMethod) -> TangentFormula {
    match method {
        TangentMethod::Lengyel => TangentFormula::Lengyel,
        TangentMethod::Hegde => TangentFormula::Hegde,
        TangentMethod::Mikktspace => unreachable!("MikkTSpace has an oracle of its own"),
    }
}

/// Its triangles with vertices of their own: what flat normals make of a mesh.
fn unshared(mesh: &Mesh) -> Mesh {
    let corners = mesh.triangles().as_flattened();
    let positions = corners.iter().map(|&vertex| mesh.positions()[vertex as usize]).collect();
    let texcoords = corners.iter().map(|&vertex| mesh.texcoords()[vertex as usize]).collect();
    let triangles = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Mesh::new(positions, texcoords, triangles).expect("a mesh")
}

/// Angles that f32 may be off by above this prove nothing: a triangle is a sliver there.
const NO_PROOF: f64 = 1e-3;

/// Counts of corners: compared, without a direction or proof, and of those compared the ones with a handedness.
fn compare(name: &str, mesh: &Mesh, options: &TangentOptions) -> [usize; 3] {
    compare_with(name, mesh, options, &tangents(mesh, options))
}

/// The same of tangents that are made already.
pub fn compare_with(name: &str, mesh: &Mesh, options: &TangentOptions, made: &Tangents) -> [usize; 3] {
    let corners = corners(mesh, made);
    let normals: Vec<_> = corners.iter().map(|corner| corner.normal).collect();
    let is_flat = mesh.normals().is_none() && options.missing_normals == MissingNormals::Flat;
    let own = is_flat.then(|| unshared(mesh));
    let seen = own.as_ref().unwrap_or(mesh);
    let expected = real_tangents(seen, &normals, formula(options.method), options.unwrap);
    let [mut directed, mut undirected, mut handed] = [0; 3];
    for (at, (got, expected)) in corners.iter().zip(&expected).enumerate() {
        let what = || format!("{name}, {}, triangle {}, corner {}", options.method, at / 3, at % 3);
        let Some(t) = expected.t.filter(|_| expected.bound < NO_PROOF) else {
            undirected += 1;
            continue;
        };
        directed += 1;
        let off = angle(direction(got.tangent), t);
        assert!(off <= expected.bound, "{}: {got:?} is off by {off:e}, above {:e}", what(), expected.bound);
        if expected.determinant.abs() > 1e-4 {
            handed += 1;
            assert_eq!(f64::from(got.tangent[3]), expected.determinant.signum(), "{}: {got:?}", what());
        }
    }
    [directed, undirected, handed]
}

#[test]
fn tangents_are_within_the_rounding_of_f32() {
    for method in SUMS {
        for (name, mesh) in every_mesh() {
            let corners = 3 * mesh.triangles().len();
            let [directed, undirected, handed] = compare(name, &mesh, &as_to_v(method));
            println!("{name}, {method}: {directed} of {corners} corners have a direction, {handed} a handedness");
            assert_eq!(directed + undirected, corners);
            let is_whole =
                !["soup", "pole", "degenerate", "sphere with", "jump", "mirrored"].iter().any(|odd| name.contains(odd));
            assert!(!is_whole || (directed, handed) == (corners, corners), "{name}: {directed}, {handed} of {corners}");
            assert!(handed * 10 >= corners * 6, "{name}: {handed} of {corners} corners have a handedness");
        }
    }
}

/// u in sixteenths, so that unwrapping is exact and the bound holds.
#[test]
fn unwrapped_tangents_are_within_the_rounding_of_f32() {
    let mesh = cylinder_with_a_jump(16, 3);
    for method in SUMS {
        let options = TangentOptions { unwrap: true, ..as_to_v(method) };
        assert_eq!(compare("unwrapped cylinder", &mesh, &options), [288, 0, 288]);
    }
}
