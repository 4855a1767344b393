//! From accessors to meshes.

use super::document::{Document, index};
use super::elements::Elements;
use super::select::{Geometry, Mode, Place};
use crate::error::Result;
use crate::mesh::Mesh;

impl Geometry {
    /// Positions in their stored units, which a node may scale and move.
    pub fn mesh(&self, document: &Document) -> Result<Mesh> {
        let positions = floats(document, "POSITION", self.position)?;
        let mut texcoords = floats(document, "texture coordinate", self.texcoord)?;
        if let Some(transform) = &self.transform {
            transform.apply(&mut texcoords);
        }
        let triangles = self.triangles(document, positions.len())?;
        let mesh = Mesh::new(positions, texcoords, triangles)?;
        match self.normal {
            Some(normal) => mesh.with_normals(floats(document, "NORMAL", normal)?),
            None => Ok(mesh),
        }
    }

    /// The tangents of a primitive that has some.
    pub fn tangents(&self, document: &Document, (mesh, number): Place) -> Result<Vec<[f32; 4]>> {
        let attributes = &document.list("meshes")[mesh]["primitives"][number]["attributes"];
        let accessor = index(attributes, "TANGENT").ok_or_else(|| document.damaged("it has no TANGENT"))?;
        let (tangents, vertices) = (floats(document, "TANGENT", accessor)?, Elements::count(document, self.position)?);
        match tangents.len() == vertices {
            true => Ok(tangents),
            false => Err(document.damaged(format!("it has {} tangents for {vertices} vertices", tangents.len()))),
        }
    }

    fn triangles(&self, document: &Document, vertices: usize) -> Result<Vec<[u32; 3]>> {
        let indices: Vec<u32> = match self.indices {
            None => (0..vertices.min(u32::MAX as usize) as u32).collect(),
            Some(accessor) => Elements::read(document, accessor)?.indices().ok_or_else(|| {
                document.damaged(format!("its indices, accessors[{accessor}], are no unsigned integers"))
            })?,
        };
        // glTF 2.0, section 3.7.2.1; what is left of a last triangle is no triangle.
        Ok(match self.mode {
            Mode::Triangles => indices.as_chunks().0.to_vec(),
            Mode::Strip => {
                let turned = |(i, three): (usize, &[u32])| [three[0], three[1 + i % 2], three[2 - i % 2]];
                indices.windows(3).enumerate().map(turned).collect()
            }
            Mode::Fan => {
                indices.get(1..).unwrap_or_default().windows(2).map(|pair| [pair[0], pair[1], indices[0]]).collect()
            }
        })
    }
}

fn floats<const N: usize>(document: &Document, what: &str, accessor: usize) -> Result<Vec<[f32; N]>> {
    Elements::read(document, accessor)?.floats().ok_or_else(|| {
        document
            .damaged(format!("its {what}, accessors[{accessor}], does not have {N} components of a type that it may"))
    })
}
