//! Tangents put into files: what is new is written out here, and everything else is as it was.

use super::Builder;
use super::builder::{
    F32, POSITIONS, TEXCOORDS, TRIANGLES, U8, U16, U32, bytes_of, data_uri, glb, push, split_glb, unsplit,
};
use crate::io::support::Folder;
use serde_json::{Value, json};
use std::path::Path;
use texbake::io::Model;
use texbake::{Baker, TangentOptions, TangentReport, Tangents};

const TANGENTS: [[f32; 4]; 4] =
    [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, -1.0], [0.0, 0.0, 1.0, 1.0], [-1.0, 0.0, 0.0, -1.0]];

/// Vertices 2 and 0 of the square, copied.
fn split() -> Tangents {
    let tangents = [TANGENTS.to_vec(), vec![[0.0, -1.0, 0.0, 1.0], [0.0, 0.0, -1.0, 1.0]]].concat();
    Tangents {
        tangents,
        normals: None,
        copies: vec![2, 0],
        triangles: Some(vec![[0, 1, 2], [5, 4, 3]]),
        report: TangentReport::default(),
    }
}

/// The file after its primitives have got tangents.
fn written(file: &Builder, tangents: &[Tangents]) -> (Value, Vec<u8>) {
    let folder = Folder::new();
    let mut model = file.model();
    assert_eq!(model.primitives().len(), tangents.len());
    for (primitive, tangents) in tangents.iter().enumerate() {
        model.set_tangents(primitive, tangents.clone()).unwrap();
    }
    let path = folder.path("out.glb");
    model.write(&path).unwrap();
    assert_eq!(folder.names(), ["out.glb"]);
    let (json, bin) = split_glb(&std::fs::read(path).unwrap());
    assert_eq!(json["buffers"], json!([{ "byteLength": bin.len() }]));
    assert_eq!(bin[..file.bin.len()], file.bin, "bytes keep their place");
    (json, bin)
}

#[test]
fn nothing_is_added_where_nothing_changes() {
    let folder = Folder::new();
    let json = json!({ "asset": { "version": "2.0" } });
    let path = folder.file("m.gltf", &serde_json::to_vec(&json).unwrap());
    for name in ["n.glb", "n.gltf"] {
        Model::read(&path).unwrap().write(folder.path(name)).unwrap();
    }
    assert_same_json(&json_of(&folder.path("n.gltf")), &json);
    assert_same_json(&split_glb(&std::fs::read(folder.path("n.glb")).unwrap()).0, &json);
}

/// Compares JSON with the order of its fields.
fn assert_same_json(got: &Value, expected: &Value) {
    assert_eq!(serde_json::to_string_pretty(got).unwrap(), serde_json::to_string_pretty(expected).unwrap());
}

