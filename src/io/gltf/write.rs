//! Documents as files: .glb, or .gltf with its buffers and images beside it.
//!
//! A model of several files is at any moment the old one or the new one. Where a file of the old model gets other
//! bytes, the new model first refers to a stand-in of it, `name.texbake.bin`, then the file is replaced, then the model
//! refers to it, and then the stand-in goes: whatever the process is killed between, the model in place has its bytes.
//! That is an order of names. A loss of power keeps each file's bytes, which are on the disk before it gets its name, but
//! the file system may keep a later name and lose an earlier one, unless it keeps their order, as journals do.

use super::container::{BIN, JSON, MAGIC, read_file};
use super::document::{Document, ModelFile, Origin, index};
use super::edit::{Edited, put};
use super::model::ModelFiles;
use super::uri::{self, Uri, file_of};
use crate::error::{Error, Result};
use crate::io::input;
use crate::io::replace::{Replacement, Step, take};
use crate::stream::Monitor;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::{BTreeSet, HashSet};
use std::ffi::OsStr;
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Component, Path, PathBuf};

/// Where the parts of a merged buffer begin: as much as any extension asks for.
const PART_ALIGNMENT: usize = 8;

/// What a stand-in ends with, behind its buffer (glTF 2.0, section 3.6.1: a buffer's file may be longer than the
/// buffer): no other file with such a name is replaced or removed.
const STAND_IN_MARK: &[u8] = b"texbake stand-in";

/// A format that models are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ModelFormat {
    Glb,
    Gltf,
}

/// Bytes one after the other.
type Parts<'a> = Vec<Cow<'a, [u8]>>;

/// A file to be.
struct NewFile<'a> {
    path: PathBuf,
    parts: Parts<'a>,
}

impl ModelFormat {
    /// By the extension of the file to be.
    pub fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase).as_deref() {
            Some("glb") => Ok(Self::Glb),
            Some("gltf") => Ok(Self::Gltf),
            _ => Err(Error::file(
                path,
                "models are written as glTF",
                "give it the extension .glb or .gltf, or end the name of a folder in /",
            )),
        }
    }
}

/// Writes a model and, unless it stays in its folder, the files it refers to.
pub(super) fn write(document: &Document, edited: Edited<'_>, path: &Path, monitor: &Monitor) -> Result<ModelFiles> {
    let (files, steps) = steps(document, edited, path, monitor)?;
    monitor.check()?;
    take(steps)?;
    Ok(files)
}

/// The files of a model, complete but for their names, and the order in which they get them.
pub(super) fn steps(
    document: &Document,
    mut edited: Edited<'_>,
    path: &Path,
    monitor: &Monitor,
) -> Result<(ModelFiles, Vec<Step>)> {
    let mut read = document.files.clone();
    let mut files = Vec::new();
    let added = std::mem::take(&mut edited.added);
    let model = match ModelFormat::of(path)? {
        ModelFormat::Glb => {
            let bin = join_buffers(document, &mut edited, added, &mut read)?;
            glb(document, path, &edited.json, bin)?
        }
        ModelFormat::Gltf => {
            files.extend(buffer_file(document, &mut edited, added, path));
            gltf(&edited.json)
        }
    };
    if !is_same_folder(&document.path, path) {
        copied_files(document, &edited.json, path, &mut files, &mut read)?;
    }
    let old_buffers = buffers_of_old_model(path);
    files.iter().try_for_each(|file| file.check_place(&old_buffers))?;
    let stand_ins: Vec<NewFile> = files.iter().filter_map(|file| file.stand_in(&old_buffers)).collect();
    stand_ins.iter().try_for_each(NewFile::check_stand_in)?;
    let for_now = refer_to(&stand_ins, &edited.json, path);
    let is_left = |place: &PathBuf| is_stand_in(place) && files.iter().all(|file| file.path != *place);
    let left = files.iter().map(|file| stand_in(&file.path)).filter(is_left);
    let obsolete: Vec<PathBuf> = left.chain(stand_ins.iter().map(|file| file.path.clone())).collect();

    let model = NewFile { path: path.into(), parts: model };
    let written = files.iter().chain([&model]).map(NewFile::as_file).collect();
    let files = stand_ins.iter().chain(&for_now).chain(&files).chain([&model]);
    monitor.check()?;
    for file in files.clone() {
        let folder = file.path.parent().unwrap_or("".as_ref());
        std::fs::create_dir_all(folder).map_err(Error::io(folder))?;
    }
    let mut steps = files.map(|file| file.write().map(Step::Place)).collect::<Result<Vec<_>>>()?;
    steps.extend(obsolete.into_iter().map(Step::Remove));
    Ok((ModelFiles { read, written }, steps))
}

