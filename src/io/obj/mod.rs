//! OBJ files, made into what a .glb of the same meshes holds.
//!
//! An object is a mesh, a group is one where there are no objects. Faces of one material make a primitive; those
//! without texture coordinates, or without normals, make one of their own. Of materials, names, diffuse colours and
//! maps, and normal maps are kept. Colours of vertices are kept as they are written.

mod materials;
mod polygon;
mod text;

use super::gltf::{Buffer, Document, ModelFile, Origin, VALUE_BYTES, read_file};
use crate::error::{Error, Result};
use materials::Materials;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;
use text::{Corner, Obj, Part};

pub(super) fn read(path: &Path, max_bytes: u64) -> Result<Document> {
    let bytes = read_file(path, max_bytes)?;
    // Names may be in any encoding.
    let obj = Obj::of(&String::from_utf8_lossy(&bytes))
        .map_err(|reason| Error::file(path, reason, "it is not OBJ, or damaged; export the model again"))?;
    if obj.objects.is_empty() {
        return Err(Error::file(path, "it has no faces", "export the model as polygons"));
    }
    let needed = needed(&bytes, &obj);
    if needed > max_bytes {
        let reason = format!("reading it takes {needed} bytes, and {max_bytes} of the limit are left");
        return Err(Error::file(path, reason, "raise it with --max-bytes"));
    }

    let mut materials = Materials::of(ModelFile::new(path, &bytes), (max_bytes - needed) / materials::UNPACKED);
    obj.libraries.iter().for_each(|names| materials.read(path, names));
    let mut this = Builder::default();
    let mut meshes = Vec::new();
    for object in &obj.objects {
        let primitives = object.parts.iter().map(|part| {
            let mut primitive = this
                .primitive(&obj, part)
                .map_err(|reason| Error::file(path, reason, "export the model as triangles"))?;
            if let Some(name) = &part.material {
                primitive["material"] = materials.number(name).into();
            }
            Ok(primitive)
        });
        let primitives: Vec<Value> = primitives.collect::<Result<_>>()?;
        meshes.push(match &object.name {
            Some(name) => json!({ "name": name, "primitives": primitives }),
            None => json!({ "primitives": primitives }),
        });
    }
    let mut json = json!({
        "asset": { "version": "2.0", "generator": concat!("texbake ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": (0..meshes.len()).collect::<Vec<_>>() }],
        "nodes": (0..meshes.len()).map(|mesh| json!({ "mesh": mesh })).collect::<Vec<_>>(),
        "meshes": meshes,
        "accessors": this.accessors,
        "bufferViews": this.views,
        "buffers": [{ "byteLength": this.bytes.len() }],
    });
    let Materials { materials, textures, images, files, warnings, .. } = materials;
    for (kind, list) in [("materials", materials), ("textures", textures), ("images", images)] {
        if !list.is_empty() {
            json[kind] = list.into();
        }
    }
    let buffers = vec![Buffer { bytes: this.bytes, origin: Origin::Inside }];
    let path = path.into();
    Ok(Document { path, json, buffers, is_glb: false, files, warnings, more_chunks: Vec::new(), max_bytes })
}

/// Values of JSON that describe a part: a primitive with its accessors and their views.
const PART_VALUES: u64 = 80;

/// Bytes of the text, its numbers, its parts and the vertices and indices made of them.
fn needed(bytes: &[u8], obj: &Obj) -> u64 {
    let parts = || obj.objects.iter().flat_map(|object| &object.parts);
    let corners: usize = parts().map(|part| part.corners.len()).sum();
    let numbers = 24 * obj.positions.len() + 8 * obj.texcoords.len() + 12 * obj.normals.len();
    let vertices = obj.positions.len().max(obj.texcoords.len()).max(obj.normals.len()).min(corners);
    // A corner is three words and one index, or more where polygons are cut; a vertex takes 44 bytes, and 24 while
    // corners look for theirs.
    let values = PART_VALUES * parts().count() as u64 * VALUE_BYTES;
    (bytes.len() + numbers + 24 * corners + 68 * vertices) as u64 + values
}

#[derive(Default)]
struct Builder {
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: Vec<u8>,
}

impl Builder {
    /// Triangles with one vertex for corners that are the same.
    fn primitive(&mut self, obj: &Obj, part: &Part) -> Result<Value, String> {
        let mut vertices: Vec<Corner> = Vec::new();
        let mut known: HashMap<Corner, u32> = HashMap::new();
        let mut indices: Vec<u32> = Vec::new();
        let mut rest = part.corners.as_slice();
        for &count in &part.faces {
            let (face, after) = rest.split_at(count as usize);
            rest = after;
            let points: Vec<[f32; 3]> = face.iter().map(|corner| obj.positions[corner[0] as usize]).collect();
            let triangles = polygon::triangulate(&points).ok_or_else(|| {
                let most = polygon::MOST_CORNERS;
                format!("a polygon of {count} corners is not convex; of such, texbake cuts those of up to {most}")
            })?;
            for number in triangles.into_flattened() {
                // What only some corners of a face have, none of its part has.
                let [position, texcoord, normal] = face[number];
                let texcoord = if part.has_texcoords { texcoord } else { text::NONE };
                let corner = [position, texcoord, if part.has_normals { normal } else { text::NONE }];
                indices.push(*known.entry(corner).or_insert_with(|| {
                    vertices.push(corner);
                    vertices.len() as u32 - 1
                }));
            }
        }

        let positions: Vec<[f32; 3]> = vertices.iter().map(|vertex| obj.positions[vertex[0] as usize]).collect();
        let position = self.add("VEC3", vertices.len(), 34962, bytemuck::cast_slice(&positions));
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3).map(|i| positions.iter().map(|position| position[i]).reduce(pick).unwrap_or_default()).collect()
        };
        self.accessors[position]["min"] = json!(bound(f32::min));
        self.accessors[position]["max"] = json!(bound(f32::max));
        let mut attributes = json!({ "POSITION": position });
        if part.has_normals {
            let normals: Vec<[f32; 3]> = vertices.iter().map(|vertex| obj.normals[vertex[2] as usize]).collect();
            attributes["NORMAL"] = self.add("VEC3", vertices.len(), 34962, bytemuck::cast_slice(&normals)).into();
        }
        if part.has_texcoords {
            // v grows up in an OBJ, and down in glTF.
            let turned = |vertex: &Corner| {
                let [u, v] = obj.texcoords[vertex[1] as usize];
                [u, 1.0 - v]
            };
            let texcoords: Vec<[f32; 2]> = vertices.iter().map(turned).collect();
            attributes["TEXCOORD_0"] = self.add("VEC2", vertices.len(), 34962, bytemuck::cast_slice(&texcoords)).into();
        }
        if obj.colors.len() == obj.positions.len() {
            let colors: Vec<[f32; 3]> = vertices.iter().map(|vertex| obj.colors[vertex[0] as usize]).collect();
            attributes["COLOR_0"] = self.add("VEC3", vertices.len(), 34962, bytemuck::cast_slice(&colors)).into();
        }
        let indices_at = self.add("SCALAR", indices.len(), 34963, bytemuck::cast_slice(&indices));
        self.accessors[indices_at]["componentType"] = 5125.into();
        Ok(json!({ "attributes": attributes, "indices": indices_at }))
    }

    fn add(&mut self, type_: &str, count: usize, target: u32, bytes: &[u8]) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len(), "target": target
        }));
        self.bytes.extend_from_slice(bytes);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": 5126, "count": count, "type": type_
        }));
        self.accessors.len() - 1
    }
}
