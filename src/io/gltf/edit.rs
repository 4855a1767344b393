//! Tangents put into a document: new accessors, of which primitives take hold.
//!
//! Accessors are shared, so none is changed that something still uses. One that nothing uses any more gives its
//! place to a new one, and so does its buffer view: nothing unused stays behind, and no other index moves.

use super::document::{Document, index};
use super::elements::Elements;
use super::references::References;
use super::select::{Geometry, Mode, Place};
use crate::error::Result;
use crate::ops::tangents::Tangents;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// A document with tangents.
pub(super) struct Edited<'a> {
    document: &'a Document,
    pub json: Value,
    /// The bytes of new accessors.
    pub added: Vec<u8>,
    /// The buffer views of `added`; their `buffer` is not yet that of any buffer.
    pub added_views: Vec<usize>,
    references: References,
}

/// What the vertices of a primitive have got.
#[derive(Debug)]
pub(super) struct Made {
    pub tangents: Tangents,
    pub bitangents: Option<Vec<[f32; 3]>>,
}

/// The attribute that bitangents are in. glTF has none for them; the underscore marks one of an application.
const BITANGENT: &str = "_BITANGENT";

impl Made {
    /// Bytes of the tangents, and of what comes with them.
    pub fn bytes(&self) -> u64 {
        let Tangents { tangents, normals, copies, triangles, .. } = &self.tangents;
        let vectors = 16 * tangents.len() + 12 * normals.as_ref().map_or(0, Vec::len);
        (vectors + 4 * copies.len() + 12 * triangles.as_ref().map_or(0, Vec::len)) as u64
    }

    /// Whether it has an attribute of this name.
    fn has(&self, name: &str) -> bool {
        match name {
            "TANGENT" => true,
            "NORMAL" => self.tangents.normals.is_some(),
            BITANGENT => self.bitangents.is_some(),
            _ => false,
        }
    }
}

/// An accessor to be, with its bytes.
struct NewAccessor {
    fields: Map<String, Value>,
    bytes: Vec<u8>,
    /// Between elements, if that is more than their size.
    stride: Option<usize>,
    target: u32,
}

impl<'a> Edited<'a> {
    pub fn new(document: &'a Document) -> Self {
        let references = References::of(&document.json);
        let json = document.json.clone();
        Self { document, json, added: Vec::new(), added_views: Vec::new(), references }
    }

    /// Gives all primitives of one geometry its tangents.
    pub fn apply(&mut self, geometry: &Geometry, places: &[Place], made: &Made) -> Result<()> {
        let tangents = &made.tangents;
        let old: Vec<Value> = places.iter().map(|&place| primitive(&mut self.json, place).take()).collect();
        for primitive in &old {
            replaced(primitive, made).for_each(|accessor| self.references.release(accessor, &self.document.json));
        }

        // Those that take an old one's place go first.
        let mut copied = HashMap::new();
        for accessor in old.iter().flat_map(|primitive| extended(primitive, made)) {
            if let Entry::Vacant(new) = copied.entry(accessor) {
                let with_copies = self.with_copies(accessor, tangents)?;
                new.insert(self.add(Some(accessor), with_copies));
            }
        }
        let normals = tangents.normals.as_ref().map(|normals| {
            self.add(geometry.normal, float_accessor("VEC3", normals.len(), bytemuck::cast_slice(normals)))
        });
        let indices = tangents.triangles.as_ref().map(|triangles| {
            let indices = index_accessor(triangles, tangents.tangents.len(), geometry.mode);
            self.add(geometry.indices, indices)
        });
        let existing = |name: &str| old.iter().find_map(|primitive| index(&primitive["attributes"], name));
        let bitangents = made.bitangents.as_ref().map(|bitangents| {
            let vectors = bytemuck::cast_slice(bitangents);
            self.add(existing(BITANGENT), float_accessor("VEC3", bitangents.len(), vectors))
        });
        let vectors = bytemuck::cast_slice(&tangents.tangents);
        let tangent = self.add(existing("TANGENT"), float_accessor("VEC4", tangents.tangents.len(), vectors));

        for (mut new, &place) in old.into_iter().zip(places) {
            let attributes = new["attributes"].as_object_mut().expect("a selected primitive has a position");
            for (_, accessor) in attributes.iter_mut() {
                replace(accessor, &copied);
            }
            if let Some(normals) = normals {
                attributes.insert("NORMAL".into(), normals.into());
            }
            attributes.insert("TANGENT".into(), tangent.into());
            if let Some(bitangents) = bitangents {
                attributes.insert(BITANGENT.into(), bitangents.into());
            }
            for target in new
                .get_mut("targets")
                .and_then(Value::as_array_mut)
                .into_iter()
                .flatten()
                .filter_map(Value::as_object_mut)
            {
                target.shift_remove("TANGENT");
                target.values_mut().for_each(|accessor| replace(accessor, &copied));
            }
            if let Some(indices) = indices {
                new["indices"] = indices.into();
                if geometry.mode != Mode::Triangles {
                    new["mode"] = 4.into();
                }
            }
            replaced_by(&new, made).for_each(|accessor| self.references.hold(accessor));
            *primitive(&mut self.json, place) = new;
        }
        Ok(())
    }