#[test]
fn nothing_else_changes() {
    let (mut file, position, texcoord) = Builder::square();
    let indices = file.indices(U8, TRIANGLES.as_flattened());
    let attributes = json!({ "TEXCOORD_0": texcoord, "POSITION": position });
    file.mesh(json!({ "material": 0, "indices": indices, "attributes": attributes, "extras": { "z": 1, "a": [0.1] } }));
    // Numbers with all their digits, an unknown extension anywhere, names in any order.
    file.json["nodes"][0]["matrix"] = json!([0.1, 1e-7, 123456789.12345679, 5e-324, 1e300, -0.0, 0, 3.0]);
    file.json["zzz"] = json!({ "b": null, "a": [true, "ü\u{1}\"", {}] });
    file.json["extensionsUsed"] = json!(["VENDOR_unknown"]);
    file.json["extensions"] = json!({ "VENDOR_unknown": { "b": [], "a": 18446744073709551615u64 } });

    let (json, bin) = written(&file, &[unsplit(TANGENTS.to_vec())]);
    let mut expected = file.json.clone();
    let begin = file.bin.len().next_multiple_of(4);
    let view = push(
        &mut expected["bufferViews"],
        json!({ "buffer": 0, "byteOffset": begin, "byteLength": 64, "target": 34962 }),
    );
    let accessor = push(
        &mut expected["accessors"],
        json!({ "componentType": F32, "count": 4, "type": "VEC4", "bufferView": view }),
    );
    expected["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = accessor.into();
    expected["buffers"] = json!([{ "byteLength": begin + 64 }]);
    assert_same_json(&json, &expected);
    assert_eq!(bin[begin..], *bytemuck::cast_slice::<_, u8>(&TANGENTS));
}

#[test]
fn a_model_without_new_tangents_is_written_as_it_was() {
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let folder = Folder::new();
    // A chunk that nobody knows, behind the others.
    let mut bytes = file.glb();
    bytes.extend_from_slice(&[4, 0, 0, 0, b'X', b'Y', b'Z', 0, 1, 2, 3, 4]);
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    let path = folder.file("m.glb", &bytes);
    Model::read(&path).unwrap().write(folder.path("copy.glb")).unwrap();
    assert_eq!(std::fs::read(folder.path("copy.glb")).unwrap(), bytes);
    // In place, too.
    let mut model = Model::read(&path).unwrap();
    model.set_tangents(0, unsplit(TANGENTS.to_vec())).unwrap();
    model.write(&path).unwrap();
    let result = std::fs::read(&path).unwrap();
    assert_eq!(result[result.len() - 12..], bytes[bytes.len() - 12..]);
    assert_eq!(Model::read(&path).unwrap().primitives().len(), 1);
}

#[test]
fn old_tangents_give_their_place_to_new_ones_unless_something_uses_them() {
    let primitive = |position: usize, texcoord: usize, tangent: usize| {
        let attributes = json!({ "POSITION": position, "TANGENT": tangent, "TEXCOORD_0": texcoord });
        json!({ "attributes": attributes, "material": 0 })
    };
    let (mut file, position, texcoord) = Builder::square();
    let tangent = file.floats(&[[9.0; 4]; 4]);
    file.json["accessors"][tangent]["name"] = "tangents".into();
    let other = file.floats(&[[3.0; 2]; 4]);
    file.mesh(primitive(position, texcoord, tangent));
    let (json, bin) = written(&file, &[unsplit(TANGENTS.to_vec())]);
    assert_eq!(json["meshes"], file.json["meshes"]);
    assert_eq!((json["accessors"].as_array().unwrap().len(), json["bufferViews"].as_array().unwrap().len()), (4, 4));
    assert_eq!(json["accessors"][tangent]["name"], "tangents");
    assert_eq!(json["accessors"][other], file.json["accessors"][other]);
    assert_eq!(bytes_of(&json, &bin, tangent), bytemuck::cast_slice::<_, u8>(&TANGENTS));

    // A primitive without a normal map keeps its own.
    let mut shared = file.clone();
    shared.json["materials"].as_array_mut().unwrap().push(json!({}));
    shared.mesh(primitive(position, texcoord, tangent));
    shared.json["meshes"][1]["primitives"][0]["material"] = 1.into();
    let (json, bin) = written(&shared, &[unsplit(TANGENTS.to_vec())]);
    assert_eq!(json["meshes"][1], shared.json["meshes"][1]);
    assert_eq!(bytes_of(&json, &bin, tangent), bytemuck::cast_slice::<_, u8>(&[9.0f32; 16]));
    assert_eq!(json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"], 4);
    assert_eq!(bytes_of(&json, &bin, 4), bytemuck::cast_slice::<_, u8>(&TANGENTS));

    // So does an extension that may mean it; the numbers of materials are none of accessors.
    for (name, is_kept) in [("VENDOR_unknown", true), ("KHR_materials_ior", false)] {
        let mut extended = file.clone();
        extended.json["materials"][0]["extensions"] = json!({ name: { "any": [{ "name": tangent }] } });
        let (json, bin) = written(&extended, &[unsplit(TANGENTS.to_vec())]);
        let old = bytes_of(&json, &bin, tangent);
        assert_eq!(old == bytemuck::cast_slice::<_, u8>(&[9.0f32; 16]), is_kept, "{name}");
    }
}

/// A square with everything that a vertex can have, each element another, and two morph targets.
fn rich() -> (Builder, Value) {
    let (mut file, position, texcoord) = Builder::square();
    let normal = file.floats(&[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
    let joints = file.elements(U8, "VEC4", 4, &(0..16).collect::<Vec<u8>>());
    let weights = file.elements(U16, "VEC4", 4, &(100..132).collect::<Vec<u8>>());
    file.json["accessors"][weights]["normalized"] = true.into();
    // Three bytes each, four apart.
    let view = file.view(&(200..216).collect::<Vec<u8>>());
    file.json["bufferViews"][view]["byteStride"] = 4.into();
    let color = file.accessor(json!({
        "name": "colours", "bufferView": view, "componentType": U8, "normalized": true, "count": 4, "type": "VEC3",
        "extras": 7
    }));
    let custom = file.elements(U16, "SCALAR", 4, &[1, 0, 2, 0, 3, 0, 4, 0]);
    let moved = file.positions(&[[0.0; 3], [0.0; 3], [0.0, 0.0, 2.0], [0.0; 3]]);
    let turned = file.floats(&[[0.0f32, 0.0, 0.5]; 4]);
    let indices = file.indices(U8, TRIANGLES.as_flattened());
    let attributes = json!({
        "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texcoord, "TEXCOORD_1": texcoord, "JOINTS_0": joints,
        "WEIGHTS_0": weights, "COLOR_0": color, "_CUSTOM": custom
    });
    let targets = json!([
        { "POSITION": moved, "NORMAL": turned, "TANGENT": turned },
        { "POSITION": moved, "TEXCOORD_0": texcoord }
    ]);
    (file, json!({ "attributes": attributes, "targets": targets, "indices": indices, "material": 0 }))
}

/// Elements of `size` bytes: those of vertices 0 to 3, and the copies of 2 and 0.
fn with_copies(elements: &[u8], size: usize) -> Vec<u8> {
    [0, 1, 2, 3, 2, 0].iter().flat_map(|vertex| &elements[vertex * size..][..size]).copied().collect()
}

#[test]
fn split_vertices_are_copied_with_all_they_have() {
    let (mut file, primitive) = rich();
    file.mesh(primitive.clone());
    let warning = "mesh 0, primitive 0: the tangents of its morph targets are dropped, for they were made for other \
                   tangents";
    assert_eq!(file.model().warnings(), [warning]);
    let (json, bin) = written(&file, &[split()]);

    let new = &json["meshes"][0]["primitives"][0];
    let accessor_of = |object: &Value, name: &str| object[name].as_u64().unwrap() as usize;
    let names: Vec<&String> = new["attributes"].as_object().unwrap().keys().collect();
    let mut expected: Vec<&String> = primitive["attributes"].as_object().unwrap().keys().collect();
    let tangent = "TANGENT".to_string();
    expected.push(&tangent);
    assert_eq!(names, expected);
    for (name, size) in [
        ("POSITION", 12),
        ("NORMAL", 12),
        ("TEXCOORD_0", 8),
        ("TEXCOORD_1", 8),
        ("JOINTS_0", 4),
        ("WEIGHTS_0", 8),
        ("COLOR_0", 3),
        ("_CUSTOM", 2),
    ] {
        let (old, new) = (accessor_of(&primitive["attributes"], name), accessor_of(&new["attributes"], name));
        let elements = bytes_of(&file.json, &file.bin, old);
        assert_eq!(bytes_of(&json, &bin, new), with_copies(&elements, size), "{name}");
        for field in ["componentType", "normalized", "type", "min", "max", "name", "extras"] {
            assert_eq!(json["accessors"][new][field], file.json["accessors"][old][field], "{field} of {name}");
        }
        let view = &json["bufferViews"][accessor_of(&json["accessors"][new], "bufferView")];
        let stride = if size % 4 == 0 { Value::Null } else { 4.into() };
        assert_eq!((&view["target"], &view["byteStride"]), (&34962.into(), &stride), "{name}");
    }
    assert_eq!(new["attributes"]["TEXCOORD_0"], new["attributes"]["TEXCOORD_1"], "shared as before");
    let tangents = bytes_of(&json, &bin, accessor_of(&new["attributes"], "TANGENT"));
    assert_eq!(tangents, bytemuck::cast_slice::<_, u8>(&split().tangents));

    let [moved, turned] = [12, 12].map(|size| move |bytes: &[u8]| with_copies(bytes, size));
    let old_targets = &primitive["targets"];
    for (target, names) in [(0, vec!["POSITION", "NORMAL"]), (1, vec!["POSITION", "TEXCOORD_0"])] {
        let got: Vec<&String> = new["targets"][target].as_object().unwrap().keys().collect();
        assert_eq!(got, names);
    }
    for (target, name, copied) in [(0, "POSITION", &moved as &dyn Fn(&[u8]) -> Vec<u8>), (0, "NORMAL", &turned)] {
        let elements = bytes_of(&file.json, &file.bin, accessor_of(&old_targets[target], name));
        assert_eq!(bytes_of(&json, &bin, accessor_of(&new["targets"][target], name)), copied(&elements));
    }
    assert_eq!(new["targets"][1]["TEXCOORD_0"], new["attributes"]["TEXCOORD_0"]);

    let indices = accessor_of(new, "indices");
    let words: Vec<u8> = [0u16, 1, 2, 5, 4, 3].iter().flat_map(|index| index.to_le_bytes()).collect();
    assert_eq!((&json["accessors"][indices]["componentType"], new.get("mode")), (&U16.into(), None));
    assert_eq!(bytes_of(&json, &bin, indices), words);
    // Every old accessor gave its place to a new one; one is more, for tangents.
    let count = |json: &Value, kind: &str| json[kind].as_array().unwrap().len();
    assert_eq!(count(&json, "accessors"), count(&file.json, "accessors") + 1);
    assert_eq!(count(&json, "bufferViews"), count(&file.json, "bufferViews") + 1);
}

#[test]
fn what_others_share_keeps_its_vertices() {
    let (mut file, primitive) = rich();
    file.json["materials"].as_array_mut().unwrap().push(json!({}));
    let mut other = primitive.clone();
    other["material"] = 1.into();
    file.mesh(other);
    file.mesh(primitive);
    let (json, bin) = written(&file, &[split()]);
    assert_eq!(json["meshes"][0], file.json["meshes"][0]);
    for accessor in 0..file.json["accessors"].as_array().unwrap().len() {
        assert_eq!(json["accessors"][accessor], file.json["accessors"][accessor]);
        assert_eq!(bytes_of(&json, &bin, accessor), bytes_of(&file.json, &file.bin, accessor));
    }
    let [new, old] = [1, 0].map(|mesh| json["meshes"][mesh]["primitives"][0]["attributes"].as_object().unwrap());
    assert!(old.iter().all(|(name, accessor)| new[name] != *accessor));
}

#[test]
fn primitives_that_are_the_same_share_the_result() {
    let (mut file, primitive) = rich();
    let mut without_color = primitive.clone();
    without_color["attributes"].as_object_mut().unwrap().remove("COLOR_0");
    file.mesh(primitive.clone());
    file.mesh(without_color);
    file.mesh(primitive);
    let (json, _) = written(&file, &[split()]);
    let attributes = |mesh: usize| &json["meshes"][mesh]["primitives"][0]["attributes"];
    assert_eq!(attributes(0), attributes(2));
    for name in ["POSITION", "TANGENT", "JOINTS_0"] {
        assert_eq!(attributes(0)[name], attributes(1)[name]);
    }
    assert_eq!(attributes(1).get("COLOR_0"), None);
    assert_eq!(json["meshes"][0], json["meshes"][2]);
}

#[test]
fn normals_that_were_made_are_written() {
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0, "mode": 6 }));
    let normals = vec![[0.0, 0.6, 0.8]; 4];
    let (json, bin) = written(&file, &[Tangents { normals: Some(normals.clone()), ..unsplit(TANGENTS.to_vec()) }]);
    let primitive = &json["meshes"][0]["primitives"][0];
    let expected = json!({ "POSITION": 0, "TEXCOORD_0": 1, "NORMAL": 2, "TANGENT": 3 });
    assert_eq!((&primitive["attributes"], &primitive["mode"]), (&expected, &6.into()));
    assert_eq!(bytes_of(&json, &bin, 2), bytemuck::cast_slice::<_, u8>(&normals));
    assert_eq!(json["accessors"][2]["type"], "VEC3");

    // Zero normals are replaced, in their place.
    let (mut file, position, texcoord) = Builder::square();
    let normal = file.floats(&[[0.0f32; 3]; 4]);
    let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texcoord });
    file.mesh(json!({ "attributes": attributes, "material": 0 }));
    let made = Tangents { normals: Some(vec![[0.0, 0.6, 0.8]; 6]), ..split() };
    let (json, bin) = written(&file, &[made]);
    assert_eq!(json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"], 2);
    assert_eq!(bytes_of(&json, &bin, 2), bytemuck::cast_slice::<_, u8>(&[[0.0f32, 0.6, 0.8]; 6]));
}

