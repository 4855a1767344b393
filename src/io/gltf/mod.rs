//! glTF 2.0 in and out, and OBJ in: meshes that get tangents, in files of which everything else stays as it was.
//!
//! ```text
//! file -> document (JSON, buffers) -> geometries -> meshes
//!         document + tangents -> new accessors, views and bytes -> file
//! ```
//!
//! A document is JSON as it was read, so that extensions and extras that nobody here knows are written back; single
//! objects of it are read by `gltf_json`'s types.

mod container;
mod document;
mod edit;
mod elements;
mod geometry;
mod model;
mod references;
mod scene;
mod select;
mod transform;
mod uri;
mod write;

pub(super) use container::{VALUE_BYTES, read_file};
pub use document::ModelFile;
pub(super) use document::{Buffer, Document, Origin};
pub use model::{LeftOut, Model, ModelFiles, ModelReadOptions, ModelReport, Primitive};
pub use scene::Placement;
pub(super) use uri::of_path as uri_of_path;
