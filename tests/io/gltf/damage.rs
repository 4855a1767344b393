//! Damaged models: an answer or a reason, never a panic.

use super::builder::F32;
use super::samples::{models, sample};
use crate::io::damage::{MAX_BYTES, assert_no_panic, read_variants, variants};
use crate::io::support::{Folder, Noise};
use serde_json::{Value, json};
use std::path::Path;
use texbake::io::{Model, ModelReadOptions};
use texbake::{Baker, Error, TangentOptions};

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
    assert_no_panic(&models(&folder), convert);
}

#[test]
fn damaged_materials_are_warnings() {
    let folder = Folder::new();
    let model = models(&folder).pop().unwrap();
    folder.file("a.png", b"");
    let (read, refused) = read_variants(&folder.path("m.mtl"), |_| convert(&model));
    assert!(read > 0 && refused == 0, "materials alone make no model unreadable: {refused} were refused");
}

#[test]
fn damaged_buffers_beside_a_model_never_panic() {
    let folder = Folder::new();
    let model = models(&folder).swap_remove(1);
    let (read, refused) = read_variants(&folder.path("m.bin"), |_| convert(&model));
    assert!(read > 0 && refused > 0, "{read} were read, {refused} refused");
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
