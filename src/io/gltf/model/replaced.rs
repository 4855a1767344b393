//! A model that replaces another one, stopped after every step as a kill would stop it.

use super::*;
use crate::io::replace::{Step, take};
use crate::ops::tangents::TangentReport;
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// One triangle: its positions, then its texture coordinates.
const VERTICES: [f32; 15] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1.];

/// A model of the triangle; its only buffer is the file `m.bin`.
fn write_triangle(folder: &Path, scale: f32) -> PathBuf {
    let accessor =
        |view: usize, kind: &str| json!({ "bufferView": view, "componentType": 5126, "count": 3, "type": kind });
    let json = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "m.bin", "byteLength": 60 }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 24 },
        ],
        "accessors": [accessor(0, "VEC3"), accessor(1, "VEC2")],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } }] }],
    });
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("m.bin"), bytemuck::bytes_of(&VERTICES.map(|value| value * scale))).unwrap();
    let path = folder.join("m.gltf");
    fs::write(&path, json.to_string()).unwrap();
    path
}

/// The triangle's model with the same tangent at each vertex.
fn with_tangents(input: &Path, x: f32) -> Model {
    let options = ModelReadOptions { all: true, ..ModelReadOptions::default() };
    let mut model = Model::read_with(input, &options).unwrap();
    let tangents = vec![[x, 0.0, 0.0, 1.0]; 3];
    let report = TangentReport::default();
    model.set_tangents(0, Tangents { tangents, normals: None, copies: Vec::new(), triangles: None, report }).unwrap();
    model
}

fn steps(model: &Model, output: &Path) -> Vec<Step> {
    write::steps(&model.document, model.edited().unwrap(), output, &Monitor::default()).unwrap().1
}

/// What a reader gets: the model without the names of its buffers, and their bytes.
fn read(path: &Path) -> (Value, Vec<Vec<u8>>) {
    let mut json: Value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    let mut bytes = |buffer: &mut Value| {
        let uri = buffer.as_object_mut().unwrap().remove("uri").unwrap();
        let mut bytes = fs::read(path.with_file_name(uri.as_str().unwrap())).unwrap();
        // What is behind its length belongs to no buffer.
        bytes.truncate(buffer["byteLength"].as_u64().unwrap() as usize);
        bytes
    };
    let buffers = json["buffers"].as_array_mut().unwrap().iter_mut().map(&mut bytes).collect();
    (json, buffers)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = entries.collect();
    names.sort();
    names
}

fn name(step: &Step) -> &str {
    step.path().file_name().and_then(OsStr::to_str).unwrap()
}

/// A model in a place, and one that comes into its place.
struct Replaced {
    folder: TempDir,
    output: PathBuf,
    model: Model,
}

/// The model gets other tangents in its place.
fn in_its_place() -> Replaced {
    let folder = tempfile::tempdir().unwrap();
    let output = write_triangle(folder.path(), 1.0);
    with_tangents(&output, 1.0).write(&output).unwrap();
    let model = with_tangents(&output, -1.0);
    Replaced { folder, output, model }
}

/// The model is written into another folder again, from files that have changed.
fn elsewhere() -> Replaced {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("m.gltf");
    let inputs = folder.path().join("in");
    with_tangents(&write_triangle(&inputs, 1.0), 1.0).write(&output).unwrap();
    let model = with_tangents(&write_triangle(&inputs, 2.0), -1.0);
    Replaced { folder, output, model }
}

