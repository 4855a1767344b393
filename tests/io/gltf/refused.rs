//! Files that are refused, with the reason and the way out.

use super::Builder;
use super::builder::{I16, U8, U16, U32, glb};
use crate::io::support::Folder;
use serde_json::{Value, json};
use std::path::Path;
use texbake::io::{Model, ModelReadOptions};

/// What reading a file and its first mesh says.
fn message(path: &Path) -> String {
    let read = Model::read(path).and_then(|model| model.mesh(0));
    let message = read.map(drop).expect_err("this file must be refused").to_string();
    let name = format!("{}: ", path.display());
    message.strip_prefix(&name).unwrap_or_else(|| panic!("{message} names the file")).to_string()
}

/// The square after a change to its JSON.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let (mut file, position, texcoord) = Builder::square();
    let indices = file.indices(U8, &[0, 1, 2, 0, 2, 3]);
    let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
    file.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
    change(&mut file.json);
    let folder = Folder::new();
    message(&folder.file("m.glb", &file.glb()))
}

const EXPORT: &str = "; the file is damaged; export the model again";

fn damaged(change: impl FnOnce(&mut Value)) -> String {
    let message = refused(change);
    message.strip_suffix(EXPORT).unwrap_or_else(|| panic!("{message}")).to_string()
}

#[test]
fn lists_that_are_none() {
    for kind in ["accessors", "bufferViews", "buffers", "images", "materials", "meshes", "nodes", "textures"] {
        for wrong in [json!({}), json!([1]), json!(null), json!("0")] {
            let document = json!({ "asset": { "version": "2.0" }, kind: wrong });
            let folder = Folder::new();
            let message = message(&folder.file("m.gltf", &serde_json::to_vec(&document).unwrap()));
            assert_eq!(message, format!("{kind} is no list of objects{EXPORT}"));
        }
    }
}

#[test]
fn compressed_and_unknown_geometry() {
    let way_out = "; write it without compression (gltf-transform copy decodes), compute tangents, then compress";
    let by =
        |name: &str| format!("mesh 0, primitive 0: it is compressed by {name}, which texbake does not read{way_out}");
    let draco = "KHR_draco_mesh_compression";
    let on_primitive = |json: &mut Value, name: &str| {
        json["meshes"][0]["primitives"][0]["extensions"] = json!({ name: { "bufferView": 0 } });
    };
    assert_eq!(refused(|json| on_primitive(json, draco)), by(draco));
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        assert_eq!(refused(|json| json["bufferViews"][1]["extensions"] = json!({ name: {} })), by(name));
    }
    let unknown = refused(|json| {
        on_primitive(json, "VENDOR_curved");
        json["extensionsRequired"] = json!(["VENDOR_curved"]);
    });
    let expected = "mesh 0, primitive 0: it requires the extension VENDOR_curved, which may change what its vertices \
                    mean; export the model without it";
    assert_eq!(unknown, expected);

    // What is compressed elsewhere, or not required, is no obstacle.
    let (mut file, position, texcoord) = Builder::square();
    let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
    let extensions = json!({ "VENDOR_curved": {}, "KHR_materials_variants": { "mappings": [] } });
    file.mesh(json!({ "attributes": attributes, "material": 0, "extensions": extensions }));
    let view = file.view(&[0; 4]);
    file.json["bufferViews"][view]["extensions"] = json!({ "EXT_meshopt_compression": {} });
    file.json["extensionsRequired"] = json!(["EXT_meshopt_compression", "KHR_mesh_quantization", "VENDOR_other"]);
    file.read();
}

#[test]
fn accessors_that_are_not_there() {
    let missing = damaged(|json| json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9.into());
    assert_eq!(missing, "mesh 0, primitive 0: it refers to accessors[9], which it does not have");
    let missing = damaged(|json| json["accessors"][0]["bufferView"] = 7.into());
    assert_eq!(missing, "mesh 0, primitive 0: it refers to bufferViews[7], which it does not have");
    let missing = damaged(|json| json["bufferViews"][0]["buffer"] = 1.into());
    assert_eq!(missing, "mesh 0, primitive 0: bufferViews[0] lies in buffers[1], which does not exist");
    let missing = damaged(|json| json["meshes"][0]["primitives"][0]["material"] = 1.into());
    assert_eq!(missing, "mesh 0, primitive 0: it refers to materials[1], which it does not have");
}