    /// The elements of an accessor, byte by byte, and the copies behind them.
    fn with_copies(&self, accessor: usize, tangents: &Tangents) -> Result<NewAccessor> {
        let elements = Elements::read(self.document, accessor)?;
        let vertices = tangents.tangents.len() - tangents.copies.len();
        if elements.count != vertices {
            let count = elements.count;
            let reason =
                format!("accessors[{accessor}] has {count} elements for the {vertices} vertices of a primitive");
            return Err(self.document.damaged(reason));
        }
        // Elements of attributes begin at multiples of four (glTF 2.0, section 3.6.2.4).
        let (size, stride) = (elements.size, elements.size.next_multiple_of(4));
        let mut bytes = Vec::with_capacity(tangents.tangents.len() * stride);
        for vertex in tangents.sources() {
            bytes.extend_from_slice(&elements.bytes[vertex as usize * size..][..size]);
            bytes.resize(bytes.len().next_multiple_of(4), 0);
        }
        let mut fields = self.document.object("accessors", accessor)?.as_object().cloned().unwrap_or_default();
        ["bufferView", "byteOffset", "sparse"].iter().for_each(|field| drop(fields.shift_remove(*field)));
        fields.insert("count".into(), tangents.tangents.len().into());
        Ok(NewAccessor { fields, bytes, stride: (stride != size).then_some(stride), target: ARRAY_BUFFER })
    }

    /// Adds an accessor, in the place of an `old` one that nothing uses, or of any such.
    fn add(&mut self, old: Option<usize>, new: NewAccessor) -> usize {
        self.added.resize(self.added.len().next_multiple_of(4), 0);
        let mut view = json!({
            "buffer": 0, "byteOffset": self.added.len(), "byteLength": new.bytes.len(), "target": new.target
        });
        if let Some(stride) = new.stride {
            view["byteStride"] = stride.into();
        }
        self.added.extend_from_slice(&new.bytes);
        let old_view = old.and_then(|old| index(&self.document.list("accessors")[old], "bufferView"));
        let at = self.references.views.place(old_view);
        put(&mut self.json, "bufferViews", at, view);
        self.added_views.push(at);

        let mut accessor = new.fields;
        accessor.insert("bufferView".into(), at.into());
        let at = self.references.accessors.place(old);
        put(&mut self.json, "accessors", at, Value::Object(accessor));
        at
    }
}

