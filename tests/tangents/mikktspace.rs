//! MikkTSpace against `bevy_mikktspace`, which has the reference's bytes, and against `meshopt`, which is near them.

use super::{as_to_v, tangents};
use crate::support::{
    Corner, angle, assert_same_tangents, bevy_tangents, changed, corners, direction, every_mesh, hills,
    meshopt_tangents, soup,
};
use texbake::{Mesh, MissingNormals, TangentMethod, TangentOptions};

/// A mesh at a scale of 1 to 2, by a power of two: the reference squares areas, which overflow or vanish beyond.
fn near_one(mesh: &Mesh) -> Mesh {
    fn factor<const N: usize>(vectors: &[[f32; N]]) -> f32 {
        let greatest = vectors.as_flattened().iter().fold(0.0, |greatest: f32, part| greatest.max(part.abs()));
        if greatest == 0.0 { 1.0 } else { 2f32.powi(-(greatest.log2().floor() as i32)) }
    }
    let (p, t) = (factor(mesh.positions()), factor(mesh.texcoords()));
    changed(mesh, |v| v.map(|part| p * part), |n| n, |uv| uv.map(|part| t * part))
}

/// The tangents of every baker against the reference's.
fn assert_bevys(what: &str, mesh: &Mesh, options: &TangentOptions) -> usize {
    let made = corners(mesh, &tangents(mesh, options));
    let is_far = what.contains("1e");
    assert_bevys_corners(what, &if is_far { near_one(mesh) } else { mesh.clone() }, &made)
}

/// Fails unless every corner has the reference's bytes where the reference has a direction, and its handedness.
/// Tells how many corners have one.
pub fn assert_bevys_corners(what: &str, mesh: &Mesh, made: &[Corner]) -> usize {
    let expected = bevy_tangents(mesh, made);
    assert_eq!(expected.len(), made.len());
    let is_direction = |tangent: &[f32; 4]| tangent[..3].iter().any(|&part| part != 0.0);
    // Where the reference has nothing, any direction will do: what every tangent is, `output` tests.
    let expected: Vec<Option<[f32; 4]>> = expected.into_iter().map(|tangent| tangent.filter(is_direction)).collect();
    let got: Vec<[f32; 4]> = made.iter().map(|corner| corner.tangent).collect();
    let wanted: Vec<[f32; 4]> = expected.iter().zip(&got).map(|(expected, &got)| expected.unwrap_or(got)).collect();
    if !wanted.is_empty() {
        assert_same_tangents(what, &got, &wanted);
    }
    expected.iter().flatten().count()
}

fn options(missing_normals: MissingNormals) -> TangentOptions {
    TangentOptions { missing_normals, ..as_to_v(TangentMethod::Mikktspace) }
}

#[test]
fn every_mesh_has_the_references_bytes() {
    let mut compared = 0;
    let mut meshes = 0;
    for (name, mesh) in every_mesh() {
        for missing_normals in [MissingNormals::Flat, MissingNormals::Smooth] {
            if missing_normals == MissingNormals::Smooth && mesh.normals().is_some() {
                continue;
            }
            let directed = assert_bevys(name, &mesh, &options(missing_normals));
            let all = 3 * mesh.triangles().len();
            println!("{name}, {missing_normals} normals: {directed} of {all} corners have a direction");
            assert!(
                directed == all || ["soup", "degenerate", "poles", "pole"].iter().any(|odd| name.contains(odd)),
                "{name}"
            );
            compared += directed;
            meshes += 1;
        }
    }
    assert!(meshes > 25 && compared > 40_000, "{meshes} meshes, {compared} corners");
}

/// Of few vertices and many triangles: edges that many triangles share, duplicates, slivers, every kind of grouping.
#[test]
fn random_soups_have_the_references_bytes() {
    let mut compared = 0;
    for seed in 0..60 {
        let vertices = 4 + 3 * (seed as u32 % 20);
        let mesh = soup(vertices, 20 + 5 * (seed as u32 % 31), 1000 + seed);
        compared += assert_bevys(&format!("soup {seed}"), &mesh, &options(MissingNormals::Flat));
    }
    assert!(compared > 5_000, "{compared}");
}

/// Vertices that are not shared at all are welded by their bits: the same tangents.
#[test]
fn sharing_vertices_changes_nothing() {
    let mesh = hills(9, 9, 31);
    let indices = mesh.triangles().as_flattened();
    let normals = mesh.normals().expect("normals");
    let alone = crate::support::mesh(
        indices.iter().map(|&v| mesh.positions()[v as usize]).collect(),
        indices.iter().map(|&v| normals[v as usize]).collect(),
        indices.iter().map(|&v| mesh.texcoords()[v as usize]).collect(),
        (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
    );
    let options = options(MissingNormals::Flat);
    let all =
        |mesh: &Mesh| corners(mesh, &tangents(mesh, &options)).iter().map(|corner| corner.tangent).collect::<Vec<_>>();
    assert_same_tangents("unshared", &all(&alone), &all(&mesh));
    assert_bevys("unshared", &alone, &options);
}

/// Corners that are further than this many degrees from meshopt's, or of another handedness.
fn far_from_meshopt(mesh: &Mesh, degrees: f64) -> usize {
    let made: Vec<Corner> = corners(mesh, &tangents(mesh, &options(MissingNormals::Flat)));
    let other = meshopt_tangents(mesh, &made);
    let is_far = |(corner, other): &(&Corner, &[f32; 4])| {
        let off = angle(direction(corner.tangent), direction(**other)).to_degrees();
        off > degrees || corner.tangent[3] != other[3]
    };
    assert!(!other.is_empty());
    made.iter().zip(&other).filter(is_far).count()
}

/// Its angles are off by up to 5e-4 radians, 0.03 degrees, and so are its weights: most tangents are off by less than
/// 1e-3 degrees, few by more.
#[test]
fn whole_meshes_are_near_meshopts() {
    for (name, mesh) in every_mesh().into_iter().filter(|(_, mesh)| !mesh.triangles().is_empty()) {
        let all = 3 * mesh.triangles().len();
        let (far, very_far) = (far_from_meshopt(&mesh, 1e-3), far_from_meshopt(&mesh, 0.03));
        println!("{name}: {far} of {all} corners are above 1e-3 degrees, {very_far} above 0.03");
        let is_odd = ["soup", "degenerate", "poles", "1e", "pole", "double"].iter().any(|odd| name.contains(odd));
        assert!(is_odd || (far * 50 <= all && very_far == 0), "{name}: {far}, {very_far} of {all} corners differ");
    }
}
