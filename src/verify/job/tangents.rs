//! Meshes into tangents.

use super::pieces::{print_float, replaced};
use crate::baker::Baker;
use crate::error::Result;
use crate::map::{Codes, Depth, Encoding, TexelFormat};
use crate::mesh::Mesh;
use crate::ops::Precision;
use crate::ops::tangents::TangentOptions;
use crate::verify::answer::{Answer, Meaning};
use crate::verify::shrink::simpler_floats;
use std::fmt::Write;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TangentJob {
    pub mesh: Mesh,
    pub options: TangentOptions,
}

/// Coordinates of larger meshes are not simplified: triangles go first.
const FEW: usize = 12;

impl TangentJob {
    /// The tangent of each corner, whichever vertices were split.
    pub fn run(&self, baker: &Baker) -> Result<Vec<Answer>> {
        let made = baker.tangents(&self.mesh, &self.options)?;
        let triangles = made.triangles.as_deref().unwrap_or(self.mesh.triangles());
        let corners: Vec<f32> =
            triangles.as_flattened().iter().flat_map(|&vertex| made.tangents[vertex as usize]).collect();
        let format = TexelFormat { encoding: Encoding::Float, depth: Depth::Float32, channels: 4 };
        Ok(vec![Answer { meaning: Meaning::Tangent, format, width: corners.len() / 4, codes: Codes::F32(corners) }])
    }

    pub fn smaller(&self) -> Vec<Self> {
        let triangles = self.mesh.triangles();
        let count = triangles.len();
        let mut jobs = Vec::new();
        // Ever smaller blocks of triangles go.
        let mut block = count.div_ceil(2);
        while block > 0 && count > 1 {
            for first in (0..count).step_by(block) {
                let kept = [&triangles[..first], &triangles[count.min(first + block)..]].concat();
                if !kept.is_empty() {
                    jobs.push(self.of(compact(&self.mesh, &kept)));
                }
            }
            block /= 2;
        }
        if self.mesh.positions().len() <= FEW && self.options.precision == Precision::Exact {
            let [positions, normals] = [self.mesh.positions(), self.mesh.normals().unwrap_or_default()];
            let simpler = |value| simpler_floats(value).collect();
            for list in replaced(positions.as_flattened(), simpler) {
                jobs.extend(self.with(list.as_chunks().0.to_vec(), self.mesh.texcoords().to_vec(), normals.to_vec()));
            }
            for list in replaced(self.mesh.texcoords().as_flattened(), simpler) {
                jobs.extend(self.with(positions.to_vec(), list.as_chunks().0.to_vec(), normals.to_vec()));
            }
            for list in replaced(normals.as_flattened(), simpler) {
                let texcoords = self.mesh.texcoords().to_vec();
                jobs.extend(self.with(positions.to_vec(), texcoords, list.as_chunks().0.to_vec()));
            }
        }
        jobs
    }

    fn of(&self, mesh: Mesh) -> Self {
        Self { mesh, options: self.options }
    }

    fn with(&self, positions: Vec<[f32; 3]>, texcoords: Vec<[f32; 2]>, normals: Vec<[f32; 3]>) -> Option<Self> {
        let mesh = Mesh::new(positions, texcoords, self.mesh.triangles().to_vec()).ok()?;
        Some(self.of(if normals.is_empty() { mesh } else { mesh.with_normals(normals).ok()? }))
    }

    pub fn input(&self) -> String {
        let unwrapped = if self.options.unwrap { ", unwrapped" } else { "" };
        let mut text = format!("mesh{unwrapped}:");
        if self.mesh.positions().len() > 3 * FEW {
            return text + " too many vertices to show";
        }
        let list = |values: &[f32]| values.iter().map(|&value| print_float(value)).collect::<Vec<_>>().join(", ");
        for (vertex, position) in self.mesh.positions().iter().enumerate() {
            let texcoord = list(&self.mesh.texcoords()[vertex]);
            let normal = self.mesh.normals().map_or("none".into(), |normals| list(&normals[vertex]));
            let _ =
                write!(text, "\n  vertex {vertex}: position {}; texture {texcoord}; normal {normal}", list(position));
        }
        let _ = write!(text, "\n  triangles {:?}", self.mesh.triangles());
        text
    }
}

/// The mesh of these triangles, without vertices that none of them has.
fn compact(mesh: &Mesh, triangles: &[[u32; 3]]) -> Mesh {
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let number = |vertex: &u32| used.binary_search(vertex).expect("it is used") as u32;
    let triangles = triangles.iter().map(|corners| corners.each_ref().map(number)).collect();
    let positions = used.iter().map(|&vertex| mesh.positions()[vertex as usize]).collect();
    let texcoords = used.iter().map(|&vertex| mesh.texcoords()[vertex as usize]).collect();
    let of = "what was a mesh still is";
    let smaller = Mesh::new(positions, texcoords, triangles).expect(of);
    match mesh.normals() {
        None => smaller,
        Some(normals) => {
            let normals = used.iter().map(|&vertex| normals[vertex as usize]).collect();
            smaller.with_normals(normals).expect(of)
        }
    }
}