/// The accessors that a primitive's vertices, beyond what is made for them, are in, if they get copies.
fn extended(primitive: &Value, made: &Made) -> impl Iterator<Item = usize> {
    let has_copies = !made.tangents.copies.is_empty();
    let attributes = primitive["attributes"].as_object().into_iter().flatten().filter(|(name, _)| !made.has(name));
    let targets = primitive["targets"].as_array().into_iter().flatten().filter_map(Value::as_object).flatten();
    let all = attributes.chain(targets.filter(|(name, _)| *name != "TANGENT")).filter(move |_| has_copies);
    all.filter_map(|(_, accessor)| accessor.as_u64()).map(|accessor| accessor as usize)
}

/// The accessors that a primitive's new ones take the place of.
fn replaced(primitive: &Value, made: &Made) -> impl Iterator<Item = usize> {
    let targets = primitive["targets"].as_array().into_iter().flatten();
    replaced_by(primitive, made).chain(targets.filter_map(|target| index(target, "TANGENT")))
}

/// The accessors of a primitive with tangents that are new.
fn replaced_by(primitive: &Value, made: &Made) -> impl Iterator<Item = usize> {
    let attributes = primitive["attributes"].as_object().into_iter().flatten().filter(|(name, _)| made.has(name));
    let attributes = attributes.filter_map(|(_, accessor)| accessor.as_u64()).map(|accessor| accessor as usize);
    let indices = made.tangents.triangles.as_ref().and_then(|_| index(primitive, "indices"));
    extended(primitive, made).chain(attributes).chain(indices)
}

fn replace(accessor: &mut Value, copied: &HashMap<usize, usize>) {
    if let Some(new) = accessor.as_u64().and_then(|old| copied.get(&(old as usize))) {
        *accessor = (*new).into();
    }
}

fn primitive(json: &mut Value, (mesh, number): Place) -> &mut Value {
    &mut json["meshes"][mesh]["primitives"][number]
}

/// Puts an object in its place in an array, with the name that the one before it had.
pub(super) fn put(json: &mut Value, kind: &str, at: usize, mut object: Value) {
    if json[kind].is_null() {
        json[kind] = json!([]);
    }
    let list = json[kind].as_array_mut().expect("what refers to it was found");
    if at == list.len() {
        list.push(object);
        return;
    }
    if let Some(name) = list[at].get("name") {
        object["name"] = name.clone();
    }
    list[at] = object;
}

/// `bytes` are those of `count` vectors of floats.
fn float_accessor(type_: &str, count: usize, bytes: &[u8]) -> NewAccessor {
    #[cfg(target_endian = "big")]
    compile_error!("glTF's numbers are little-endian");
    let fields = json!({ "componentType": FLOAT, "count": count, "type": type_ });
    new_accessor(fields, bytes.to_vec(), ARRAY_BUFFER)
}

fn index_accessor(triangles: &[[u32; 3]], vertices: usize, mode: Mode) -> NewAccessor {
    // Strips turn back with triangles that are lines.
    let is_kept = |[a, b, c]: [u32; 3]| mode == Mode::Triangles || (a != b && b != c && c != a);
    let indices: Vec<u32> = triangles.iter().filter(|&&triangle| is_kept(triangle)).flatten().copied().collect();
    // The greatest number of a type is none of a vertex (glTF 2.0, section 3.7.2.1).
    let (type_, bytes) = if vertices <= usize::from(u16::MAX) {
        let indices: Vec<u16> = indices.iter().map(|&index| index as u16).collect();
        (UNSIGNED_SHORT, bytemuck::cast_slice(&indices).to_vec())
    } else {
        (UNSIGNED_INT, bytemuck::cast_slice(&indices).to_vec())
    };
    let fields = json!({ "componentType": type_, "count": indices.len(), "type": "SCALAR" });
    new_accessor(fields, bytes, ELEMENT_ARRAY_BUFFER)
}

fn new_accessor(fields: Value, bytes: Vec<u8>, target: u32) -> NewAccessor {
    let Value::Object(fields) = fields else { unreachable!("it is written as one") };
    NewAccessor { fields, bytes, stride: None, target }
}