fn gltf(json: &Value) -> Parts<'static> {
    vec![serde_json::to_vec_pretty(json).expect("keys are strings").into()]
}

/// What stands in for a file while it is replaced.
fn stand_in(file: &Path) -> PathBuf {
    let mut extension = OsStr::new("texbake").to_owned();
    file.extension().into_iter().for_each(|own| extension.extend([OsStr::new("."), own]));
    file.with_extension(extension)
}

/// Whether a file is a stand-in, which a killed process left: what the user calls so has another end.
fn is_stand_in(path: &Path) -> bool {
    let end = || {
        let mut file = input::open(path).ok()?;
        file.seek(SeekFrom::End(-(STAND_IN_MARK.len() as i64))).ok()?;
        let mut end = Vec::new();
        file.read_to_end(&mut end).ok()?;
        Some(end)
    };
    end().is_some_and(|end| end == STAND_IN_MARK)
}

/// The model that refers to stand-ins, if there are any.
fn refer_to(stand_ins: &[NewFile<'_>], json: &Value, path: &Path) -> Option<NewFile<'static>> {
    let mut json = json.clone();
    for uri in uris_mut(&mut json).into_iter().filter(|_| !stand_ins.is_empty()) {
        let Some(Uri::Relative(relative)) = uri.as_str().filter(|uri| !uri::is_data(uri)).map(Uri::of) else {
            continue;
        };
        let place = stand_in(&file_of(path, &relative));
        if stand_ins.iter().any(|file| file.path == place) {
            *uri = uri::of_path(&stand_in(&relative).to_string_lossy().replace('\\', "/")).into();
        }
    }
    (!stand_ins.is_empty()).then(|| NewFile { path: path.into(), parts: gltf(&json) })
}

/// The files of a model's buffers that exist.
fn own_buffers(model: &Path, json: &Value) -> Vec<PathBuf> {
    let uris = json["buffers"].as_array().into_iter().flatten().filter_map(|buffer| buffer["uri"].as_str());
    let files = uris.filter(|uri| !uri::is_data(uri)).filter_map(|uri| match Uri::of(uri) {
        Uri::Relative(relative) => std::fs::canonicalize(file_of(model, &relative)).ok(),
        _ => None,
    });
    files.collect()
}

/// Those of the model that is to be replaced: without it nobody needs them.
fn buffers_of_old_model(path: &Path) -> Vec<PathBuf> {
    if ModelFormat::of(path).is_ok_and(|format| format == ModelFormat::Glb) {
        return Vec::new();
    }
    let old = input::read(path, u64::MAX).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    old.map_or_else(Vec::new, |json| own_buffers(path, &json))
}

impl NewFile<'_> {
    fn as_file(&self) -> ModelFile {
        ModelFile { path: self.path.clone(), bytes: self.parts.iter().map(|part| part.len() as u64).sum() }
    }

    /// Fails if the file, which the user did not name, would replace another one than these buffers or one that a
    /// stand-in among them stands for.
    fn check_place(&self, buffers: &[PathBuf]) -> Result<()> {
        let Ok(place) = std::fs::canonicalize(&self.path) else { return Ok(()) };
        let stand_in = std::fs::canonicalize(stand_in(&self.path)).ok();
        if buffers.contains(&place)
            || stand_in.is_some_and(|place| buffers.contains(&place))
            || self.is_content_of(&place)
        {
            return Ok(());
        }
        let reason = "it belongs to the new model, and exists already with other content";
        Err(Error::file(&self.path, reason, "move or remove it, or write the model as .glb or into another folder"))
    }

    fn is_content_of(&self, path: &Path) -> bool {
        let length = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file).map(|file| file.len());
        length == Some(self.as_file().bytes)
            && std::fs::read(path).is_ok_and(|bytes| bytes.iter().eq(self.parts.iter().flat_map(|part| part.iter())))
    }

    /// The same bytes beside it, if it replaces one of these buffers by other bytes.
    fn stand_in(&self, buffers: &[PathBuf]) -> Option<Self> {
        let place = std::fs::canonicalize(&self.path).ok()?;
        let replaces = buffers.contains(&place) && !self.is_content_of(&place);
        let mark = std::iter::once(Cow::Borrowed(STAND_IN_MARK));
        replaces.then(|| Self { path: stand_in(&self.path), parts: self.parts.iter().cloned().chain(mark).collect() })
    }

    /// Fails if the stand-in would replace a file that is none.
    fn check_stand_in(&self) -> Result<()> {
        if is_stand_in(&self.path) || !self.path.exists() {
            return Ok(());
        }
        let reason = "its name is needed while the model is replaced, and it is no file of texbake's";
        Err(Error::file(&self.path, reason, "move or rename it, or write the model as .glb or into another folder"))
    }

    fn write(&self) -> Result<Replacement> {
        let replacement = Replacement::create(&self.path)?;
        let mut output = BufWriter::new(replacement.output()?);
        let written = self.parts.iter().try_for_each(|part| output.write_all(part)).and_then(|()| output.flush());
        replacement.check()?;
        written.map_err(Error::io(&self.path))?;
        drop(output);
        Ok(replacement)
    }
}

