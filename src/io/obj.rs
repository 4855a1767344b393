//! OBJ files, made into what a .glb of the same meshes holds.
//!
//! Of materials, names, diffuse colours and normal maps are kept.

use super::gltf::{Buffer, Document, ModelFile, Origin, Uri, read_file, uri_of_path};
use crate::error::{Error, Result};
use serde_json::{Map, Value, json};
use std::io::Cursor;
use std::path::Path;

/// Triangles with one index for all that a corner has.
const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { triangulate: true, single_index: true, ignore_points: true, ignore_lines: true };

pub(super) fn read(path: &Path, max_bytes: u64) -> Result<Document> {
    let bytes = read_file(path, max_bytes)?;
    let files = vec![ModelFile::new(path, &bytes)];
    let materials_of = |name: &Path| {
        let folder = path.parent().unwrap_or("".as_ref());
        let bytes = read_file(&folder.join(name), max_bytes).map_err(|_| tobj::LoadError::OpenFileFailed)?;
        tobj::load_mtl_buf(&mut Cursor::new(bytes))
    };
    let (models, materials) = tobj::load_obj_buf(&mut Cursor::new(bytes), &OPTIONS, materials_of)
        .map_err(|error| Error::file(path, format!("it is not OBJ: {error}"), "export the model again"))?;
    // Without the materials, meshes are what they are.
    let materials = materials.unwrap_or_default();

    let mut this = Builder::default();
    for model in &models {
        this.add_mesh(&model.name, &model.mesh, materials.len());
    }
    if this.meshes.is_empty() {
        return Err(Error::file(path, "it has no faces", "export the model as polygons"));
    }
    let mut json = json!({
        "asset": { "version": "2.0", "generator": concat!("texbake ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": (0..this.meshes.len()).collect::<Vec<_>>() }],
        "nodes": (0..this.meshes.len()).map(|mesh| json!({ "mesh": mesh })).collect::<Vec<_>>(),
        "meshes": this.meshes,
        "accessors": this.accessors,
        "bufferViews": this.views,
        "buffers": [{ "byteLength": this.bytes.len() }],
    });
    add_materials(&mut json, path, &materials);
    let buffers = vec![Buffer { bytes: this.bytes, origin: Origin::Inside }];
    Ok(Document { path: path.into(), json, buffers, is_glb: false, files, more_chunks: Vec::new(), max_bytes })
}

#[derive(Default)]
struct Builder {
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    bytes: Vec<u8>,
}

impl Builder {
    fn add_mesh(&mut self, name: &str, mesh: &tobj::Mesh, materials: usize) {
        let vertices = mesh.positions.len() / 3;
        if mesh.indices.is_empty() || vertices == 0 {
            return;
        }
        let (positions, _) = mesh.positions.as_chunks::<3>();
        let position = self.add("VEC3", vertices, 34962, bytemuck::cast_slice(&mesh.positions));
        // A file may hold what is not finite: then the mesh is refused by name.
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3).map(|i| positions.iter().map(|position| position[i]).reduce(pick).unwrap_or_default()).collect()
        };
        self.accessors[position]["min"] = json!(bound(f32::min));
        self.accessors[position]["max"] = json!(bound(f32::max));
        let mut attributes = json!({ "POSITION": position });
        // Some faces of a group may have none; then all count as without.
        if mesh.normals.len() == mesh.positions.len() {
            attributes["NORMAL"] = self.add("VEC3", vertices, 34962, bytemuck::cast_slice(&mesh.normals)).into();
        }
        if mesh.texcoords.len() == 2 * vertices {
            // v grows up in an OBJ, and down in glTF.
            let turned: Vec<[f32; 2]> = mesh.texcoords.as_chunks().0.iter().map(|&[u, v]| [u, 1.0 - v]).collect();
            attributes["TEXCOORD_0"] = self.add("VEC2", vertices, 34962, bytemuck::cast_slice(&turned)).into();
        }
        let indices = self.add("SCALAR", mesh.indices.len(), 34963, bytemuck::cast_slice(&mesh.indices));
        self.accessors[indices]["componentType"] = 5125.into();
        let mut primitive = json!({ "attributes": attributes, "indices": indices });
        if let Some(material) = mesh.material_id.filter(|material| *material < materials) {
            primitive["material"] = material.into();
        }
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
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

fn add_materials(json: &mut Value, path: &Path, materials: &[tobj::Material]) {
    if materials.is_empty() {
        return;
    }
    let (mut textures, mut images) = (Vec::new(), Vec::new());
    let mut as_gltf = |material: &tobj::Material| {
        let mut fields = Map::new();
        fields.insert("name".into(), material.name.as_str().into());
        if let Some([r, g, b]) = material.diffuse.filter(|colour| colour.iter().all(|part| (0.0..=1.0).contains(part)))
        {
            let factors = json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0 });
            fields.insert("pbrMetallicRoughness".into(), factors);
        }
        let texture = material.normal_texture.as_ref().or_else(|| material.unknown_param.get("norm"));
        // The last word is the file, options stand before it. A texture that is not there would be a broken model.
        if let Some(name) = texture.and_then(|texture| image_below(path, texture.split_whitespace().last()?)) {
            fields.insert("normalTexture".into(), json!({ "index": textures.len() }));
            textures.push(json!({ "source": images.len() }));
            images.push(json!({ "uri": name }));
        }
        Value::Object(fields)
    };
    let materials: Vec<Value> = materials.iter().map(&mut as_gltf).collect();
    json["materials"] = materials.into();
    if !textures.is_empty() {
        json["textures"] = textures.into();
        json["images"] = images.into();
    }
}

/// The URI of an image that glTF takes, if it lies below the model's folder.
fn image_below(path: &Path, name: &str) -> Option<String> {
    let name = name.replace('\\', "/");
    let is_image = [".png", ".jpg", ".jpeg"].iter().any(|ending| name.to_ascii_lowercase().ends_with(ending));
    let uri = uri_of_path(&name);
    match Uri::of(&uri) {
        Uri::Relative(below) if is_image && path.with_file_name(&below).is_file() => Some(uri),
        _ => None,
    }
}
