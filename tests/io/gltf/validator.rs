//! The Khronos validator finds nothing in the results that it did not find in the inputs.
//!
//! `tests/run.sh` fetches the validator and real models, and names their folders in TEXBAKE_GLTF_VALIDATOR and
//! TEXBAKE_MODELS. Without them these tests print so and pass; with TEXBAKE_REQUIRE_GLTF_VALIDATOR=1 and
//! TEXBAKE_REQUIRE_MODELS=1 they fail.

use super::Builder;
use super::builder::{I16, TRIANGLES, U8, U16};
use crate::io::support::Folder;
use crate::support::fetched;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use texbake::io::{Model, ModelReadOptions};
use texbake::{Baker, TangentMethod, TangentOptions};

/// How often the validator says what of each file.
fn messages(validator: &Path, files: &[PathBuf]) -> Vec<BTreeMap<String, usize>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/io/validate.js");
    let output = Command::new("node").arg(script).arg(validator).args(files).output().expect("node runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lists: Vec<Vec<String>> = serde_json::from_slice(&output.stdout).expect("a list of messages for each file");
    assert_eq!(lists.len(), files.len());
    let count = |list: Vec<String>| {
        let mut counts = BTreeMap::new();
        list.into_iter().for_each(|message| *counts.entry(message).or_insert(0) += 1);
        counts
    };
    lists.into_iter().map(count).collect()
}

/// Fails for each message that is said more often of a result than of its input.
fn assert_nothing_new(validator: &Path, files: &[(PathBuf, PathBuf)], allowed: &[&str]) {
    let (inputs, results): (Vec<PathBuf>, Vec<PathBuf>) = files.iter().cloned().unzip();
    assert!(!inputs.is_empty());
    let before = messages(validator, &inputs);
    let after = messages(validator, &results);
    for ((path, before), after) in results.iter().zip(before).zip(after) {
        for (message, count) in after {
            let was = before.get(&message).copied().unwrap_or(0);
            let is_allowed = allowed.iter().any(|allowed| message.ends_with(allowed));
            assert!(count <= was || is_allowed, "{}: {message} {count} times, not {was}", path.display());
        }
    }
}

/// Gives a model the tangents that it needs, or `all`, and writes it to each of the paths.
fn convert(from: &Path, all: bool, method: TangentMethod, to: &[&Path]) -> usize {
    let mut model = Model::read_with(from, &ModelReadOptions { all, ..Default::default() }).unwrap();
    let options = TangentOptions { method, ..Default::default() };
    for primitive in 0..model.primitives().len() {
        let mesh = model.mesh(primitive).unwrap();
        model.set_tangents(primitive, Baker::cpu().tangents(&mesh, &options).unwrap()).unwrap();
    }
    to.iter().for_each(|path| drop(model.write(path).unwrap()));
    model.primitives().len()
}

/// A square that is mirrored in u between its halves, so that its middle is split.
fn mirrored(primitive: impl FnOnce(&mut Builder, &mut Value)) -> Builder {
    let mut file = Builder::new();
    let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0f32]];
    let position = file.positions(&points.map(|[x, y]| [x, y, 0.0]));
    let normal = file.floats(&[[0.0, 0.0, 1.0]; 6]);
    let texcoord = file.floats(&points.map(|[x, y]| [1.0 - (x - 1.0).abs(), 1.0 - y]));
    let indices = file.indices(U16, &[0, 1, 3, 1, 4, 3, 1, 2, 4, 2, 5, 4]);
    for (accessor, target) in [(position, 34962), (normal, 34962), (texcoord, 34962), (indices, 34963)] {
        let view = file.json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
        file.json["bufferViews"][view]["target"] = target.into();
    }
    let attributes = json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texcoord });
    let mut made = json!({ "attributes": attributes, "indices": indices, "material": 0 });
    primitive(&mut file, &mut made);
    file.mesh(made);
    file
}

