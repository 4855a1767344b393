//! Damaged models: an answer or a reason, never a panic.

use super::Builder;
use super::builder::{F32, POSITIONS, TRIANGLES, U8, U16};
use crate::io::damage::{MAX_BYTES, assert_no_panic, variants};
use crate::io::support::{Folder, Noise};
use serde_json::{Value, json};
use std::path::Path;
use texbake::io::{Model, ModelReadOptions};
use texbake::{Baker, Error, TangentOptions};

/// Two primitives with sparse, interleaved and quantised attributes, morph targets, strips and old tangents.
fn sample() -> Builder {
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

/// Reads a model, computes all its tangents, and writes it in both formats.
fn convert(path: &Path) -> Result<(), Error> {
    let mut model = Model::read_with(path, &ModelReadOptions { all: true, max_bytes: MAX_BYTES })?;
    for primitive in 0..model.primitives().len() {
        let mesh = model.mesh(primitive)?;
        model.set_tangents(primitive, Baker::reference().tangents(&mesh, &TangentOptions::default())?)?;
    }
    model.write(path.with_file_name("out.glb"))?;
    // That of another file's model.
    let _ = std::fs::remove_file(path.with_file_name("out.bin"));
    model.write(path.with_file_name("out.gltf")).map(drop)
}

#[test]
fn damaged_bytes_never_panic() {
    let folder = Folder::new();
    let file = sample();
    folder.file("m.bin", &file.bin);
    let obj = "mtllib m.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
               usemtl a\nf 1/1/1 2/2/1 3/3/1 4/4/1\ng b\nusemtl b\nf 1/1 2/2 -1/-1\nf 2//1 3//1 4//1\n";
    folder.file("m.mtl", b"newmtl a\nKd 1 0 0\nmap_Bump -bm 1 a.png\nnewmtl b\nnorm b.png\n");
    let samples = [
        folder.file("m.glb", &file.glb()),
        folder.file("m.gltf", &file.gltf("m.bin")),
        folder.file("data.gltf", &file.gltf_with_data()),
        folder.file("m.obj", obj.as_bytes()),
    ];
    assert_no_panic(&samples, convert);
}

/// The numbers of a document, one after the other.
fn numbers<'a>(value: &'a mut Value, found: &mut Vec<&'a mut Value>) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| numbers(item, found)),
        Value::Object(fields) => fields.values_mut().for_each(|item| numbers(item, found)),
        Value::Number(_) => found.push(value),
        _ => {}
    }
}

#[test]
fn contradictions_never_panic() {
    let folder = Folder::new();
    let whole = sample();
    let mut noise = Noise(5);
    let others = [
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(5),
        json!(7),
        json!(255),
        json!(F32),
        json!(-1),
        json!(0.5),
        json!(1u64 << 31),
        json!(u64::MAX),
        json!(1e300),
        json!(null),
        json!("a"),
        json!([]),
        json!({}),
    ];
    let (mut converted, mut refused) = (0, 0);
    for _ in 0..variants() {
        let mut file = whole.clone();
        let mut found = Vec::new();
        numbers(&mut file.json, &mut found);
        for _ in 0..1 + noise.next() % 2 {
            let number = noise.next() as usize % found.len();
            *found[number] = others[noise.next() as usize % others.len()].clone();
        }
        let path = folder.file("m.glb", &file.glb());
        match std::panic::catch_unwind(|| convert(&path)) {
            Ok(Ok(())) => converted += 1,
            Ok(Err(error)) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
            Err(_) => panic!("{:#}", file.json),
        }
    }
    assert!(converted > 0 && refused > 0, "{converted} converted, {refused} refused");
}
