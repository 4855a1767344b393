//! Models from files of any bytes.

use crate::explained::assert_explained;
use crate::memory::bounded;
use crate::{choice, file, path};
use std::path::Path;
use texbake::io::{Model, ModelReadOptions};
use texbake::{Baker, Error, Mesh, TangentMethod, TangentOptions};

/// The most bytes of a model's files, and of an attribute.
const MAX_BYTES: u64 = 8 << 20;

/// What a model, its meshes and their tangents may take.
const HELD_BYTES: usize = 128 << 20;

/// A .gltf or a .glb of these bytes.
pub fn assert_gltf(extension: &str, data: &[u8]) {
    let Some((choice, bytes)) = choice(data) else { return };
    file("m.bin", &(0..=255).collect::<Vec<u8>>());
    assert_model(&file(&format!("m.{extension}"), bytes), choice);
}

/// An OBJ and its library of materials, which a zero byte parts.
pub fn assert_obj(data: &[u8]) {
    let Some((choice, bytes)) = choice(data) else { return };
    let (obj, mtl) = match bytes.iter().position(|byte| *byte == 0) {
        Some(at) => (&bytes[..at], &bytes[at + 1..]),
        None => (bytes, &[][..]),
    };
    file("m.mtl", mtl);
    file("a.png", b"\x89PNG");
    assert_model(&file("m.obj", obj), choice);
}

/// Reads a model, gives all its meshes tangents, writes it, and finds the same meshes in what was written.
fn assert_model(path: &Path, choice: usize) {
    let result = bounded(HELD_BYTES, || converted(path, choice));
    if let Err(error) = result {
        assert_explained(path, &error);
    }
}

fn converted(source: &Path, choice: usize) -> Result<(), Error> {
    let options = ModelReadOptions { all: choice % 2 == 0, max_bytes: MAX_BYTES };
    let method = [TangentMethod::Mikktspace, TangentMethod::Lengyel, TangentMethod::Hegde][choice / 2 % 3];
    let mut model = Model::read_with(source, &options)?;
    let mut meshes = Vec::new();
    for primitive in 0..model.primitives().len() {
        let mesh = model.mesh(primitive)?;
        let tangents = Baker::reference().tangents(&mesh, &TangentOptions { method, ..Default::default() })?;
        let copies = tangents.copies.len();
        assert_eq!(tangents.tangents.len(), mesh.positions().len() + copies);
        for tangent in &tangents.tangents {
            let length: f32 = tangent[..3].iter().map(|part| part * part).sum();
            assert!((length - 1.0).abs() < 1e-5 && tangent[3].abs() == 1.0, "{tangent:?} is no tangent");
        }
        model.set_tangents(primitive, tangents)?;
        meshes.push((mesh, copies));
    }
    for name in ["out.glb", "out.gltf"] {
        let out = path(name);
        for old in [&out, &path("out.bin"), &path("out_tangents.bin")] {
            let _ = std::fs::remove_file(old);
        }
        let written = model.write(&out)?;
        assert!(
            written.written.iter().all(|file| std::fs::metadata(&file.path).is_ok_and(|it| it.len() == file.bytes))
        );
        // All primitives of an OBJ get tangents; what nobody asked for in a glTF file may be as wrong as it was.
        let all = options.all || source.extension().is_some_and(|extension| extension == "obj");
        let options = ModelReadOptions { all, max_bytes: 64 << 20 };
        assert_same_meshes(&Model::read_with(&out, &options).expect("what was written is read"), &meshes);
    }
    Ok(())
}

/// The same vertices in the same order, copies behind them.
fn assert_same_meshes(again: &Model, meshes: &[(Mesh, usize)]) {
    assert_eq!(again.primitives().len(), meshes.len(), "as many primitives");
    for (number, (mesh, copies)) in meshes.iter().enumerate() {
        let found = again.mesh(number).expect("what was written is a mesh");
        let count = mesh.positions().len();
        assert_eq!(found.positions().len(), count + copies);
        assert!(found.positions()[..count] == *mesh.positions() && found.texcoords()[..count] == *mesh.texcoords());
        assert!(again.primitives()[number].had_tangents > 0, "it has tangents");
    }
}

/// Bytes in a data URI are the buffer; any other text is a buffer or a reason.
pub fn assert_data_uri(data: &[u8]) {
    use base64::Engine;
    let encoded = base64::engine::general_purpose::STANDARD.encode(data);
    let floats: Vec<[f32; 3]> = data.chunks_exact(12).map(|bytes| bytemuck::pod_read_unaligned(bytes)).collect();
    let document = |uri: &str, vertices: usize| {
        serde_json::json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "uri": uri, "byteLength": 12 * vertices }],
            "bufferViews": [{ "buffer": 0, "byteLength": 12 * vertices }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3" },
                { "componentType": 5126, "count": vertices, "type": "VEC2" }
            ],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } }] }]
        })
    };
    let read = |uri: &str, vertices| {
        let path = file("u.gltf", &serde_json::to_vec(&document(uri, vertices)).expect("keys are strings"));
        let model = Model::read_with(&path, &ModelReadOptions { all: true, max_bytes: MAX_BYTES });
        let mesh = model.and_then(|model| if vertices < 3 { Ok(None) } else { model.mesh(0).map(Some) });
        mesh.inspect_err(|error| assert_explained(&path, error))
    };
    let vertices = floats.len();
    let is_finite = floats.as_flattened().iter().all(|part| part.is_finite());
    for prefix in ["data:;base64,", "data:application/octet-stream;base64,", "data:application/gltf-buffer;base64,"] {
        match read(&format!("{prefix}{encoded}"), vertices) {
            Ok(mesh) => assert!(mesh.is_none_or(|mesh| mesh.positions() == floats), "the bytes of the URI"),
            Err(error) => assert!(vertices == 0 || !is_finite, "{error}"),
        }
    }
    // Whatever it is: an answer, or a reason.
    let text = String::from_utf8_lossy(data);
    let _ = read(&text, 3);
    let _ = read(&format!("data:{text}"), 3);
    let _ = read(&format!("data:;base64,{text}"), 3);
}
