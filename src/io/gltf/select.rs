//! Which of a document's primitives get tangents, and for which texture coordinates.

use super::document::{Document, index};
use super::elements::Elements;
use super::transform::TextureTransform;
use crate::error::{Result, plain};
use serde_json::Value;
use std::collections::HashMap;

/// What takes the place of a material's normal map, in the order of its rank.
const NORMAL_TEXTURES: [&str; 3] = [
    "/normalTexture",
    "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
    "/extensions/KHR_materials_anisotropy/anisotropyTexture",
];

/// Extensions that replace the data of what they are on.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Extensions that may be on a primitive and leave its vertices as they are.
const HARMLESS: [&str; 5] = [
    "KHR_materials_variants",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "CESIUM_primitive_outline",
    "KHR_mesh_quantization",
];

/// Vertices with texture coordinates and the triangles between them, wherever the document has them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct Geometry {
    pub position: usize,
    pub normal: Option<usize>,
    pub texcoord: usize,
    pub transform: Option<TextureTransform>,
    pub indices: Option<usize>,
    pub mode: Mode,
}

/// How indices make triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// A primitive's place: the mesh, and its number there.
pub(super) type Place = (usize, usize);

/// What a document has for tangents.
#[derive(Debug, Default)]
pub(super) struct Selection {
    pub geometries: Vec<(Geometry, Vec<Place>)>,
    /// Primitives that get no tangents, and why.
    pub left_out: Vec<(Place, String)>,
}

impl Selection {
    /// Primitives with a normal map, or `all` with texture coordinates.
    pub fn of(document: &Document, all: bool) -> Result<Self> {
        let mut this = Self::default();
        let mut known = HashMap::new();
        for mesh in 0..document.list("meshes").len() {
            let object = document.object("meshes", mesh)?;
            for (number, primitive) in object["primitives"].as_array().into_iter().flatten().enumerate() {
                let place = (mesh, number);
                match geometry(document, primitive, all).map_err(|error| named(document, place, error))? {
                    Err(reason) => this.left_out.push((place, reason)),
                    Ok(geometry) => {
                        let next = this.geometries.len();
                        let at = *known.entry(geometry.clone()).or_insert(next);
                        if at == next {
                            this.geometries.push((geometry, Vec::new()));
                        }
                        this.geometries[at].1.push(place);
                    }
                }
            }
        }
        Ok(this)
    }
}

/// A primitive as its users know it.
pub(super) fn name(document: &Document, (mesh, number): Place) -> String {
    match document.list("meshes")[mesh]["name"].as_str() {
        Some(name) => format!("mesh {mesh} {name:?}, primitive {number}"),
        None => format!("mesh {mesh}, primitive {number}"),
    }
}

/// An error of a primitive, with its name and the file's.
pub(super) fn named(document: &Document, place: Place, error: crate::Error) -> crate::Error {
    use crate::Error;
    let name = name(document, place);
    match error {
        Error::File { path, reason, remedy } => Error::File { path, reason: format!("{name}: {reason}"), remedy },
        Error::Vertex { attribute, vertex, value } => document.error(
            format!("{name}: the {attribute} of vertex {vertex} is {value}, and must be finite numbers"),
            "repair the mesh where it was made",
        ),
        Error::Parameter { parameter, value, range } => {
            document.damaged(format!("{name}: its {parameter} is {value}: it must be {range}"))
        }
        other => other,
    }
}

/// Extensions that change nothing of a vertex, or that texbake takes into account.
const KNOWN: [&str; 10] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

/// What the user should know about a document that can be read nevertheless.
pub(super) fn doubts(document: &Document) -> Vec<String> {
    let is_unknown = |name: &&str| !KNOWN.iter().any(|known| name.starts_with(known)) && !HARMLESS.contains(name);
    let unknown: Vec<&str> = document.required_extensions().filter(is_unknown).collect();
    let unknown = (!unknown.is_empty()).then(|| {
        let names = plain(&unknown.join(", ")).into_owned();
        format!("it requires what texbake does not know, and leaves as it is: {names}")
    });
    unknown.into_iter().collect()
}

/// What the user should know about a primitive that gets tangents.
pub(super) fn primitive_doubts(document: &Document, geometry: &Geometry, place: Place) -> Vec<String> {
    let name = name(document, place);
    let primitive = &document.list("meshes")[place.0]["primitives"][place.1];
    let targets = primitive["targets"].as_array().map_or(&[][..], Vec::as_slice);
    let morphs = targets.iter().any(|target| index(target, "TANGENT").is_some());
    let morphs = morphs.then(|| {
        format!("{name}: the tangents of its morph targets are dropped, for they were made for other tangents")
    });
    let count = Elements::count(document, geometry.indices.unwrap_or(geometry.position)).unwrap_or_default();
    let rest = (geometry.mode == Mode::Triangles && !count.is_multiple_of(3))
        .then(|| format!("{name}: its {count} corners are no whole triangles; the last {} are not used", count % 3));
    morphs.into_iter().chain(rest).collect()
}

