//! MikkTSpace as `bevy_mikktspace` computes it. The crate's own tests and the benches read this file too, so it names no
//! type of texbake.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};

/// The tangent of each corner and the sign of growing v, for corners with these normals; `None` where it has no answer.
pub fn tangents(
    positions: &[[f32; 3]],
    texcoords: &[[f32; 2]],
    triangles: &[[u32; 3]],
    normal_of_corner: impl Fn(usize) -> [f32; 3],
) -> Vec<Option<[f32; 4]>> {
    let tangents = vec![None; 3 * triangles.len()];
    let mut faces = Faces { positions, texcoords, triangles, normal_of_corner, tangents };
    generate_tangents(&mut faces).expect("it cannot fail");
    faces.tangents
}

struct Faces<'a, N> {
    positions: &'a [[f32; 3]],
    texcoords: &'a [[f32; 2]],
    triangles: &'a [[u32; 3]],
    normal_of_corner: N,
    tangents: Vec<Option<[f32; 4]>>,
}

impl<N: Fn(usize) -> [f32; 3]> Geometry for Faces<'_, N> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.positions[self.triangles[face][corner] as usize]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.normal_of_corner)(3 * face + corner)
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.texcoords[self.triangles[face][corner] as usize]
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[3 * face + corner] = tangent.map(|tangent| tangent.tangent_encoded());
    }
}
