//! Meshes out of every layout that glTF has for them.

use super::Builder;
use super::builder::{F32, I8, I16, POSITIONS, TEXCOORDS, TRIANGLES, U8, U16, U32, data_uri, glb};
use crate::io::support::Folder;
use serde_json::json;
use texbake::io::{LeftOut, Model, ModelReadOptions, ModelReport, Primitive};

#[test]
fn every_type_of_indices_and_none() {
    for component in [U8, U16, U32] {
        let (mut file, position, texcoord) = Builder::square();
        let normal = file.floats(&[[0.0, 0.0, 1.0]; 4]);
        let indices = file.indices(component, TRIANGLES.as_flattened());
        let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texcoord });
        file.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
        let mesh = file.read();
        assert_eq!((mesh.positions(), mesh.texcoords()), (&POSITIONS[..], &TEXCOORDS[..]));
        assert_eq!(mesh.normals(), Some(&[[0.0, 0.0, 1.0]; 4][..]));
        assert_eq!(mesh.triangles(), TRIANGLES);
    }

    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let mesh = file.read();
    // The fourth vertex begins a triangle that is not there.
    assert_eq!((mesh.triangles(), mesh.normals()), (&[[0, 1, 2]][..], None));
}

#[test]
fn strips_and_fans() {
    let triangles = |mode: u32, indices: Option<&[u32]>| {
        let (mut file, position, texcoord) = Builder::square();
        let mut primitive = json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 });
        primitive["mode"] = mode.into();
        if let Some(indices) = indices {
            primitive["indices"] = file.indices(U8, indices).into();
        }
        file.mesh(primitive);
        file.read().triangles().to_vec()
    };
    assert_eq!(triangles(5, None), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(triangles(6, None), [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(triangles(5, Some(&[3, 2, 1, 0])), [[3, 2, 1], [2, 0, 1]]);
    assert_eq!(triangles(6, Some(&[2, 3, 0, 1])), [[3, 0, 2], [0, 1, 2]]);
    // Two strips, joined by triangles without area.
    let joined = [[0, 1, 2], [1, 2, 2], [2, 2, 2], [2, 3, 2], [2, 3, 0]];
    assert_eq!(triangles(5, Some(&[0, 1, 2, 2, 2, 3, 0])), joined);
    assert_eq!(triangles(4, Some(&[0, 1, 2, 0, 2])), [[0, 1, 2]]);
}

#[test]
fn interleaved_attributes() {
    let mut file = Builder::new();
    // What is another's, then vertices of 24 bytes each.
    let mut bytes = vec![0xee; 8];
    for (position, texcoord) in POSITIONS.iter().zip(&TEXCOORDS) {
        bytes.extend_from_slice(bytemuck::cast_slice(position));
        bytes.extend_from_slice(bytemuck::cast_slice(texcoord));
        bytes.extend_from_slice(&[0xdd; 4]);
    }
    // The last stride is cut where its last element ends.
    bytes.truncate(bytes.len() - 4);
    let view = file.view(&bytes);
    file.json["bufferViews"][view]["byteStride"] = 24.into();
    let mut attribute = |offset: usize, type_: &str| {
        let [view, component] = [view as u32, F32];
        file.accessor(json!({
            "bufferView": view, "byteOffset": offset, "componentType": component, "count": 4, "type": type_
        }))
    };
    let [position, texcoord] = [attribute(8, "VEC3"), attribute(20, "VEC2")];
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0, "mode": 5 }));
    let mesh = file.read();
    assert_eq!((mesh.positions(), mesh.texcoords()), (&POSITIONS[..], &TEXCOORDS[..]));
}

