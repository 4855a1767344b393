//! glTF documents made by hand.

use base64::Engine;
use serde_json::{Value, json};
use texbake::io::{Model, ModelReadOptions};
use texbake::{Mesh, TangentReport, Tangents};

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A unit square, of which u grows along x and v against y.
pub const POSITIONS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
pub const TEXCOORDS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
pub const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

/// A document with one buffer.
#[derive(Clone)]
pub struct Builder {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Builder {
    /// A document with a material (0) that has a normal map.
    pub fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [] }],
            "nodes": [],
            "meshes": [],
            "materials": [{ "normalTexture": { "index": 0 } }],
            "textures": [{ "source": 0 }],
            "images": [{ "uri": image_uri() }],
            "accessors": [],
            "bufferViews": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// The square without indices or normals, and its position's and texture coordinate's accessors.
    pub fn square() -> (Self, usize, usize) {
        let mut this = Self::new();
        let position = this.positions(&POSITIONS);
        let texcoord = this.floats(&TEXCOORDS);
        (this, position, texcoord)
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend_from_slice(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    pub fn accessor(&mut self, accessor: Value) -> usize {
        push(&mut self.json["accessors"], accessor)
    }

    /// An accessor with a view of its own.
    pub fn elements(&mut self, component: u32, type_: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.accessor(json!({ "bufferView": view, "componentType": component, "count": count, "type": type_ }))
    }

    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let type_ = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N];
        self.elements(F32, type_, values.len(), bytemuck::cast_slice(values.as_flattened()))
    }

    pub fn positions(&mut self, values: &[[f32; 3]]) -> usize {
        let accessor = self.floats(values);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3).map(|i| values.iter().map(|value| value[i]).reduce(pick).unwrap()).collect()
        };
        self.json["accessors"][accessor]["min"] = json!(bound(f32::min));
        self.json["accessors"][accessor]["max"] = json!(bound(f32::max));
        accessor
    }

    pub fn indices(&mut self, component: u32, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = match component {
            U8 => indices.iter().map(|&index| index as u8).collect(),
            U16 => indices.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect(),
            _ => indices.iter().flat_map(|&index| index.to_le_bytes()).collect(),
        };
        self.elements(component, "SCALAR", indices.len(), &bytes)
    }

    /// A mesh of one primitive, in a node of its own.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        let mesh = push(&mut self.json["meshes"], json!({ "primitives": [primitive] }));
        let node = push(&mut self.json["nodes"], json!({ "mesh": mesh }));
        push(&mut self.json["scenes"][0]["nodes"], node.into());
        mesh
    }

    /// JSON with the buffer at this URI.
    pub fn gltf(&self, uri: &str) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "uri": uri, "byteLength": self.bin.len() }]);
        serde_json::to_vec(&json).unwrap()
    }

    /// JSON with the buffer in it.
    pub fn gltf_with_data(&self) -> Vec<u8> {
        self.gltf(&data_uri(&self.bin))
    }

    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if !self.bin.is_empty() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        glb(&json, &self.bin)
    }

    /// The model that the document is.
    pub fn model(&self) -> Model {
        self.model_with(&ModelReadOptions::default())
    }

    pub fn model_with(&self, options: &ModelReadOptions) -> Model {
        let folder = super::super::support::Folder::new();
        Model::read_with(folder.file("m.glb", &self.glb()), options).unwrap()
    }

    /// The mesh of its only primitive.
    pub fn read(&self) -> Mesh {
        let model = self.model();
        assert_eq!(model.primitives().len(), 1);
        model.mesh(0).unwrap()
    }
}

pub fn push(list: &mut Value, item: Value) -> usize {
    let list = list.as_array_mut().unwrap();
    list.push(item);
    list.len() - 1
}

pub fn data_uri(bytes: &[u8]) -> String {
    let text = base64::engine::general_purpose::STANDARD.encode(bytes);
    format!("data:application/octet-stream;base64,{text}")
}

/// A .glb with padded chunks; without a BIN chunk if there is nothing in it.
pub fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = serde_json::to_vec(json).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut chunks = [&(json.len() as u32).to_le_bytes()[..], b"JSON", &json].concat();
    if !bin.is_empty() {
        chunks.extend([&(bin.len() as u32).to_le_bytes()[..], b"BIN\0", &bin].concat());
    }
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

/// The JSON and the BIN chunk of a .glb, of which every length is checked.
pub fn split_glb(file: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&file[..4], word(4), word(8)), (&b"glTF"[..], 2, file.len()));
    let json_length = word(12);
    assert_eq!((&file[16..20], json_length % 4), (&b"JSON"[..], 0));
    let json = &file[20..20 + json_length];
    assert!(json.trim_ascii_end().len() + 4 > json.len(), "padded by spaces");
    let json = serde_json::from_slice(json).unwrap();
    let rest = 20 + json_length;
    if rest == file.len() {
        return (json, Vec::new());
    }
    assert_eq!((word(rest) % 4, &file[rest + 4..rest + 8]), (0, &b"BIN\0"[..]));
    (json, file[rest + 8..rest + 8 + word(rest)].to_vec())
}

/// The bytes of an accessor with a view of its own, without padding between elements.
pub fn bytes_of(json: &Value, bin: &[u8], accessor: usize) -> Vec<u8> {
    let accessor = &json["accessors"][accessor];
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let number = |object: &Value, field: &str| object[field].as_u64().unwrap_or(0) as usize;
    let component = match number(accessor, "componentType") as u32 {
        I8 | U8 => 1,
        I16 | U16 => 2,
        _ => 4,
    };
    let components = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        type_ => type_[3..].parse::<usize>().unwrap(),
    };
    let size = component * components;
    let stride = view["byteStride"].as_u64().map_or(size, |stride| stride as usize);
    let begin = number(view, "byteOffset") + number(accessor, "byteOffset");
    (0..number(accessor, "count")).flat_map(|i| bin[begin + i * stride..][..size].to_vec()).collect()
}

/// Tangents of a mesh whose vertices stay as they are.
pub fn unsplit(tangents: Vec<[f32; 4]>) -> Tangents {
    Tangents { tangents, normals: None, copies: Vec::new(), triangles: None, report: TangentReport::default() }
}

/// One white texel.
fn image_uri() -> String {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[128, 128, 255]).unwrap();
    data_uri(&file).replace("application/octet-stream", "image/png")
}