#[test]
fn split_strips_become_triangles_without_their_joints() {
    let (mut file, position, texcoord) = Builder::square();
    let indices = file.indices(U32, &[0, 1, 2, 2, 3, 0]);
    let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
    file.mesh(json!({ "attributes": attributes, "material": 0, "mode": 5, "indices": indices }));
    let mesh = file.read();
    assert_eq!(mesh.triangles(), [[0, 1, 2], [1, 2, 2], [2, 2, 3], [2, 0, 3]]);
    let triangles = vec![[0, 1, 2], [1, 2, 2], [2, 2, 3], [4, 5, 3]];
    let (json, bin) = written(&file, &[Tangents { triangles: Some(triangles), ..split() }]);
    let primitive = &json["meshes"][0]["primitives"][0];
    assert_eq!((&primitive["mode"], &primitive["indices"]), (&4.into(), &indices.into()));
    let words: Vec<u8> = [0u16, 1, 2, 4, 5, 3].iter().flat_map(|index| index.to_le_bytes()).collect();
    assert_eq!(bytes_of(&json, &bin, indices), words);
    assert_eq!(json["accessors"][indices]["count"], 6);
}

#[test]
fn indices_are_as_small_as_may_be() {
    let component = |vertices: usize| {
        let mut file = Builder::new();
        let position = file.positions(&vec![[0.0, 1.0, 2.0]; vertices]);
        let texcoord = file.floats(&vec![[0.0, 1.0]; vertices]);
        file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
        let last = vertices as u32;
        let tangents = Tangents {
            tangents: vec![[1.0, 0.0, 0.0, 1.0]; vertices + 1],
            normals: None,
            copies: vec![1],
            triangles: Some(vec![[0, 1, last]]),
            report: TangentReport::default(),
        };
        let (json, bin) = written(&file, &[tangents]);
        let indices = json["meshes"][0]["primitives"][0]["indices"].as_u64().unwrap() as usize;
        let bytes = bytes_of(&json, &bin, indices);
        let greatest = bytes.len() * 2 / 3;
        let mut word = [0; 4];
        word[..bytes.len() - greatest].copy_from_slice(&bytes[greatest..]);
        assert_eq!(u32::from_le_bytes(word), last);
        json["accessors"][indices]["componentType"].as_u64().unwrap() as u32
    };
    // With the copy 65535 vertices: the greatest index is 65534, and 65535 would restart a strip.
    assert_eq!([component(65534), component(65535)], [U16, U32]);
}