#[test]
fn quantised_attributes() {
    let read = |component: u32, is_normalized: bool, words: [i32; 3]| {
        let mut file = Builder::new();
        let size = if matches!(component, I8 | U8) { 1 } else { 2 };
        let mut attribute = |type_: &str, components: usize| {
            let stride = (components * size).next_multiple_of(4);
            let mut bytes = Vec::new();
            for vertex in 0..3 {
                let begin = bytes.len();
                for word in words.iter().cycle().skip(vertex).take(components) {
                    bytes.extend_from_slice(&word.to_le_bytes()[..size]);
                }
                bytes.resize(begin + stride, 0xee);
            }
            let view = file.view(&bytes);
            file.json["bufferViews"][view]["byteStride"] = stride.into();
            file.accessor(json!({
                "bufferView": view, "componentType": component, "normalized": is_normalized, "count": 3, "type": type_
            }))
        };
        let [position, texcoord] = [attribute("VEC3", 3), attribute("VEC2", 2)];
        let attributes = json!({ "POSITION": position, "NORMAL": position, "TEXCOORD_0": texcoord });
        file.mesh(json!({ "attributes": attributes, "material": 0 }));
        let mesh = file.read();
        let [[a, b, c], [d, e, f], [g, h, i]] = mesh.positions()[..] else { panic!("three vertices") };
        // Each vertex begins one word later.
        assert_eq!([d, e, f, g, h, i], [b, c, a, c, a, b]);
        assert_eq!(mesh.texcoords(), [[a, b], [b, c], [c, a]]);
        assert_eq!(mesh.normals(), Some(mesh.positions()));
        [a, b, c]
    };
    assert_eq!(read(I8, true, [-128, -127, 64]), [-1.0, -1.0, 64.0 / 127.0]);
    assert_eq!(read(U8, true, [0, 255, 51]), [0.0, 1.0, 0.2]);
    assert_eq!(read(I16, true, [-32768, 32767, -1]), [-1.0, 1.0, -1.0 / 32767.0]);
    assert_eq!(read(U16, true, [65535, 13107, 1]), [1.0, 0.2, 1.0 / 65535.0]);
    assert_eq!(read(I8, false, [-128, 127, 3]), [-128.0, 127.0, 3.0]);
    assert_eq!(read(U8, false, [255, 0, 128]), [255.0, 0.0, 128.0]);
    assert_eq!(read(I16, false, [-32768, 32767, 5]), [-32768.0, 32767.0, 5.0]);
    assert_eq!(read(U16, false, [65535, 1, 0]), [65535.0, 1.0, 0.0]);
}

#[test]
fn sparse_attributes() {
    for (index_type, with_view) in [(U8, true), (U16, false), (U32, true)] {
        let (mut file, _, texcoord) = Builder::square();
        let base = file.view(bytemuck::cast_slice(&[[7.0f32; 3]; 4]));
        let index_bytes: Vec<u8> = match index_type {
            U8 => vec![1, 3],
            U16 => vec![1, 0, 3, 0],
            _ => vec![1, 0, 0, 0, 3, 0, 0, 0],
        };
        let indices = file.view(&index_bytes);
        let values = file.view(bytemuck::cast_slice(&[9.0f32, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        let mut accessor = json!({
            "componentType": F32, "count": 4, "type": "VEC3",
            "sparse": {
                "count": 2,
                "indices": { "bufferView": indices, "componentType": index_type },
                "values": { "bufferView": values, "byteOffset": 4 }
            }
        });
        if with_view {
            accessor["bufferView"] = base.into();
        }
        let position = file.accessor(accessor);
        file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
        let other = if with_view { 7.0 } else { 0.0 };
        assert_eq!(file.read().positions(), [[other; 3], [1.0, 2.0, 3.0], [other; 3], [4.0, 5.0, 6.0]]);
    }
}

/// The texture coordinates that a normal map with this texture information gets; the second set is the first plus 10.
fn texcoords(texture: serde_json::Value) -> Vec<[f32; 2]> {
    let (mut file, position, texcoord) = Builder::square();
    let second = file.floats(&TEXCOORDS.map(|[u, v]| [u + 10.0, v + 10.0]));
    file.json["materials"][0]["normalTexture"] = texture;
    let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord, "TEXCOORD_1": second });
    file.mesh(json!({ "attributes": attributes, "material": 0 }));
    file.read().texcoords().to_vec()
}

#[test]
fn the_normal_map_says_which_texture_coordinates() {
    assert_eq!(texcoords(json!({ "index": 0 })), TEXCOORDS);
    assert_eq!(texcoords(json!({ "index": 0, "texCoord": 1 })), [[10., 11.], [11., 11.], [11., 10.], [10., 10.]]);
    let transformed = |transform: serde_json::Value, set: u32| {
        texcoords(json!({ "index": 0, "texCoord": set, "extensions": { "KHR_texture_transform": transform } }))
    };
    assert_eq!(transformed(json!({}), 0), TEXCOORDS);
    assert_eq!(transformed(json!({ "texCoord": 1 }), 0)[0], [10.0, 11.0]);
    assert_eq!(transformed(json!({ "texCoord": 0 }), 1), TEXCOORDS);
    let moved = transformed(json!({ "offset": [0.5, -2.0], "scale": [2.0, -4.0] }), 0);
    assert_eq!(moved, [[0.5, -6.0], [2.5, -6.0], [2.5, -2.0], [0.5, -2.0]]);
    // A quarter turn counterclockwise as the image is seen, its rows growing downwards: right becomes up.
    let turned = transformed(json!({ "rotation": std::f64::consts::FRAC_PI_2 }), 0);
    let expected = [[1.0, 0.0], [1.0, -1.0], [0.0, -1.0], [0.0, 0.0]];
    for (turned, expected) in turned.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((turned - expected).abs() < 1e-7, "{turned} is not {expected}");
    }
    // The specification's example shows the lower left quarter of the image.
    let example = json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5] });
    for [u, v] in transformed(example, 0) {
        assert!((-1e-7..=0.5000001).contains(&u) && (0.4999999..=1.0000001).contains(&v), "({u}, {v})");
    }
}

