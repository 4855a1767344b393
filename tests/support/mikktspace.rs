//! Other implementations of MikkTSpace, corner by corner.

use super::{Corner, bevy};
use texbake::Mesh;

/// What `bevy_mikktspace` gives each corner of a mesh whose corners have these normals: the tangent and the sign of
/// growing v; `None` where it has no answer.
pub fn bevy_tangents(mesh: &Mesh, corners: &[Corner]) -> Vec<Option<[f32; 4]>> {
    let normal = |corner: usize| corners[corner].normal;
    bevy::tangents(mesh.positions(), mesh.texcoords(), mesh.triangles(), normal)
}

/// What `meshopt` gives each corner, in its mode that is compatible with MikkTSpace.
pub fn meshopt_tangents(mesh: &Mesh, corners: &[Corner]) -> Vec<[f32; 4]> {
    let vertices = || mesh.triangles().as_flattened().iter().map(|&vertex| vertex as usize);
    let positions: Vec<_> = vertices().map(|vertex| mesh.positions()[vertex]).collect();
    let texcoords: Vec<_> = vertices().map(|vertex| mesh.texcoords()[vertex]).collect();
    let normals: Vec<_> = corners.iter().map(|corner| corner.normal).collect();
    meshopt::generate_tangents(None, &positions, &normals, &texcoords, meshopt::TangentOptions::Compatible)
}