/// Makes all buffers one, with what was added at its end. Those that extensions fill follow it.
///
/// Images of what was no .glb go into it too, so that a .glb stands alone.
fn join_buffers<'a>(
    document: &'a Document,
    edited: &mut Edited<'_>,
    added: Vec<u8>,
    read: &mut Vec<ModelFile>,
) -> Result<Parts<'a>> {
    let images = if document.is_glb { Vec::new() } else { images_of(document, read)? };
    let mut parts = Parts::new();
    let mut end = 0;
    let mut append = |bytes: Cow<'a, [u8]>, alignment: usize| {
        let begin = usize::next_multiple_of(end, alignment);
        parts.push(vec![0; begin - end].into());
        end = begin + bytes.len();
        parts.push(bytes);
        begin
    };

    let is_binary = document.buffers.first().is_some_and(|buffer| buffer.origin == Origin::Inside);
    let joined = if is_binary { 1 } else { document.buffers.len() };
    let mut buffers = vec![json!({})];
    let mut places = Vec::new();
    for (number, buffer) in document.buffers.iter().enumerate() {
        let mut object = document.list("buffers")[number].clone();
        if number >= joined || buffer.origin == Origin::Nowhere {
            places.push((buffers.len(), 0));
            buffers.push(object);
            continue;
        }
        places.push((0, append(buffer.bytes.as_slice().into(), PART_ALIGNMENT)));
        if number == 0 {
            object.as_object_mut().map(|fields| fields.shift_remove("uri"));
            buffers[0] = object;
        }
    }
    if !is_binary {
        move_views(&mut edited.json, &places);
    }
    for (image, type_, bytes) in images {
        let view = json!({ "buffer": 0, "byteLength": bytes.len(), "byteOffset": append(bytes.into(), 4) });
        embed(&mut edited.json, image, type_, view);
    }
    if !added.is_empty() {
        let begin = append(added.into(), 4);
        place_added(edited, 0, begin);
    }
    if end > 0 || buffers.len() > 1 {
        if !(document.is_glb && is_binary && edited.added_views.is_empty()) {
            buffers[0]["byteLength"] = end.into();
        }
        edited.json["buffers"] = buffers.into();
    }
    Ok(parts)
}

/// Gives buffer views the buffers and the offsets that theirs moved to.
fn move_views(json: &mut Value, places: &[(usize, usize)]) {
    for view in json.get_mut("bufferViews").and_then(Value::as_array_mut).into_iter().flatten() {
        move_view(view, places);
        // Compressed data has a place of its own.
        for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
            if let Some(extension) = view.get_mut("extensions").and_then(|extensions| extensions.get_mut(name)) {
                move_view(extension, places);
            }
        }
    }
}

