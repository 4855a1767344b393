//! What a model file holds: JSON, and the bytes of its buffers.

use crate::error::{Error, Result};
use gltf_json::buffer::View;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What an exporter is to do about a file that contradicts itself.
const EXPORT_AGAIN: &str = "the file is damaged; export the model again";

/// A model file as it was read; nothing in it changes.
#[derive(Debug)]
pub(in crate::io) struct Document {
    pub path: PathBuf,
    pub json: Value,
    pub buffers: Vec<Buffer>,
    /// Whether it was a .glb: what lies beside one stays there.
    pub is_glb: bool,
    /// The files that were read, the model first.
    pub files: Vec<ModelFile>,
    /// What its user should know.
    pub warnings: Vec<String>,
    /// What follows the chunks of a .glb that glTF 2.0 knows.
    pub more_chunks: Vec<u8>,
    /// The most bytes that the file and an attribute of it may take.
    pub max_bytes: u64,
}

/// A file of a model, with its size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its size in bytes.
    pub bytes: u64,
}

impl ModelFile {
    pub(in crate::io) fn new(path: &Path, bytes: &[u8]) -> Self {
        Self { path: path.into(), bytes: bytes.len() as u64 }
    }
}

/// The bytes of one of the document's buffers.
#[derive(Debug)]
pub(in crate::io) struct Buffer {
    pub bytes: Vec<u8>,
    pub origin: Origin,
}

/// Where the bytes of a buffer are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Origin {
    /// In the model file: the BIN chunk of a .glb, or what an OBJ was made into.
    Inside,
    /// In a data URI.
    DataUri,
    /// In a file beside it.
    File,
    /// Nowhere: a place that an extension fills.
    Nowhere,
}

impl Document {
    /// The file contradicts itself.
    pub fn damaged(&self, reason: impl ToString) -> Error {
        self.error(reason, EXPORT_AGAIN)
    }

    pub fn error(&self, reason: impl ToString, remedy: impl Into<String>) -> Error {
        Error::file(&self.path, reason, remedy)
    }

    /// An array of the document, such as "meshes"; empty if there is none.
    pub fn list(&self, kind: &str) -> &[Value] {
        self.json[kind].as_array().map_or(&[], Vec::as_slice)
    }

    /// An object of one of the document's arrays.
    pub fn object(&self, kind: &str, index: usize) -> Result<&Value> {
        let missing = || self.damaged(format!("it refers to {kind}[{index}], which it does not have"));
        self.list(kind).get(index).filter(|object| object.is_object()).ok_or_else(missing)
    }

    /// The same, with all fields as glTF 2.0 defines them.
    pub fn typed<T: DeserializeOwned>(&self, kind: &str, index: usize) -> Result<T> {
        let object = defined(self.object(kind, index)?);
        serde_json::from_value(object).map_err(|error| self.damaged(format!("{kind}[{index}]: {error}")))
    }

    /// The bytes of a buffer view, and how far apart its elements are, if it says so.
    pub fn view(&self, index: usize) -> Result<(&[u8], Option<usize>)> {
        let view: View = self.typed("bufferViews", index)?;
        let buffer = view.buffer.value();
        let missing = || self.damaged(format!("bufferViews[{index}] lies in buffers[{buffer}], which does not exist"));
        let bytes = &self.buffers.get(buffer).ok_or_else(missing)?.bytes;
        let range = range(view.byte_offset.map_or(0, |offset| offset.0), view.byte_length.0);
        let bytes = range.and_then(|range| bytes.get(range)).ok_or_else(|| {
            let held = bytes.len();
            self.damaged(format!("bufferViews[{index}] reaches beyond the {held} bytes of buffers[{buffer}]"))
        })?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }

    /// The names in `extensionsRequired`.
    pub fn required_extensions(&self) -> impl Iterator<Item = &str> {
        self.list("extensionsRequired").iter().filter_map(Value::as_str)
    }
}

/// An object without extensions, which are looked at where they matter, and extras: they may hold anything.
fn defined(value: &Value) -> Value {
    let Value::Object(fields) = value else { return value.clone() };
    let fields = fields.iter().filter(|(name, _)| *name != "extensions" && *name != "extras");
    fields.map(|(name, field)| (name.clone(), defined(field))).collect()
}

/// `length` from `offset`, if that can be in memory.
pub(super) fn range(offset: u64, length: u64) -> Option<std::ops::Range<usize>> {
    Some(offset.try_into().ok()?..offset.checked_add(length)?.try_into().ok()?)
}

/// A field that holds an index.
pub(super) fn index(object: &Value, field: &str) -> Option<usize> {
    object[field].as_u64().and_then(|index| index.try_into().ok())
}