#[test]
fn tangents_of_another_mesh_are_refused() {
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let mut model = file.model();
    let mut message = |primitive: usize, tangents: Tangents| {
        model.set_tangents(primitive, tangents).expect_err("these are refused").to_string()
    };
    assert_eq!(message(1, unsplit(TANGENTS.to_vec())), "primitive is 1: it must be below 1");
    let three = "number of tangents is 3: it must be 4 and one for each copy";
    assert_eq!(message(0, unsplit(TANGENTS[..3].to_vec())), three);
    let copies = Tangents { copies: vec![2, 4], ..split() };
    assert_eq!(message(0, copies), "source of a copy is 4: it must be below 4");
    let triangles = Tangents { triangles: Some(vec![[0, 1, 6]]), ..split() };
    assert_eq!(message(0, triangles), "index is 6: it must be below 6, the number of tangents");
    let normals = Tangents { normals: Some(vec![[0.0; 3]; 4]), ..split() };
    assert_eq!(message(0, normals), "number of normals is 4: it must be 6, one for each tangent");
}

fn json_of(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// A model of one square: reads it, gives it tangents, and writes it.
fn convert(from: &Path, to: &Path) {
    let mut model = Model::read(from).unwrap();
    model.set_tangents(0, unsplit(TANGENTS.to_vec())).unwrap();
    model.write(to).unwrap();
}

/// The tangents of a model's first primitive, through its own files.
fn assert_tangents(path: &Path) {
    let as_glb = path.with_file_name("read back.glb");
    let model = Model::read(path).unwrap();
    assert_eq!(model.mesh(0).unwrap().positions(), POSITIONS);
    model.write(&as_glb).unwrap();
    let (json, bin) = split_glb(&std::fs::read(&as_glb).unwrap());
    std::fs::remove_file(as_glb).unwrap();
    let tangent = json["meshes"][0]["primitives"][0]["attributes"]["TANGENT"].as_u64().unwrap();
    assert_eq!(bytes_of(&json, &bin, tangent as usize), bytemuck::cast_slice::<_, u8>(&TANGENTS));
}

#[test]
fn gltf_stays_gltf_with_a_buffer_more() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let bin = folder.file("a b.bin", &file.bin);
    let path = folder.file("m.gltf", &file.gltf("a%20b.bin"));
    convert(&path, &path);
    assert_eq!(folder.names(), ["a b.bin", "m.gltf", "m_tangents.bin"]);
    assert_eq!(std::fs::read(bin).unwrap(), file.bin);
    assert_eq!(std::fs::read(folder.path("m_tangents.bin")).unwrap(), bytemuck::cast_slice::<_, u8>(&TANGENTS));
    let first = json_of(&path);
    let buffers = json!([
        { "uri": "a%20b.bin", "byteLength": file.bin.len() },
        { "uri": "m_tangents.bin", "byteLength": 64 }
    ]);
    assert_eq!(first["buffers"], buffers);
    assert_eq!(first["bufferViews"][2], json!({ "buffer": 1, "byteOffset": 0, "byteLength": 64, "target": 34962 }));
    assert_tangents(&path);
    // Again: nothing is left of the tangents of before.
    convert(&path, &path);
    assert_same_json(&json_of(&path), &first);
    assert_eq!(folder.names(), ["a b.bin", "m.gltf", "m_tangents.bin"]);

    // All in data URIs, before and after.
    let path = folder.file("data.gltf", &file.gltf_with_data());
    let out = folder.path("data_t.gltf");
    convert(&path, &out);
    assert_eq!(json_of(&out)["buffers"][1]["uri"], data_uri(bytemuck::cast_slice(&TANGENTS)));
    assert_eq!(json_of(&out)["buffers"][0], json_of(&path)["buffers"][0]);
    assert_tangents(&out);
    let once = json_of(&out);
    convert(&out, &out);
    assert_same_json(&json_of(&out), &once);
}