fn move_view(view: &mut Value, places: &[(usize, usize)]) {
    let place = index(view, "buffer").and_then(|buffer| places.get(buffer));
    if let Some(&(buffer, begin)) = place {
        view["buffer"] = buffer.into();
        if begin > 0 {
            view["byteOffset"] = view["byteOffset"].as_u64().unwrap_or(0).saturating_add(begin as u64).into();
        }
    }
}

/// An image's number, type and bytes.
type Image = (usize, String, Vec<u8>);

/// The images in data URIs and in files; addresses stay what they are.
fn images_of(document: &Document, read: &mut Vec<ModelFile>) -> Result<Vec<Image>> {
    let (mut images, mut left) = (Vec::new(), document.max_bytes);
    for (number, image) in document.list("images").iter().enumerate() {
        let Some(uri) = image["uri"].as_str().filter(|uri| !is_url(uri)) else { continue };
        if let Uri::Data(data) = Uri::of(uri) {
            let type_ = uri["data:".len()..].split(';').next().unwrap_or_default().to_owned();
            images.extend(data.map(|bytes| (number, type_, bytes)));
            continue;
        }
        let path = file_of(&document.path, &uri::upward(uri).ok_or_else(|| not_beside(document, uri))?);
        let bytes = read_within(&path, &mut left).map_err(|error| match error {
            Error::Io { source, .. } => document.error(
                format!("its image {uri} cannot be read: {source}"),
                "put the file there, or write .gltf into the folder it came from",
            ),
            other => other,
        })?;
        // What is no image stays where it is; above the folder that may be anything.
        let Some(type_) = image_type(&bytes, image["mimeType"].as_str(), &path) else { continue };
        read.push(ModelFile::new(&path, &bytes));
        images.push((number, type_, bytes));
    }
    Ok(images)
}

/// A file that goes with the model; all of them are held at once, in `left` bytes.
fn read_within(path: &Path, left: &mut u64) -> Result<Vec<u8>> {
    let bytes = read_file(path, *left)?;
    *left -= bytes.len() as u64;
    Ok(bytes)
}

/// By its first bytes; in the model's folder, else as it is called.
fn image_type(bytes: &[u8], claimed: Option<&str>, path: &Path) -> Option<String> {
    let known: [(&[u8], &str); 5] = [
        (b"\x89PNG", "image/png"),
        (b"\xff\xd8\xff", "image/jpeg"),
        (b"\xabKTX 20\xbb", "image/ktx2"),
        (b"DDS ", "image/vnd-ms.dds"),
        (b"RIFF", "image/webp"),
    ];
    let type_ = known.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, type_)| *type_);
    let is_below = !path.components().any(|part| part == Component::ParentDir);
    type_.or(claimed.filter(|_| is_below)).map(str::to_owned)
}

/// Makes an image one of a buffer view.
fn embed(json: &mut Value, image: usize, type_: String, view: Value) {
    let at = json["bufferViews"].as_array().map_or(0, Vec::len);
    put(json, "bufferViews", at, view);
    let Some(image) = json["images"][image].as_object_mut() else { return };
    image.shift_remove("uri");
    image.insert("bufferView".into(), at.into());
    image.entry("mimeType").or_insert(type_.into());
}

/// A file that cannot be beside a model in another folder as it is beside the one that was read.
fn not_beside(document: &Document, uri: &str) -> Error {
    let reason = format!("it refers to {uri:?}, which is not a file in its folder");
    let remedy = match document.is_glb {
        true => "write it into the folder it came from",
        false => "write it into the folder it came from, or as .glb, which holds its images",
    };
    document.error(reason, remedy)
}

/// Gives the new buffer views their buffer, in which what was added begins at `begin`.
fn place_added(edited: &mut Edited<'_>, buffer: usize, begin: usize) {
    for &view in &edited.added_views {
        let view = &mut edited.json["bufferViews"][view];
        view["buffer"] = buffer.into();
        view["byteOffset"] = (index(view, "byteOffset").unwrap_or(0) + begin).into();
    }
}

