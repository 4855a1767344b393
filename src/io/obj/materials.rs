//! Libraries of materials (.mtl), as glTF's materials.

use crate::error::plain;
use crate::io::gltf::{ModelFile, read_file, uri_of_path};
use serde_json::{Map, Value, json};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The materials, images and textures of a document to be.
#[derive(Debug, Default)]
pub(super) struct Materials {
    pub materials: Vec<Value>,
    pub textures: Vec<Value>,
    pub images: Vec<Value>,
    pub files: Vec<ModelFile>,
    pub warnings: Vec<String>,
    /// Bytes of libraries that may still be read.
    left: u64,
    /// The number of each material's name, and of each image's; the first of several counts.
    numbers: HashMap<String, usize>,
    image_numbers: HashMap<String, usize>,
    /// The libraries that were read.
    libraries: HashSet<PathBuf>,
}

/// How many times its bytes a library takes as materials and as warnings, at most.
pub(super) const UNPACKED: u64 = 64;

impl Materials {
    /// Those of a model, of which no library is read yet; all libraries take at most `limit` bytes.
    pub fn of(model: ModelFile, limit: u64) -> Self {
        Self { files: vec![model], left: limit, ..Self::default() }
    }

    /// The number of a material; one that no library has, has only a name.
    pub fn number(&mut self, name: &str) -> usize {
        let known = self.numbers.get(name).copied();
        known.unwrap_or_else(|| self.add(name))
    }

    fn add(&mut self, name: &str) -> usize {
        let number = self.materials.len();
        self.materials.push(json!({ "name": name }));
        *self.numbers.entry(name.to_owned()).or_insert(number)
    }

    /// Reads what follows `mtllib`: one name, with spaces perhaps, or several.
    pub fn read(&mut self, model: &Path, names: &str) {
        if model.with_file_name(names.replace('\\', "/")).is_file() {
            return self.read_library(model, names);
        }
        names.split_whitespace().for_each(|name| self.read_library(model, name));
    }

    fn read_library(&mut self, model: &Path, name: &str) {
        let name = name.replace('\\', "/");
        let path = model.with_file_name(&name);
        if !self.libraries.insert(std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone())) {
            return;
        }
        let bytes = match read_file(&path, self.left) {
            Ok(bytes) => bytes,
            Err(error) => return self.warnings.push(format!("its materials keep only their names: {error}")),
        };
        self.left -= bytes.len() as u64;
        self.files.push(ModelFile::new(&path, &bytes));
        let folder = name.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let mut dropped = BTreeSet::new();
        for line in String::from_utf8_lossy(&bytes).lines() {
            let line = line.trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            if keyword == "newmtl" {
                self.add(rest);
                continue;
            }
            let Some(at) = self.materials.len().checked_sub(1) else { continue };
            match keyword.to_ascii_lowercase().as_str() {
                "kd" => match color(rest) {
                    Some([r, g, b]) => {
                        let physical = physical(&mut self.materials[at]);
                        physical.insert("baseColorFactor".into(), json!([r, g, b, 1.0]));
                    }
                    None => _ = dropped.insert(line.to_owned()),
                },
                texture @ ("map_kd" | "map_bump" | "bump" | "norm") => match self.texture(model, &folder, rest) {
                    Some(texture_info) if texture == "map_kd" => {
                        physical(&mut self.materials[at]).insert("baseColorTexture".into(), texture_info);
                    }
                    Some(texture_info) => self.materials[at]["normalTexture"] = texture_info,
                    None => {
                        let reason = "it is no PNG or JPEG file that exists, at a relative path";
                        self.warnings.push(format!(
                            "{}: {}: the texture is dropped: {reason}",
                            path.display(),
                            plain(line)
                        ));
                    }
                },
                "" | "illum" => {}
                comment if comment.starts_with('#') => {}
                _ => _ = dropped.insert(keyword.to_owned()),
            }
        }
        if !dropped.is_empty() {
            let dropped: Vec<String> = dropped.into_iter().collect();
            self.warnings.push(format!(
                "{}: dropped, as texbake does not read it: {}",
                path.display(),
                plain(&dropped.join(", "))
            ));
        }
    }

    /// A texture of an image that glTF takes; of the same image, the same.
    fn texture(&mut self, model: &Path, folder: &str, rest: &str) -> Option<Value> {
        let name = format!("{folder}{}", without_options(rest)).replace('\\', "/");
        let lower = name.to_ascii_lowercase();
        let is_image = [".png", ".jpg", ".jpeg"].iter().any(|ending| lower.ends_with(ending));
        let is_relative = !name.starts_with('/') && !name.contains(':');
        if !(is_image && is_relative && model.with_file_name(&name).is_file()) {
            return None;
        }
        let uri = uri_of_path(&name);
        let at = *self.image_numbers.entry(uri.clone()).or_insert_with(|| {
            self.textures.push(json!({ "source": self.images.len() }));
            self.images.push(json!({ "uri": uri }));
            self.images.len() - 1
        });
        Some(json!({ "index": at }))
    }
}

fn physical(material: &mut Value) -> &mut Map<String, Value> {
    if material["pbrMetallicRoughness"].is_null() {
        material["pbrMetallicRoughness"] = json!({ "metallicFactor": 0.0 });
    }
    material["pbrMetallicRoughness"].as_object_mut().expect("it was made as one")
}

fn color(text: &str) -> Option<[f32; 3]> {
    let parts = text.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f32>>>()?;
    let color: [f32; 3] = parts.try_into().ok()?;
    color.iter().all(|part| (0.0..=1.0).contains(part)).then_some(color)
}

/// Values of options that are no numbers: of -clamp and its like, -imfchan, -type.
const WORDS: [&str; 9] = ["on", "off", "r", "g", "b", "m", "l", "z", "sphere"];

/// The file of a texture, behind options and their values: `-bm 1 -s 2 2 name with spaces.png`.
fn without_options(text: &str) -> &str {
    let mut rest = text.trim();
    let mut in_options = false;
    while let Some((word, after)) = rest.split_once(char::is_whitespace) {
        let is_value = in_options && (word.parse::<f32>().is_ok() || WORDS.contains(&word));
        if !word.starts_with('-') && !is_value {
            break;
        }
        in_options = true;
        rest = after.trim_start();
    }
    rest
}