#[test]
fn a_file_that_is_in_use_keeps_its_name() {
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    for uri in ["m_tangents.bin", "./m_tangents.bin", "././m%5Ftangents.bin"] {
        let folder = Folder::new();
        let buffer = folder.file("m_tangents.bin", &file.bin);
        let path = folder.file("m.gltf", &file.gltf(uri));
        convert(&path, &path);
        assert_eq!(folder.names(), ["m.gltf", "m_tangents.bin", "m_tangents2.bin"], "{uri}");
        assert_eq!(std::fs::read(buffer).unwrap(), file.bin, "{uri}");
        assert_tangents(&path);
    }
}

#[test]
fn from_glb_to_gltf_and_back() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    file.json["images"] = json!([{ "uri": "https://example.com/a.png" }]);
    let path = folder.file("m.glb", &file.glb());
    let out = folder.path("o p.gltf");
    convert(&path, &out);
    assert_eq!(folder.names(), ["m.glb", "o p.bin", "o p.gltf"]);
    let json = json_of(&out);
    assert_eq!(json["buffers"], json!([{ "byteLength": file.bin.len() + 64, "uri": "o%20p.bin" }]));
    assert_tangents(&out);

    let again = folder.path("again.glb");
    Model::read(&out).unwrap().write(&again).unwrap();
    let (json, bin) = split_glb(&std::fs::read(&again).unwrap());
    assert_eq!(json["buffers"], json!([{ "byteLength": file.bin.len() + 64 }]));
    assert_eq!(bin, [&file.bin[..], bytemuck::cast_slice(&TANGENTS)].concat());
}