#[test]
fn accessors_that_reach_too_far() {
    for (field, value) in [("byteLength", json!(1u64 << 40)), ("byteOffset", json!(u64::MAX))] {
        let far = damaged(|json| json["bufferViews"][0][field] = value);
        assert_eq!(far, "mesh 0, primitive 0: bufferViews[0] reaches beyond the 88 bytes of buffers[0]");
    }
    for (field, value) in
        [("count", 5u64), ("byteOffset", 4), ("byteOffset", u64::MAX), ("count", 1 << 50), ("count", u64::MAX)]
    {
        let far = damaged(|json| json["accessors"][0][field] = value.into());
        assert_eq!(far, "mesh 0, primitive 0: accessors[0] reaches beyond bufferViews[0]");
    }
    // Elements that lie on each other are no layout.
    let near = damaged(|json| json["bufferViews"][0]["byteStride"] = 4.into());
    assert_eq!(near, "mesh 0, primitive 0: accessors[0] reaches beyond bufferViews[0]");
    let claims = refused(|json| {
        json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        json["accessors"][0]["count"] = (1u64 << 50).into();
    });
    let expected = "mesh 0, primitive 0: accessors[0] claims 1125899906842624 elements of 12 bytes; the limit is \
                    134217728 bytes, a part of --max-bytes: raise it";
    assert_eq!(claims, expected);
    let sparse = damaged(|json| {
        json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": 2, "byteOffset": 5, "componentType": U8 },
            "values": { "bufferView": 1 }
        });
        json["accessors"][0]["count"] = 3.into();
    });
    assert_eq!(sparse, "mesh 0, primitive 0: accessors[0] has sparse elements out of range");
}

#[test]
fn accessors_of_another_type() {
    for (accessor, field, value, what) in [
        (0, "type", json!("VEC4"), "POSITION, accessors[0], does not have 3 components of a type that it may"),
        (0, "type", json!("VEC2"), "POSITION, accessors[0], does not have 3 components of a type that it may"),
        (
            1,
            "componentType",
            json!(U32),
            "texture coordinate, accessors[1], does not have 2 components of a type that it may",
        ),
    ] {
        let message = damaged(|json| {
            json["accessors"][accessor][field] = value;
            json["accessors"][accessor]["count"] = 3.into();
        });
        assert_eq!(message, format!("mesh 0, primitive 0: its {what}"));
    }
    let message = damaged(|json| {
        json["accessors"][2]["componentType"] = I16.into();
        json["accessors"][2]["count"] = 3.into();
    });
    assert_eq!(message, "mesh 0, primitive 0: its indices, accessors[2], are no unsigned integers");
    let message = damaged(|json| json["accessors"][0]["componentType"] = 5124.into());
    let expected = "mesh 0, primitive 0: accessors[0] has a type or a component type that glTF 2.0 does not have";
    assert_eq!(message, expected);
    let message = damaged(|json| json["meshes"][0]["primitives"][0]["mode"] = 7.into());
    assert_eq!(message, "mesh 0, primitive 0: its mode is none of glTF's");
}

#[test]
fn numbers_that_are_none_and_indices_of_nothing() {
    let folder = Folder::new();
    let refused = |positions: &[[f32; 3]], component: u32, indices: &[u32]| {
        let mut file = Builder::new();
        let (position, texcoord) = (file.floats(positions), file.floats(&vec![[0.0; 2]; positions.len()]));
        let indices = file.indices(component, indices);
        let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
        file.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
        file.json["meshes"][0]["name"] = "rock".into();
        message(&folder.file("m.glb", &file.glb()))
    };
    let zero = [0.0; 3];
    let expected = "mesh 0 \"rock\", primitive 0: the position of vertex 1 is [0.0, NaN, 0.0], and must be finite \
                    numbers; repair the mesh where it was made";
    assert_eq!(refused(&[zero, [0.0, f32::NAN, 0.0], zero], U8, &[0, 1, 2]), expected);
    for (component, index) in [(U8, 255), (U16, 65535), (U32, u32::MAX)] {
        let expected = format!(
            "mesh 0 \"rock\", primitive 0: its index is {index} (triangle 0: [0, {index}, 2]): it must be below 3, the number \
             of vertices{EXPORT}"
        );
        assert_eq!(refused(&[zero; 3], component, &[0, index, 2]), expected);
    }
    let expected = format!(
        "mesh 0 \"rock\", primitive 0: its number of texture coordinates is 3: it must be 2, one for each position{EXPORT}"
    );
    let mut file = Builder::new();
    let (position, texcoord) = (file.floats(&[zero; 2]), file.floats(&[[0.0; 2]; 3]));
    let indices = file.indices(U8, &[0, 1, 0]);
    let attributes = json!({ "POSITION": position, "TEXCOORD_0": texcoord });
    file.mesh(json!({ "attributes": attributes, "indices": indices, "material": 0 }));
    file.json["meshes"][0]["name"] = "rock".into();
    assert_eq!(message(&folder.file("m.glb", &file.glb())), expected);
}