#[test]
fn what_stands_for_a_normal_map() {
    let read = |material: serde_json::Value, primitive_extensions: serde_json::Value| {
        let (mut file, position, texcoord) = Builder::square();
        let second = file.floats(&[[5.0, 5.0]; 4]);
        file.json["materials"] = json!([material, { "normalTexture": { "index": 0, "texCoord": 1 } }]);
        let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord, "TEXCOORD_1": second });
        file.mesh(json!({ "attributes": attributes, "material": 0, "extensions": primitive_extensions }));
        let model = file.model();
        (!model.primitives().is_empty()).then(|| model.mesh(0).unwrap().texcoords()[0])
    };
    let clearcoat = json!({ "clearcoatNormalTexture": { "index": 0, "texCoord": 1 } });
    let clearcoat = |base: serde_json::Value| {
        let mut material = base;
        material["extensions"] = json!({ "KHR_materials_clearcoat": clearcoat });
        material
    };
    assert_eq!(read(json!({}), json!({})), None);
    assert_eq!(read(clearcoat(json!({})), json!({})), Some([5.0, 5.0]));
    assert_eq!(read(clearcoat(json!({ "normalTexture": { "index": 0 } })), json!({})), Some([0.0, 1.0]));
    let anisotropy = json!({ "KHR_materials_anisotropy": { "anisotropyTexture": { "index": 0 } } });
    assert_eq!(read(json!({ "extensions": anisotropy }), json!({})), Some([0.0, 1.0]));
    let variants = json!({ "KHR_materials_variants": { "mappings": [{ "material": 1, "variants": [0] }] } });
    assert_eq!(read(json!({}), variants), Some([5.0, 5.0]));
}

#[test]
fn doubtful_files_are_read_with_a_warning() {
    let (mut file, position, texcoord) = Builder::square();
    let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
    file.mesh(json!({ "attributes": attributes, "material": 0 }));
    file.json["extensionsRequired"] = json!(["VENDOR_b", "KHR_texture_transform", "KHR_mesh_quantization"]);
    let expected = [
        "it requires what texbake does not know, and leaves as it is: VENDOR_b",
        "mesh 0, primitive 0: its 4 corners are no whole triangles; the last 1 are not used",
    ];
    assert_eq!(file.model().warnings(), expected);

    // A byte order mark before the JSON.
    let folder = super::super::support::Folder::new();
    let marked = [b"\xef\xbb\xbf", &file.gltf_with_data()[..]].concat();
    assert_eq!(Model::read(folder.file("m.gltf", &marked)).unwrap().primitives().len(), 1);
    let message = Model::read(folder.file("m.gltf", b"\x89PNG\r\n")).unwrap_err().to_string();
    assert!(message.ends_with("m.gltf: it is no model; texbake reads .glb, .gltf and .obj"), "{message}");
}