#[test]
fn several_buffers_become_one_chunk() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    // The texture coordinates move to a buffer of their own, behind five bytes that shift what follows.
    let begin = file.json["bufferViews"][1]["byteOffset"].as_u64().unwrap() as usize;
    let texcoords = file.bin.split_off(begin);
    file.json["bufferViews"][1] = json!({ "buffer": 2, "byteLength": 32 });
    folder.file("odd.bin", &[1, 2, 3, 4, 5]);
    let mut json: Value = serde_json::from_slice(&file.gltf_with_data()).unwrap();
    json["buffers"].as_array_mut().unwrap().extend([
        json!({ "uri": "odd.bin", "byteLength": 5 }),
        json!({ "uri": data_uri(&texcoords), "byteLength": 32 }),
    ]);
    json["images"] = json!([{ "uri": "data:image/png;base64,AQIDBAU=", "name": "five" }]);
    let path = folder.file("m.gltf", &serde_json::to_vec(&json).unwrap());
    let out = folder.path("m.glb");
    convert(&path, &out);
    assert_tangents(&out);
    let (json, bin) = split_glb(&std::fs::read(&out).unwrap());
    assert_eq!(json["buffers"], json!([{ "byteLength": 48 + 8 + 32 + 8 + 64 }]));
    assert_eq!(json["images"], json!([{ "name": "five", "bufferView": 3, "mimeType": "image/png" }]));
    assert_eq!(json["bufferViews"][3], json!({ "buffer": 0, "byteLength": 5, "byteOffset": 88 }));
    assert_eq!(bin[88..96], [1, 2, 3, 4, 5, 0, 0, 0]);
    assert_eq!(json["bufferViews"][1], json!({ "buffer": 0, "byteLength": 32, "byteOffset": 56 }));
    assert_eq!(bin[..56], [&file.bin[..], &[1, 2, 3, 4, 5, 0, 0, 0]].concat());
    assert_eq!(Model::read(&out).unwrap().mesh(0).unwrap().texcoords(), TEXCOORDS);

    // A .glb without a chunk gets one.
    let path =
        folder.file("chunkless.glb", &glb(&serde_json::from_slice(&file.gltf_with_data()).unwrap_or_default(), &[]));
    let mut json: Value = split_glb(&std::fs::read(&path).unwrap()).0;
    json["images"] = json!([{ "uri": "image.png" }]);
    json["bufferViews"][1] = json!({ "buffer": 1, "byteLength": 32 });
    push(&mut json["buffers"], json!({ "uri": data_uri(&texcoords), "byteLength": 32 }));
    let path = folder.file("chunkless.glb", &glb(&json, &[]));
    convert(&path, &path);
    assert_tangents(&path);
    assert_eq!(split_glb(&std::fs::read(&path).unwrap()).0["buffers"], json!([{ "byteLength": 48 + 32 + 64 }]));
}

