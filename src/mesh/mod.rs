//! Triangle meshes.

mod adjacency;
#[expect(clippy::module_inception, reason = "the type that the folder is about")]
mod mesh;

pub use adjacency::CornerAdjacency;
pub use mesh::Mesh;
