//! Other implementations of MikkTSpace, corner by corner.

use super::Corner;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use texbake::Mesh;

/// What `bevy_mikktspace` gives each corner of a mesh whose corners have these normals: the tangent and the sign of
/// growing v; `None` where it has no answer.
pub fn bevy_tangents(mesh: &Mesh, corners: &[Corner]) -> Vec<Option<[f32; 4]>> {
    let mut faces = Faces { mesh, corners, tangents: vec![None; corners.len()] };
    generate_tangents(&mut faces).expect("it cannot fail");
    faces.tangents
}

struct Faces<'a> {
    mesh: &'a Mesh,
    corners: &'a [Corner],
    tangents: Vec<Option<[f32; 4]>>,
}

impl Faces<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles()[face][corner] as usize
    }
}

impl Geometry for Faces<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles().len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions()[self.vertex(face, corner)]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.corners[3 * face + corner].normal
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.mesh.texcoords()[self.vertex(face, corner)]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[3 * face + corner] = tangent.map(|tangent| tangent.tangent_encoded());
    }
}

/// What `meshopt` gives each corner, in its mode that is compatible with MikkTSpace.
pub fn meshopt_tangents(mesh: &Mesh, corners: &[Corner]) -> Vec<[f32; 4]> {
    let vertices = || mesh.triangles().as_flattened().iter().map(|&vertex| vertex as usize);
    let positions: Vec<_> = vertices().map(|vertex| mesh.positions()[vertex]).collect();
    let texcoords: Vec<_> = vertices().map(|vertex| mesh.texcoords()[vertex]).collect();
    let normals: Vec<_> = corners.iter().map(|corner| corner.normal).collect();
    meshopt::generate_tangents(None, &positions, &normals, &texcoords, meshopt::TangentOptions::Compatible)
}