#[test]
fn files_that_a_model_refers_to_go_with_it() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    file.json["images"] = json!([{ "uri": "maps/n%C3%A9.png" }, { "uri": "https://example.com/a.png" }]);
    for name in ["maps", "out"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    folder.file("maps/né.png", b"an image");
    folder.file("m.bin", &file.bin);
    let path = folder.file("m.gltf", &file.gltf("m.bin"));
    convert(&path, &folder.path("out/x.gltf"));
    assert_tangents(&folder.path("out/x.gltf"));
    let names = |name: &str| {
        let entries = std::fs::read_dir(folder.path(name)).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(names("out"), ["m.bin", "maps", "x.gltf", "x_tangents.bin"]);
    assert_eq!(std::fs::read(folder.path("out/maps/né.png")).unwrap(), b"an image");
    assert_eq!(std::fs::read(folder.path("out/m.bin")).unwrap(), file.bin);

    // A .glb takes its buffers along, but not its images.
    std::fs::create_dir(folder.path("binary")).unwrap();
    convert(&path, &folder.path("binary/x.glb"));
    assert_eq!(names("binary"), ["maps", "x.glb"]);
}

/// A model in a folder of its own, with an image in another one beside that.
fn with_image_above(folder: &Folder, name: &str) -> std::path::PathBuf {
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    file.json["images"] = json!([{ "uri": "../maps/n%20m.png", "name": "bumps" }]);
    for name in ["maps", "in"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    folder.file("maps/n m.png", b"\x89PNG\r");
    folder.file(name, &file.gltf_with_data())
}

#[test]
fn a_glb_made_of_gltf_stands_alone() {
    let folder = Folder::new();
    let path = with_image_above(&folder, "in/m.gltf");
    let mut model = Model::read(&path).unwrap();
    model.set_tangents(0, unsplit(TANGENTS.to_vec())).unwrap();
    let out = folder.path("new/folder/m.glb");
    let files = model.write(&out).unwrap();
    let (json, bin) = split_glb(&std::fs::read(&out).unwrap());
    assert_eq!(json["images"], json!([{ "name": "bumps", "bufferView": 3, "mimeType": "image/png" }]));
    let begin = json["bufferViews"][3]["byteOffset"].as_u64().unwrap() as usize;
    assert_eq!(json["bufferViews"][3]["byteLength"], 5);
    assert_eq!(bin[begin..begin + 5], *b"\x89PNG\r");
    assert_tangents(&out);
    let sizes: Vec<u64> = files.read.iter().chain(&files.written).map(|file| file.bytes).collect();
    let length = |path: &Path| std::fs::metadata(path).unwrap().len();
    assert_eq!(sizes, [length(&path), 5, length(&out)]);
    assert_eq!(files.written[0].path, out);

    // What is above the folder and no image is not put into a model that may be published.
    folder.file("maps/n m.png", b"a secret");
    let message = model.write(folder.path("none/m.glb")).unwrap_err().to_string();
    let expected = "m.gltf: it refers to \"../maps/n%20m.png\", which is not a file in its folder; write it into the \
                    folder it came from, or as .glb, which holds its images";
    assert!(message.ends_with(expected), "{message}");
    let message = model.write(folder.path("none/m.gltf")).unwrap_err().to_string();
    assert!(message.ends_with(expected), "{message}");
    assert_eq!(folder.names(), ["in", "maps", "new"], "nothing stays behind");
    model.write(folder.path("in/n.gltf")).unwrap();
}

#[test]
fn files_that_the_user_did_not_name_stay() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    file.json["images"] = json!([{ "uri": "n.png" }]);
    for name in ["in", "out"] {
        std::fs::create_dir(folder.path(name)).unwrap();
    }
    folder.file("in/n.png", b"an image");
    folder.file("in/m.bin", &file.bin);
    let mut model = Model::read(folder.file("in/m.gltf", &file.gltf("m.bin"))).unwrap();
    model.set_tangents(0, unsplit(TANGENTS.to_vec())).unwrap();
    for (name, path) in [("n.png", "out/t.gltf"), ("m.bin", "out/t.gltf"), ("t_tangents.bin", "out/t.gltf")] {
        let other = folder.file(&format!("out/{name}"), b"of another model");
        let message = model.write(folder.path(path)).unwrap_err().to_string();
        let expected = format!(
            "{name}: it belongs to the new model, and exists already with other content; move or remove it, or write \
             the model as .glb or into another folder"
        );
        assert!(message.ends_with(&expected), "{message}");
        assert_eq!(std::fs::read(&other).unwrap(), b"of another model");
        assert!(!folder.path(path).exists());
        std::fs::remove_file(other).unwrap();
    }
    let files = model.write(folder.path("out/t.gltf")).unwrap();
    let names: Vec<_> = files.written.iter().map(|file| file.path.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["t_tangents.bin", "n.png", "m.bin", "t.gltf"]);

    // The buffers of the model that is replaced go with it.
    model.set_tangents(0, unsplit(TANGENTS.map(|[x, y, z, w]| [x, y, z, -w]).to_vec())).unwrap();
    model.write(folder.path("out/t.gltf")).unwrap();
    assert_eq!(std::fs::metadata(folder.path("out/t_tangents.bin")).unwrap().len(), 64);
    // So do those of a model that gets new tangents in its place.
    let again = folder.path("out/t.gltf");
    assert_eq!(Model::read(&again).unwrap().primitives()[0].had_tangents, 1);
    convert(&again, &again);
    assert_tangents(&again);
}

#[test]
fn every_method_fits_every_layout() {
    let (mut file, mut primitive) = rich();
    for mode in [4, 5, 6] {
        primitive["mode"] = mode.into();
        file.mesh(primitive.clone());
        let mut flat = primitive.clone();
        flat["attributes"].as_object_mut().unwrap().remove("NORMAL");
        file.mesh(flat);
    }
    let folder = Folder::new();
    let path = folder.file("m.glb", &file.glb());
    let mut model = Model::read(&path).unwrap();
    assert_eq!(model.primitives().len(), 6);
    let mut corners = Vec::new();
    for primitive in 0..6 {
        let mesh = model.mesh(primitive).unwrap();
        let tangents = Baker::reference().tangents(&mesh, &TangentOptions::default()).unwrap();
        let triangles = tangents.triangles.clone().unwrap_or_else(|| mesh.triangles().to_vec());
        let sources: Vec<u32> = tangents.sources().collect();
        let corner = |vertex: u32| (mesh.positions()[sources[vertex as usize] as usize], vertex);
        corners.push(triangles.iter().map(|triangle| triangle.map(corner)).collect::<Vec<_>>());
        model.set_tangents(primitive, tangents).unwrap();
    }
    model.write(&path).unwrap();
    let written = Model::read(&path).unwrap();
    for (primitive, corners) in corners.iter().enumerate() {
        let mesh = written.mesh(primitive).unwrap();
        let is_flat = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
        let got = mesh.triangles().iter().map(|t| t.map(|v| (mesh.positions()[v as usize], v)));
        // A strip that was split has lost its joints, another has not.
        let with_area = |t: &[([f32; 3], u32); 3]| !is_flat(t.map(|(_, vertex)| vertex));
        let got: Vec<_> = got.filter(with_area).collect();
        let kept: Vec<_> = corners.iter().copied().filter(with_area).collect();
        assert_eq!(got, kept, "primitive {primitive}");
        assert!(mesh.normals().is_some());
    }
}