/// A file of each kind of change.
fn samples() -> Vec<(&'static str, Builder)> {
    let without_normals = |_: &mut Builder, primitive: &mut Value| {
        primitive["attributes"].as_object_mut().unwrap().remove("NORMAL");
    };
    let mut flat = mirrored(without_normals);
    // Nothing uses them, as before.
    flat.json["accessors"][1]["name"] = "unused".into();
    let old_tangents = mirrored(|file, primitive| {
        primitive["attributes"]["TANGENT"] = file.floats(&[[1.0, 0.0, 0.0, 1.0]; 6]).into();
    });
    let colours = mirrored(|file, primitive| {
        let view = file.view(&[200; 24]);
        file.json["bufferViews"][view]["byteStride"] = 4.into();
        file.json["bufferViews"][view]["target"] = 34962.into();
        let color = json!({ "bufferView": view, "componentType": U8, "normalized": true, "count": 6, "type": "VEC3" });
        primitive["attributes"]["COLOR_0"] = file.accessor(color).into();
    });
    let morphed = mirrored(|file, primitive| {
        let moved = file.positions(&[[0.0, 0.0, 0.5]; 6]);
        let turned = file.floats(&[[0.0, 0.0, 0.0]; 6]);
        primitive["targets"] = json!([{ "POSITION": moved, "NORMAL": turned }]);
    });
    let mut quantised = mirrored(|file, primitive| {
        let words: Vec<i16> = (0..6).flat_map(|i| [i % 3 * 9, i / 3 * 9, 0, 0]).collect();
        let view = file.view(bytemuck::cast_slice(&words));
        file.json["bufferViews"][view]["byteStride"] = 8.into();
        file.json["bufferViews"][view]["target"] = 34962.into();
        let position = json!({
            "bufferView": view, "componentType": I16, "count": 6, "type": "VEC3", "min": [0, 0, 0], "max": [18, 9, 0]
        });
        primitive["attributes"]["POSITION"] = file.accessor(position).into();
    });
    for list in ["extensionsUsed", "extensionsRequired"] {
        quantised.json[list] = json!(["KHR_mesh_quantization"]);
    }
    let mut strip = mirrored(|file, primitive| {
        primitive["indices"] = file.indices(U8, &[3, 0, 4, 1, 5, 2]).into();
        primitive["mode"] = 5.into();
    });
    strip.json["nodes"].as_array_mut().unwrap().push(json!({ "mesh": 0, "translation": [3, 0, 0] }));
    strip.json["scenes"][0]["nodes"] = json!([0, 1]);
    let mut shared = mirrored(|_, _| {});
    let again = shared.json["meshes"][0]["primitives"][0].clone();
    shared.mesh(again.clone());
    let mut other = again;
    other["indices"] = shared.indices(U8, TRIANGLES.as_flattened()).into();
    shared.mesh(other);
    vec![
        ("plain", mirrored(|_, _| {})),
        ("flat", flat),
        ("old_tangents", old_tangents),
        ("colours", colours),
        ("morphed", morphed),
        ("quantised", quantised),
        ("strip", strip),
        ("shared", shared),
    ]
}

#[test]
fn hand_made_models() {
    let Some(validator) = fetched("GLTF_VALIDATOR") else { return };
    let folder = Folder::new();
    std::fs::create_dir(folder.path("out")).unwrap();
    let mut files = Vec::new();
    for (name, file) in samples() {
        let glb = folder.file(&format!("{name}.glb"), &file.glb());
        folder.file(&format!("{name}.bin"), &file.bin);
        let gltf = folder.file(&format!("{name}.gltf"), &file.gltf(&format!("{name}.bin")));
        let data = folder.file(&format!("{name}_data.gltf"), &file.gltf_with_data());
        for (from, kind) in [(&glb, "glb"), (&gltf, "gltf"), (&data, "data")] {
            let results = ["glb", "gltf"].map(|extension| folder.path(&format!("out/{name}_{kind}.{extension}")));
            convert(from, false, TangentMethod::Lengyel, &[&results[0], &results[1]]);
            files.extend(results.map(|result| (from.clone(), result)));
        }
        // Twice.
        let twice = folder.path(&format!("out/{name}_twice.glb"));
        convert(&files[files.len() - 6].1.clone(), false, TangentMethod::Mikktspace, &[&twice]);
        files.push((glb, twice));
    }
    assert_nothing_new(&validator, &files, &[]);
    // The comparison is awake: tangents of no length are seen.
    let (from, to) = files[0].clone();
    let mut model = Model::read(&from).unwrap();
    let mesh = model.mesh(0).unwrap();
    let mut broken = Baker::reference().tangents(&mesh, &TangentOptions::default()).unwrap();
    broken.tangents[0] = [0.0; 4];
    model.set_tangents(0, broken).unwrap();
    model.write(&to).unwrap();
    let seen = std::panic::catch_unwind(|| assert_nothing_new(&validator, &files[..1], &[]));
    assert!(seen.is_err(), "the validator sees a zero tangent");
}

#[test]
fn real_models() {
    let (Some(validator), Some(models)) = (fetched("GLTF_VALIDATOR"), fetched("MODELS")) else { return };
    let mut inputs: Vec<PathBuf> = std::fs::read_dir(&models).unwrap().map(|entry| entry.unwrap().path()).collect();
    inputs.retain(|path| path.extension().is_some_and(|extension| extension == "glb" || extension == "gltf"));
    inputs.sort();
    assert!(inputs.len() >= 20, "{} models", inputs.len());
    let folder = Folder::new();
    let (mut needed, mut all) = (Vec::new(), Vec::new());
    let mut primitives = 0;
    for input in inputs {
        let name = input.file_stem().unwrap().to_string_lossy().into_owned();
        let [once, every] = ["", "_all"].map(|kind| folder.path(&format!("{name}{kind}.glb")));
        primitives += convert(&input, false, TangentMethod::Mikktspace, &[&once]);
        convert(&input, true, TangentMethod::Lengyel, &[&every]);
        needed.push((input.clone(), once));
        all.push((input, every));
    }
    assert!(primitives > 80, "{primitives} primitives with a normal map");
    assert_nothing_new(&validator, &needed, &[]);
    // That tangents without a normal map are of no use is what was asked for.
    assert_nothing_new(&validator, &all, &["UNUSED_MESH_TANGENT"]);
}
