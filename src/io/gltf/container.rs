//! .glb and .gltf files as documents.

use super::document::{Buffer, Document, ModelFile, Origin, index};
use super::uri::{Uri, file_of};
use crate::error::{Error, Result};
use crate::io::input::{self, Watch};
use crate::io::limits;
use serde_json::Value;
use std::path::Path;

pub(super) const MAGIC: &[u8; 4] = b"glTF";
pub(super) const JSON: &[u8; 4] = b"JSON";
pub(super) const BIN: &[u8; 4] = b"BIN\0";

/// The file and its buffers, which together take `max_bytes` at most.
pub(super) fn read(path: &Path, max_bytes: u64) -> Result<Document> {
    let file = read_file(path, max_bytes)?;
    let is_glb = file.starts_with(MAGIC);
    let chunks = if is_glb { Chunks::of(path, &file)? } else { Chunks::bare(path, &file)? };
    check_values(path, chunks.json, max_bytes)?;
    let json: Value = serde_json::from_slice(chunks.json).map_err(|error| {
        Error::file(path, format!("it is not glTF: {error}"), "texbake reads .glb, .gltf and .obj; export it again")
    })?;
    let mut document = Document {
        path: path.into(),
        json,
        buffers: Vec::new(),
        is_glb,
        files: vec![ModelFile::new(path, &file)],
        warnings: Vec::new(),
        more_chunks: chunks.more.to_vec(),
        max_bytes,
    };
    let version = document.json["asset"]["version"].as_str().unwrap_or("none");
    if !version.starts_with("2.") {
        let reason = format!("its asset.version is {version}: texbake reads glTF 2.0");
        return Err(document.error(reason, "export the model as glTF 2.0"));
    }

    for kind in LISTS {
        let is_list = |value: &Value| value.as_array().is_some_and(|items| items.iter().all(Value::is_object));
        if document.json.get(kind).is_some_and(|value| !is_list(value)) {
            return Err(document.damaged(format!("{kind} is no list of objects")));
        }
    }

    let mut rest = max_bytes - file.len() as u64;
    for number in 0..document.list("buffers").len() {
        let buffer = read_buffer(&document, number, chunks.bin, rest)?;
        rest -= buffer.bytes.len() as u64;
        if let Origin::File = buffer.origin
            && let Uri::Relative(relative) =
                Uri::of(document.list("buffers")[number]["uri"].as_str().unwrap_or_default())
        {
            document.files.push(ModelFile::new(&file_of(path, &relative), &buffer.bytes));
        }
        document.buffers.push(buffer);
    }
    Ok(document)
}

/// What a document holds lists of.
const LISTS: [&str; 11] = [
    "accessors",
    "bufferViews",
    "buffers",
    "images",
    "materials",
    "meshes",
    "nodes",
    "samplers",
    "scenes",
    "skins",
    "textures",
];

/// Bytes that a value of JSON may take: a field with its name, in lists that grow by doubling; and its copy that gets
/// tangents.
pub(in crate::io) const VALUE_BYTES: u64 = 4 * size_of::<(u64, String, Value)>() as u64;

/// Bytes that the values of a document may take whatever the limit is.
const ALWAYS_BYTES: u64 = 16 << 20;

/// Fails if the values of a document, which are many times as large as their text, may take more than `limit` bytes.
fn check_values(path: &Path, json: &[u8], limit: u64) -> Result<()> {
    // A value stands at the beginning, behind a bracket or behind a comma; text may hold commas that part nothing.
    let count = 1 + json.iter().filter(|byte| matches!(byte, b'{' | b'[' | b',')).count() as u64;
    if count * VALUE_BYTES <= limit.max(ALWAYS_BYTES) {
        return Ok(());
    }
    let reason = format!("its {count} values take up to {} bytes, above the limit of {limit}", count * VALUE_BYTES);
    Err(Error::file(path, reason, "raise it with --max-bytes"))
}

/// A file of at most `limit` bytes.
pub(in crate::io) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let watch = Watch::at(path)?;
    limits::check_model(path, watch.length(), limit)?;
    let bytes = input::read(path, limit)?;
    limits::check_model(path, bytes.len() as u64, limit)?;
    watch.check()?;
    Ok(bytes)
}

