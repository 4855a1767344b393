//! A small model of every kind.

use super::Builder;
use super::builder::{POSITIONS, TRIANGLES, U8, U16};
use crate::io::support::Folder;
use serde_json::json;
use std::path::PathBuf;

/// Polygons, groups, materials and numbers that count backwards; its library is [`MTL`].
pub const OBJ: &str = "mtllib m.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
    usemtl a\nf 1/1/1 2/2/1 3/3/1 4/4/1\ng b\nusemtl b\nf 1/1 2/2 -1/-1\nf 2//1 3//1 4//1\n";

/// Materials with colours and maps.
pub const MTL: &str = "newmtl a\nKd 1 0 0\nmap_Bump -bm 1 a.png\nnewmtl b\nnorm b.png\n";

/// A .glb, a .gltf with its buffer beside it, one with it in a data URI, and an OBJ with its materials.
pub fn models(folder: &Folder) -> Vec<PathBuf> {
    let file = sample();
    folder.file("m.bin", &file.bin);
    folder.file("m.mtl", MTL.as_bytes());
    vec![
        folder.file("m.glb", &file.glb()),
        folder.file("m.gltf", &file.gltf("m.bin")),
        folder.file("data.gltf", &file.gltf_with_data()),
        folder.file("m.obj", OBJ.as_bytes()),
    ]
}

/// Two primitives with sparse, interleaved and quantised attributes, morph targets, strips and old tangents.
pub fn sample() -> Builder {
    let (mut file, position, texcoord) = Builder::square();
    let sparse_indices = file.view(&[1, 3]);
    let sparse_values = file.view(bytemuck::cast_slice(&POSITIONS[..2]));
    file.json["accessors"][position]["sparse"] = json!({
        "count": 2, "indices": { "bufferView": sparse_indices, "componentType": U8 },
        "values": { "bufferView": sparse_values }
    });
    let words: Vec<u8> = (0..32).map(|word: u8| word.wrapping_mul(37)).collect();
    let view = file.view(&words);
    file.json["bufferViews"][view]["byteStride"] = 8.into();
    let packed = file.accessor(json!({
        "bufferView": view, "componentType": U16, "normalized": true, "count": 4, "type": "VEC2", "byteOffset": 4
    }));
    let normal = file.floats(&[[0.0, 0.0, 1.0]; 4]);
    let tangent = file.floats(&[[1.0, 0.0, 0.0, 1.0]; 4]);
    let indices = file.indices(U16, TRIANGLES.as_flattened());
    file.json["materials"][0]["normalTexture"]["extensions"] =
        json!({ "KHR_texture_transform": { "offset": [0.5, 0.25], "rotation": 1.5, "scale": [2, -3], "texCoord": 1 } });
    let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texcoord, "TEXCOORD_1": packed });
    let targets = json!([{ "POSITION": position, "TANGENT": normal }]);
    file.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0, "targets": targets }));
    let attributes = json!({ "POSITION": position, "TEXCOORD_1": packed, "TANGENT": tangent });
    file.mesh(json!({ "attributes": attributes, "material": 0, "mode": 5 }));
    file
}