#[test]
fn files_that_are_cut_missing_or_something_else() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let whole = file.glb();
    let cut = "it ends before its header says so; the file is cut; copy or export it again";
    for length in [4, 11, 12, 19, 40, whole.len() - 1] {
        assert_eq!(message(&folder.file("cut.glb", &whole[..length])), cut, "{length} bytes");
    }
    let mut shorter = whole.clone();
    shorter[8..12].copy_from_slice(&(whole.len() as u32 - 4).to_le_bytes());
    assert_eq!(message(&folder.file("cut.glb", &shorter)), cut);

    let beside = folder.file("m.gltf", &file.gltf("none.bin"));
    let missing = Model::read(&beside).unwrap_err().to_string();
    assert!(missing.contains("m.gltf: it refers to \"none.bin\", which cannot be read: "), "{missing}");
    assert!(missing.ends_with("; put the file where the model looks for it"), "{missing}");
    folder.file("none.bin", &file.bin[..10]);
    let expected = format!("buffers[0] has 10 of the {} bytes that it claims{EXPORT}", file.bin.len());
    assert_eq!(message(&beside), expected);
    for uri in ["../secret.bin", "/etc/passwd", "..%2Fsecret.bin", "https://example.com/a.bin"] {
        let expected = format!(
            "it refers to {uri:?}, which is not a file in its folder; put the file there and give its relative path, \
             or pack the model into one .glb"
        );
        assert_eq!(message(&folder.file("uri.gltf", &file.gltf(uri))), expected);
    }
    let bad = message(&folder.file("uri.gltf", &file.gltf("data:text/plain,abc")));
    assert_eq!(bad, format!("buffers[0] has a data URI that is not base64{EXPORT}"));

    let old = message(&folder.file("old.glb", &[&b"glTF\x01\0\0\0\x14\0\0\0"[..], &[0; 8]].concat()));
    assert_eq!(old, "it is binary glTF of version 1: texbake reads version 2; export the model as glTF 2.0");
    let old = message(&folder.file("old.gltf", br#"{ "asset": { "version": "1.0" } }"#));
    assert_eq!(old, "its asset.version is 1.0: texbake reads glTF 2.0; export the model as glTF 2.0");
    let none = message(&folder.file("none.gltf", b"v 0 0 0\n"));
    assert_eq!(none, "it is no model; texbake reads .glb, .gltf and .obj");
    let broken = message(&folder.file("broken.gltf", b"{ asset"));
    assert!(broken.starts_with("it is not glTF: key must be a string at line 1 column 3; texbake reads"), "{broken}");
}

#[test]
fn files_above_the_limit() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let bytes = file.gltf("m.bin");
    folder.file("m.bin", &file.bin);
    let path = folder.file("m.gltf", &bytes);
    let read =
        |max_bytes: usize| Model::read_with(&path, &ModelReadOptions { max_bytes: max_bytes as u64, all: false });
    let both = bytes.len() + file.bin.len();
    read(both).unwrap();
    let message = read(both - 1).unwrap_err().to_string();
    let expected = format!("m.bin: it has {0} bytes, and {1} of the limit are left; raise it with --max-bytes", 80, 79);
    assert!(message.ends_with(&expected), "{message}");
    assert!(read(bytes.len() - 1).unwrap_err().to_string().contains("m.gltf: it has"));
}

#[test]
fn what_cannot_be_written() {
    let folder = Folder::new();
    let (mut file, position, texcoord) = Builder::square();
    file.mesh(json!({ "attributes": { "POSITION": position, "TEXCOORD_0": texcoord }, "material": 0 }));
    let message = |file: &Builder, name: &str| {
        let model = Model::read(folder.file("m.glb", &file.glb())).unwrap();
        model.write(folder.path(name)).expect_err("this cannot be written").to_string()
    };
    let expected =
        "m.obj: models are written as glTF; give it the extension .glb or .gltf, or end the name of a folder in /";
    assert!(message(&file, "m.obj").ends_with(expected));

    file.json["images"] = json!([{ "uri": "../a.png" }]);
    let above = message(&file, "out/m.glb");
    let expected =
        "it refers to \"../a.png\", which is not a file in its folder; write it into the folder it came from";
    assert!(above.ends_with(expected), "{above}");
    file.json["images"] = json!([{ "uri": "none.png" }]);
    let missing = message(&file, "out/m.glb");
    assert!(missing.contains("m.glb: it refers to none.png, which cannot be read: "), "{missing}");
    assert!(missing.ends_with("; put the file there, or write the model into the folder it came from"), "{missing}");
    assert!(!folder.path("out").exists(), "no folder is made for what cannot be written");
    // Where it came from they are where they were.
    Model::read(folder.path("m.glb")).unwrap().write(folder.path("n.glb")).unwrap();

    let empty = glb(&json!({ "asset": { "version": "2.0" } }), &[]);
    let model = Model::read(folder.file("empty.glb", &empty)).unwrap();
    assert_eq!(model.mesh(0).unwrap_err().to_string(), "primitive is 0: it must be below 0");
}