/// A .glb (glTF 2.0, section 4.4).
fn glb<'a>(document: &'a Document, path: &Path, json: &Value, bin: Parts<'a>) -> Result<Parts<'a>> {
    let json = serde_json::to_vec(json).expect("keys are strings");
    let bin_length: usize = bin.iter().map(|part| part.len()).sum();
    let chunk = |length: usize| if length == 0 { 0 } else { 8 + length.next_multiple_of(4) };
    let length = 12 + chunk(json.len()) + chunk(bin_length) + document.more_chunks.len();
    let Ok(length) = u32::try_from(length) else {
        let reason = format!("it would have {length} bytes, and a .glb has less than 4 GiB");
        return Err(Error::file(path, reason, "write .gltf"));
    };
    let word = |number: usize| (number as u32).to_le_bytes();
    let header = |length: usize, type_: &[u8; 4]| [word(length.next_multiple_of(4)), *type_].concat();
    let padding = |length: usize, byte: u8| vec![byte; length.next_multiple_of(4) - length].into();

    let mut parts: Parts<'a> = vec![[*MAGIC, word(2), length.to_le_bytes()].concat().into()];
    parts.push(header(json.len(), JSON).into());
    let json_padding = padding(json.len(), b' ');
    parts.extend([json.into(), json_padding]);
    if bin_length > 0 {
        parts.push(header(bin_length, BIN).into());
        parts.extend(bin);
        parts.push(padding(bin_length, 0));
    }
    parts.push(document.more_chunks.as_slice().into());
    Ok(parts)
}

/// The file beside a .gltf for what was in the model file and what was added, if that is not in the document itself.
fn buffer_file<'a>(
    document: &'a Document,
    edited: &mut Edited<'_>,
    added: Vec<u8>,
    path: &Path,
) -> Option<NewFile<'a>> {
    if let Some(inside) = document.buffers.first().filter(|buffer| buffer.origin == Origin::Inside) {
        let begin = inside.bytes.len().next_multiple_of(4);
        let gap = vec![0; begin - inside.bytes.len()];
        let buffer = &mut edited.json["buffers"][0];
        if !added.is_empty() {
            buffer["byteLength"] = (begin + added.len()).into();
        }
        let name = free_name(document, path, "", None);
        edited.json["buffers"][0]["uri"] = uri::of_path(&name).into();
        place_added(edited, 0, begin);
        let mut parts: Parts<'a> = vec![inside.bytes.as_slice().into()];
        if !added.is_empty() {
            parts.extend([gap.into(), added.into()]);
        }
        return Some(NewFile { path: path.with_file_name(name), parts });
    }
    if added.is_empty() {
        return None;
    }
    // The tangents of an earlier run, say, which nothing uses any more.
    let added_views: HashSet<usize> = edited.added_views.iter().copied().collect();
    let views = edited.json["bufferViews"].as_array().into_iter().flatten().enumerate();
    let kept = views.filter(|(view, _)| !added_views.contains(view)).map(|(_, view)| view);
    let used: HashSet<usize> = kept.flat_map(buffers_of).collect();
    let once_used: BTreeSet<usize> = document.list("bufferViews").iter().flat_map(buffers_of).collect();
    let free = once_used.into_iter().find(|number| *number < document.buffers.len() && !used.contains(number));
    let has_files = document.buffers.iter().any(|buffer| buffer.origin == Origin::File);
    // The model that was read keeps its buffers, unless it is the one that is replaced.
    let own = free.filter(|_| matches!((path.canonicalize(), document.path.canonicalize()), (Ok(a), Ok(b)) if a == b));
    let name = has_files.then(|| free_name(document, path, "_tangents", own));
    let uri = name.as_ref().map_or_else(|| uri::data_uri(&added), |name| uri::of_path(name));
    let buffer = json!({ "uri": uri, "byteLength": added.len() });
    if edited.json["buffers"].is_null() {
        edited.json["buffers"] = json!([]);
    }
    let buffers = edited.json["buffers"].as_array_mut().expect("it was read");
    let number = free.unwrap_or(buffers.len());
    match buffers.get_mut(number) {
        Some(old) => *old = buffer,
        None => buffers.push(buffer),
    }
    place_added(edited, number, 0);
    name.map(|name| NewFile { path: path.with_file_name(name), parts: vec![added.into()] })
}