/// The parts of a .glb (glTF 2.0, section 4.4).
struct Chunks<'a> {
    json: &'a [u8],
    bin: Option<&'a [u8]>,
    /// Chunks that follow, with their headers.
    more: &'a [u8],
}

impl<'a> Chunks<'a> {
    /// JSON, after the byte order mark that some editors put before it.
    fn bare(path: &Path, file: &'a [u8]) -> Result<Self> {
        let json = file.strip_prefix(b"\xef\xbb\xbf").unwrap_or(file);
        match json.trim_ascii_start().first() {
            Some(b'{') => Ok(Self { json, bin: None, more: &[] }),
            _ => Err(Error::file(path, "it is no model", "texbake reads .glb, .gltf and .obj")),
        }
    }

    fn of(path: &Path, file: &'a [u8]) -> Result<Self> {
        let cut = || Error::file(path, "it ends before its header says so", "the file is cut; copy or export it again");
        let word = |at: usize| Some(u32::from_le_bytes(*file.get(at..)?.first_chunk()?));
        let version = word(4).ok_or_else(cut)?;
        if version != 2 {
            let reason = format!("it is binary glTF of version {version}: texbake reads version 2");
            return Err(Error::file(path, reason, "export the model as glTF 2.0"));
        }
        let file = word(8).and_then(|length| file.get(..length as usize)).ok_or_else(cut)?;
        let (json, rest) = file.get(12..).and_then(|rest| chunk(rest, JSON)).ok_or_else(cut)?;
        let (bin, more) = chunk(rest, BIN).map_or((None, rest), |(bin, more)| (Some(bin), more));
        if bin.is_none() && rest.len() >= 8 && &rest[4..8] == BIN {
            return Err(cut());
        }
        Ok(Self { json, bin, more })
    }
}

/// The data of a chunk of this type, and what follows it.
fn chunk<'a>(bytes: &'a [u8], type_: &[u8; 4]) -> Option<(&'a [u8], &'a [u8])> {
    let length = u32::from_le_bytes(*bytes.first_chunk()?) as usize;
    let data = (bytes.get(4..8)? == type_).then(|| bytes.get(8..))??;
    data.split_at_checked(length)
}

fn read_buffer(document: &Document, number: usize, bin: Option<&[u8]>, limit: u64) -> Result<Buffer> {
    let object = document.object("buffers", number)?;
    let damaged = |reason: String| document.damaged(format!("buffers[{number}] {reason}"));
    let length = index(object, "byteLength").ok_or_else(|| damaged("has no byteLength".into()))?;
    let check = |length: usize| limits::check_model(&document.path, length as u64, limit);
    let (bytes, origin) = match (&object["uri"], bin) {
        (Value::Null, Some(bin)) if number == 0 => {
            check(bin.len())?;
            (bin.to_vec(), Origin::Inside)
        }
        (Value::Null, _) => return Ok(Buffer { bytes: Vec::new(), origin: Origin::Nowhere }),
        (uri, _) => match Uri::of(uri.as_str().unwrap_or_default()) {
            Uri::Data(data) => {
                let bytes = data.ok_or_else(|| damaged("has a data URI that is not base64".into()))?;
                check(bytes.len())?;
                (bytes, Origin::DataUri)
            }
            Uri::Relative(path) => {
                let missing = |error| match error {
                    Error::Io { source, .. } => document.error(
                        format!("it refers to {uri}, which cannot be read: {source}"),
                        "put the file where the model looks for it",
                    ),
                    other => other,
                };
                (read_file(&file_of(&document.path, &path), limit).map_err(missing)?, Origin::File)
            }
            Uri::Other => return Err(outside(document, uri)),
        },
    };
    if bytes.len() < length {
        return Err(damaged(format!("has {} of the {length} bytes that it claims", bytes.len())));
    }
    Ok(Buffer { bytes, origin })
}

/// A buffer that does not lie in the model's folder.
fn outside(document: &Document, uri: &Value) -> Error {
    let reason = format!("it refers to {uri}, which is not a file in its folder");
    document.error(reason, "put the file there and give its relative path, or pack the model into one .glb")
}