/// Stops after every number of steps, with the old or the new model in place, and goes on with either.
fn assert_consistent(replaced: fn() -> Replaced, expected_steps: &[&str]) {
    let Replaced { folder, output, model } = replaced();
    let before = read(&output);
    let all = steps(&model, &output);
    assert_eq!(all.iter().map(name).collect::<Vec<_>>(), expected_steps);
    take(all).unwrap();
    let after = read(&output);
    let files = names(folder.path());
    assert!(before != after);
    assert!(!files.iter().any(|name| name.contains("texbake")), "{files:?}");

    let first_model = expected_steps.iter().position(|name| *name == "m.gltf").unwrap();
    for count in 0..=expected_steps.len() {
        for is_same_again in [true, false] {
            let Replaced { folder, output, model } = replaced();
            steps(&model, &output).into_iter().take(count).for_each(|step| step.take().unwrap());
            let found = read(&output);
            assert!(found == if count <= first_model { before.clone() } else { after.clone() }, "after {count} steps");

            let again = if is_same_again { model } else { with_tangents(&model.document.path, 0.5) };
            again.write(&output).unwrap();
            assert_eq!(names(folder.path()), files, "after {count} steps");
            let (_, buffers) = read(&output);
            let tangents = if is_same_again { after.1[1].clone() } else { bytes_of_tangents(0.5) };
            assert!(buffers[1] == tangents, "after {count} steps");
        }
    }
}

fn bytes_of_tangents(x: f32) -> Vec<u8> {
    bytemuck::bytes_of(&[[x, 0.0, 0.0, 1.0]; 3]).to_vec()
}

#[test]
fn a_model_that_gets_other_tangents_is_always_whole() {
    let expected = ["m_tangents.texbake.bin", "m.gltf", "m_tangents.bin", "m.gltf", "m_tangents.texbake.bin"];
    assert_consistent(in_its_place, &expected);
}

#[test]
fn a_model_that_is_written_again_from_changed_files_is_always_whole() {
    let expected = [
        "m_tangents.texbake.bin",
        "m.texbake.bin",
        "m.gltf",
        "m_tangents.bin",
        "m.bin",
        "m.gltf",
        "m_tangents.texbake.bin",
        "m.texbake.bin",
    ];
    assert_consistent(elsewhere, &expected);
}

#[test]
fn what_stays_the_same_needs_no_stand_in() {
    let Replaced { output, folder: _folder, .. } = in_its_place();
    let model = with_tangents(&output, 1.0);
    assert_eq!(steps(&model, &output).iter().map(name).collect::<Vec<_>>(), ["m_tangents.bin", "m.gltf"]);
}

/// The user's own file, which has a stand-in's name: it stays where none is needed, and is an error where one is.
#[test]
fn another_file_with_the_name_of_a_stand_in_stays() {
    for content in [&b"mine"[..], b"", b"of the user, and longer than the mark of a stand-in"] {
        let Replaced { folder, output, model } = in_its_place();
        let mine = folder.path().join("m_tangents.texbake.bin");
        fs::write(&mine, content).unwrap();
        with_tangents(&output, 1.0).write(&output).unwrap();
        assert_eq!(fs::read(&mine).unwrap(), content);

        let before = read(&output);
        let message = model.write(&output).unwrap_err().to_string();
        assert!(
            message.contains("m_tangents.texbake.bin: its name is needed while the model is replaced"),
            "{message}"
        );
        assert!(read(&output) == before);
        assert_eq!(fs::read(&mine).unwrap(), content);

        fs::remove_file(&mine).unwrap();
        model.write(&output).unwrap();
        assert_eq!(names(folder.path()), ["m.bin", "m.gltf", "m_tangents.bin"]);
    }
}

#[test]
fn the_model_that_is_read_keeps_its_buffers() {
    let folder = tempfile::tempdir().unwrap();
    let output = write_triangle(folder.path(), 1.0);
    with_tangents(&output, 1.0).write(&output).unwrap();
    // Its tangents are in a file that has the name of another model's.
    let input = folder.path().join("renamed.gltf");
    fs::rename(&output, &input).unwrap();
    let before = read(&input);
    with_tangents(&input, -1.0).write(&output).unwrap();
    assert!(read(&input) == before);
    assert_eq!(names(folder.path()), ["m.bin", "m.gltf", "m_tangents.bin", "m_tangents2.bin", "renamed.gltf"]);
}

/// The comparison sees what must not be: the old model with the new one's bytes.
#[test]
fn a_buffer_that_comes_before_its_model_is_neither() {
    let Replaced { output, model, folder: _folder } = in_its_place();
    let before = read(&output);
    let buffer = steps(&model, &output).into_iter().find(|step| name(step) == "m_tangents.bin");
    buffer.unwrap().take().unwrap();
    assert!(read(&output) != before);
}