/// Whether a primitive has tangents of its own.
pub(super) fn has_tangents(document: &Document, (mesh, number): Place) -> bool {
    index(&document.list("meshes")[mesh]["primitives"][number]["attributes"], "TANGENT").is_some()
}

/// What a primitive's tangents depend on, or why it gets none.
fn geometry(document: &Document, primitive: &Value, all: bool) -> Result<Result<Geometry, String>> {
    let mode = match primitive.get("mode").map_or(Some(4), Value::as_u64) {
        Some(4) => Mode::Triangles,
        Some(5) => Mode::Strip,
        Some(6) => Mode::Fan,
        Some(0) => return Ok(Err("it is made of points, which have no tangents".into())),
        Some(1..=3) => return Ok(Err("it is made of lines, which have no tangents".into())),
        _ => return Err(document.damaged("its mode is none of glTF's")),
    };
    let Some(texture) = normal_texture(document, primitive)?.or(all.then_some(&Value::Null)) else {
        return Ok(Err("its material has no normal map (--all takes it too)".into()));
    };
    let transform = texture.pointer("/extensions/KHR_texture_transform");
    let set = transform.and_then(|transform| index(transform, "texCoord")).or(index(texture, "texCoord")).unwrap_or(0);
    let attributes = &primitive["attributes"];
    let Some(position) = index(attributes, "POSITION") else { return Ok(Err("it has no POSITION".into())) };
    let Some(texcoord) = index(attributes, &format!("TEXCOORD_{set}")) else {
        let user = if texture.is_null() { "" } else { ", which its normal map uses" };
        return Ok(Err(format!("it has no TEXCOORD_{set}{user}")));
    };
    let indices = index(primitive, "indices");
    if Elements::count(document, indices.unwrap_or(position))? < 3 {
        return Ok(Err("it has no triangle".into()));
    }
    let transform = transform.map(|transform| TextureTransform::of(document, transform)).transpose()?.flatten();
    let geometry = Geometry { position, normal: index(attributes, "NORMAL"), texcoord, transform, indices, mode };
    check_readable(document, primitive, &geometry)?;
    Ok(Ok(geometry))
}

/// The texture that a primitive's tangents are for, by its material or else by one of its variants.
fn normal_texture<'a>(document: &'a Document, primitive: &Value) -> Result<Option<&'a Value>> {
    let variants = primitive.pointer("/extensions/KHR_materials_variants/mappings").and_then(Value::as_array);
    let of_variants = variants.into_iter().flatten().filter_map(|mapping| index(mapping, "material"));
    for material in index(primitive, "material").into_iter().chain(of_variants) {
        let material = document.object("materials", material)?;
        let texture = NORMAL_TEXTURES.iter().find_map(|pointer| material.pointer(pointer));
        if texture.is_some() {
            return Ok(texture);
        }
    }
    Ok(None)
}

/// Fails if an extension has other vertices or triangles than the accessors say.
fn check_readable(document: &Document, primitive: &Value, geometry: &Geometry) -> Result<()> {
    check_extensions(document, primitive)?;
    let attributes = primitive["attributes"].as_object().into_iter().flatten();
    let targets = primitive["targets"].as_array().into_iter().flatten().filter_map(Value::as_object).flatten();
    let accessors = attributes.chain(targets).filter_map(|(_, accessor)| accessor.as_u64()).map(|index| index as usize);
    for accessor in accessors.chain(geometry.indices) {
        let accessor = document.object("accessors", accessor)?;
        check_extensions(document, accessor)?;
        let views = ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"];
        for view in views.iter().filter_map(|pointer| accessor.pointer(pointer)?.as_u64()) {
            check_extensions(document, document.object("bufferViews", view as usize)?)?;
        }
    }
    Ok(())
}

fn check_extensions(document: &Document, object: &Value) -> Result<()> {
    for extension in object["extensions"].as_object().into_iter().flat_map(|extensions| extensions.keys()) {
        if COMPRESSIONS.contains(&extension.as_str()) {
            let remedy = "write it without compression (gltf-transform copy decodes), compute tangents, then compress";
            return Err(document.error(format!("it is compressed by {extension}, which texbake does not read"), remedy));
        }
        let is_required = document.required_extensions().any(|required| required == extension);
        if is_required && !HARMLESS.contains(&extension.as_str()) {
            let reason = format!("it requires the extension {extension}, which may change what its vertices mean");
            return Err(document.error(reason, "export the model without it"));
        }
    }
    Ok(())
}