/// The buffers that a buffer view, and its compression, lie in.
fn buffers_of(view: &Value) -> impl Iterator<Item = usize> {
    let extensions = view["extensions"].as_object().into_iter().flat_map(|extensions| extensions.values());
    std::iter::once(view).chain(extensions).filter_map(|object| index(object, "buffer"))
}

/// The name of a buffer's file, after the model's: none that the document, but for one buffer, uses.
fn free_name(document: &Document, path: &Path, suffix: &str, without: Option<usize>) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let buffers = document.list("buffers").iter().enumerate();
    let buffers = buffers.filter(|(number, _)| Some(*number) != without).map(|(_, buffer)| buffer);
    // On some systems, names that differ in case alone are one.
    let used: Vec<String> = buffers
        .chain(document.list("images"))
        .filter_map(|object| match Uri::of(object["uri"].as_str().filter(|uri| !uri::is_data(uri))?) {
            Uri::Relative(path) => Some(path.to_string_lossy().to_lowercase()),
            _ => None,
        })
        .collect();
    let name = |number: usize| match number {
        1 => format!("{stem}{suffix}.bin"),
        _ => format!("{stem}{suffix}{number}.bin"),
    };
    (1..).map(name).find(|name| !used.contains(&name.to_lowercase())).expect("one of all numbers")
}

fn is_same_folder(one: &Path, other: &Path) -> bool {
    let folder =
        |path: &Path| std::fs::canonicalize(path.parent().filter(|folder| *folder != "").unwrap_or(".".as_ref()));
    matches!((folder(one), folder(other)), (Ok(one), Ok(other)) if one == other)
}

/// The files that a document refers to, for the same places beside the new one.
fn copied_files(
    document: &Document,
    json: &Value,
    path: &Path,
    files: &mut Vec<NewFile<'_>>,
    read: &mut Vec<ModelFile>,
) -> Result<()> {
    let mut left = document.max_bytes;
    let mut uris = Vec::new();
    collect_uris(json, &mut uris);
    for text in uris {
        let Some(uri) = text.as_str().filter(|uri| !uri::is_data(uri) && !is_url(uri)) else { continue };
        let Uri::Relative(relative) = Uri::of(uri) else { return Err(not_beside(document, uri)) };
        let target = path.with_file_name(&relative);
        if files.iter().any(|file| file.path == target) {
            continue;
        }
        let source = file_of(&document.path, &relative);
        let bytes = read_within(&source, &mut left).map_err(|error| match error {
            Error::Io { source, .. } => document.error(
                format!("it refers to {uri}, which cannot be read: {source}"),
                "put the file there, or write the model into the folder it came from",
            ),
            other => other,
        })?;
        if !read.iter().any(|file| file.path == source) {
            read.push(ModelFile::new(&source, &bytes));
        }
        files.push(NewFile { path: target, parts: vec![bytes.into()] });
    }
    Ok(())
}

/// An address that is the same from any folder.
fn is_url(uri: &str) -> bool {
    uri.split_once("://").is_some_and(|(scheme, _)| scheme.bytes().all(|byte| byte.is_ascii_alphanumeric()))
}

/// Every field called "uri", extensions' too.
fn collect_uris<'a>(value: &'a Value, uris: &mut Vec<&'a Value>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| collect_uris(item, uris)),
        Value::Object(fields) => {
            uris.extend(fields.get("uri"));
            fields.iter().filter(|(name, _)| *name != "extras").for_each(|(_, item)| collect_uris(item, uris));
        }
        _ => {}
    }
}

/// The same, to change them.
fn uris_mut(value: &mut Value) -> Vec<&mut Value> {
    match value {
        Value::Array(items) => items.iter_mut().flat_map(uris_mut).collect(),
        Value::Object(fields) => {
            let fields = fields.iter_mut().filter(|(name, _)| *name != "extras");
            fields.flat_map(|(name, item)| if name == "uri" { vec![item] } else { uris_mut(item) }).collect()
        }
        _ => Vec::new(),
    }
}