#[test]
fn what_gets_none_is_listed_with_the_reason() {
    let (mut file, position, texcoord) = Builder::square();
    let both = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
    file.json["materials"] = json!([
        { "normalTexture": { "index": 0 } },
        {},
        { "normalTexture": { "index": 0, "texCoord": 2 } },
    ]);
    let two = file.indices(U8, &[0, 1]);
    file.mesh(json!({ "attributes": both, "material": 0 }));
    file.json["meshes"][0]["name"] = "a \"square\"".into();
    for primitive in [
        json!({ "attributes": both, "material": 0, "mode": 0 }),
        json!({ "attributes": both, "material": 0, "mode": 3 }),
        json!({ "attributes": both, "material": 1 }),
        json!({ "attributes": both }),
        json!({ "attributes": both, "material": 2 }),
        json!({ "attributes": { "POSITION": position }, "material": 0 }),
        json!({ "attributes": { "TEXCOORD_0": texcoord }, "material": 0 }),
        json!({ "attributes": both, "material": 0, "indices": two }),
        // The same, and the same but for its mode.
        json!({ "attributes": both, "material": 0, "mode": 4 }),
        json!({ "attributes": both, "material": 0, "mode": 5 }),
    ] {
        file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }
    let model = file.model();
    let name = |number: u32| format!("mesh 0 \"a \\\"square\\\"\", primitive {number}");
    let expected =
        [(0, 2), (10, 1)].map(|(number, shared_by)| Primitive { name: name(number), shared_by, had_tangents: 0 });
    assert_eq!(model.primitives(), expected);
    let left_out = |(number, reason): (u32, &str)| LeftOut { name: name(number), reason: reason.into() };
    let mut expected = [
        (1, "it is made of points, which have no tangents"),
        (2, "it is made of lines, which have no tangents"),
        (3, "its material has no normal map (--all takes it too)"),
        (4, "its material has no normal map (--all takes it too)"),
        (5, "it has no TEXCOORD_2, which its normal map uses"),
        (6, "it has no TEXCOORD_0, which its normal map uses"),
        (7, "it has no POSITION"),
        (8, "it has no triangle"),
    ]
    .map(left_out)
    .to_vec();
    assert_eq!(model.left_out(), expected);
    assert_eq!(model.report(), ModelReport { primitives: 2, shared: 1, left_out: 8 });

    let model = file.model_with(&ModelReadOptions { all: true, ..Default::default() });
    expected.drain(2..4);
    assert_eq!(model.left_out(), expected);
    assert_eq!(model.report(), ModelReport { primitives: 2, shared: 3, left_out: 6 });
}

#[test]
fn buffers_beside_the_file_in_it_and_in_chunks() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0, "mode": 6 }));
    std::fs::create_dir(folder.path("data")).unwrap();
    folder.file("data/b é.bin", &file.bin);
    let paths = [
        folder.file("m.glb", &file.glb()),
        // The first bytes say which format it is.
        folder.file("glb.gltf", &file.glb()),
        folder.file("data.gltf", &file.gltf_with_data()),
        folder.file("beside.gltf", &file.gltf("data/b%20%C3%A9.bin")),
        folder.file("beside_raw.gltf", &file.gltf("data/b é.bin")),
        folder.file("chunkless.glb", &glb(&serde_json::from_slice(&file.gltf_with_data()).unwrap(), &[])),
        folder.file("beside.glb", &glb(&serde_json::from_slice(&file.gltf("data/b%20é.bin")).unwrap(), &[])),
    ];
    for path in paths {
        let mesh = Model::read(&path).unwrap().mesh(0).unwrap();
        assert_eq!((mesh.positions(), mesh.texcoords()), (&POSITIONS[..], &TEXCOORDS[..]), "{}", path.display());
    }
    // A file without meshes is a model, too.
    let empty = folder.file("empty.glb", &glb(&json!({ "asset": { "version": "2.0" } }), &[]));
    assert_eq!(Model::read(empty).unwrap().report(), ModelReport::default());
    assert!(data_uri(&[]).ends_with("base64,"));
}
