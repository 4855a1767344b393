//! Models: what users read, give tangents and write.

#[cfg(test)]
mod replaced;

use super::document::{Document, ModelFile};
use super::edit::{Edited, Made};
use super::elements::Elements;
use super::scene::{Placement, UNMOVED, placements};
use super::select::{Geometry, Place, Selection, doubts, has_tangents, name, named, primitive_doubts};
use super::write::ModelFormat;
use super::{container, write};
use crate::error::{Error, Result};
use crate::io::{MAX_BYTES, obj};
use crate::mesh::Mesh;
use crate::ops::tangents::Tangents;
use crate::stream::Monitor;
use std::collections::BTreeMap;
use std::path::Path;

/// How a file becomes a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelReadOptions {
    /// Whether primitives without a normal map get tangents too, for their first texture coordinates (TEXCOORD_0).
    /// Primitives of an OBJ always do.
    pub all: bool,
    /// The most bytes that the file, its buffers and the images that go with it may take together; that the values of
    /// its JSON may take; and that the tangents may take. An attribute that no bytes stand for may have a part of it.
    pub max_bytes: u64,
}

impl Default for ModelReadOptions {
    fn default() -> Self {
        Self { all: false, max_bytes: MAX_BYTES }
    }
}

/// A .glb, .gltf or .obj file whose meshes get tangents.
///
/// Everything else in it stays as it was, extensions and extras that texbake does not know included. Bytes of buffers
/// keep their place, those of replaced tangents included, in a .glb and in a `name.bin`; accessors that something else
/// uses are not changed.
///
/// ```no_run
/// use texbake::{Baker, TangentOptions, io::Model};
///
/// let mut model = Model::read("helmet.glb")?;
/// for primitive in 0..model.primitives().len() {
///     let mesh = model.mesh(primitive)?;
///     model.set_tangents(primitive, Baker::auto().tangents(&mesh, &TangentOptions::default())?)?;
/// }
/// model.write("helmet_t.glb")?;
/// # Ok::<(), texbake::Error>(())
/// ```
#[derive(Debug)]
pub struct Model {
    document: Document,
    geometries: Vec<(Geometry, Vec<Place>)>,
    primitives: Vec<Primitive>,
    left_out: Vec<LeftOut>,
    warnings: Vec<String>,
    made: BTreeMap<usize, Made>,
    /// Bytes of all that was made: vertices may be many primitives' own.
    made_bytes: u64,
}

/// A primitive that needs tangents.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Primitive {
    /// Its mesh and its number there, from 0.
    pub name: String,
    /// How many primitives of the file have these vertices, texture coordinates and triangles, and share the result.
    /// Nodes that share a mesh count once.
    pub shared_by: usize,
    /// How many of them have tangents already, which new ones replace.
    pub had_tangents: usize,
}

/// The files that a model was made of, and those it became.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ModelFiles {
    /// The model, its buffers, and the images that were copied or embedded.
    pub read: Vec<ModelFile>,
    /// Those of the new model: the files beside it first, the model last.
    pub written: Vec<ModelFile>,
}

/// A primitive that gets no tangents.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// Its mesh and its number there, from 0.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// What a file holds, counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ModelReport {
    /// Primitives that need tangents, and are not the same as another.
    pub primitives: usize,
    /// Primitives that are the same as one of them, and share its tangents.
    pub shared: usize,
    /// Primitives that get no tangents.
    pub left_out: usize,
}

impl Model {
    /// Reads a model with the default [`ModelReadOptions`].
    ///
    /// # Errors
    /// As [`Model::read_with`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Self::read_with(path, &ModelReadOptions::default())
    }

    /// Reads a model: .glb, .gltf with buffers beside it or in data URIs, or .obj.
    ///
    /// Tangents are needed by primitives with a position, and with the texture coordinates that the normal map of
    /// their material uses, as its KHR_texture_transform says; without a normal map, those of the normal map of its
    /// clearcoat or of its anisotropy; without a material that has one, those of the first of its variants that has.
    ///
    /// # Errors
    /// [`Error::File`] for a file that is damaged, larger than [`ModelReadOptions::max_bytes`], not glTF 2.0 or OBJ,
    /// or has a primitive of which an extension that texbake does not read holds the vertices (Draco, meshopt);
    /// [`Error::Io`].
    pub fn read_with(path: impl AsRef<Path>, options: &ModelReadOptions) -> Result<Self> {
        let path = path.as_ref();
        let is_obj = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"));
        let document = match is_obj {
            true => obj::read(path, options.max_bytes)?,
            false => container::read(path, options.max_bytes)?,
        };
        let Selection { geometries, left_out } = Selection::of(&document, options.all || is_obj)?;
        let primitives = geometries
            .iter()
            .map(|(_, places)| Primitive {
                name: name(&document, places[0]),
                shared_by: places.len(),
                had_tangents: places.iter().filter(|place| has_tangents(&document, **place)).count(),
            })
            .collect();
        let left_out =
            left_out.into_iter().map(|(place, reason)| LeftOut { name: name(&document, place), reason }).collect();
        let of_primitives = geometries
            .iter()
            .flat_map(|(geometry, places)| places.iter().map(move |place| (geometry, *place)))
            .flat_map(|(geometry, place)| primitive_doubts(&document, geometry, place));
        let warnings = document.warnings.iter().cloned().chain(doubts(&document)).chain(of_primitives).collect();
        Ok(Self { document, geometries, primitives, left_out, warnings, made: BTreeMap::new(), made_bytes: 0 })
    }

    /// The primitives that need tangents, in the order of the file. Those that are the same are listed once.
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// The primitives that get no tangents.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// What the user should know about the file.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What was read, counted.
    pub fn report(&self) -> ModelReport {
        let all: usize = self.primitives.iter().map(|primitive| primitive.shared_by).sum();
        ModelReport {
            primitives: self.primitives.len(),
            shared: all - self.primitives.len(),
            left_out: self.left_out.len(),
        }
    }

    /// The mesh of a primitive, by its number in [`Model::primitives`], with positions as they are stored: no node
    /// has moved them, and quantised ones are not scaled. Strips and fans are triangles.
    ///
    /// # Errors
    /// [`Error::File`] names the primitive, and what its accessors have that a [`Mesh`] cannot;
    /// [`Error::Parameter`] if there is no such primitive.
    pub fn mesh(&self, primitive: usize) -> Result<Mesh> {
        let (geometry, places) = self.geometry(primitive)?;
        geometry.mesh(&self.document).map_err(|error| named(&self.document, places[0], error))
    }

    /// The tangents that the file has for a primitive, one for each vertex of [`Model::mesh`], with the sign in w.
    ///
    /// # Errors
    /// As [`Model::mesh`].
    pub fn tangents(&self, primitive: usize) -> Result<Option<Vec<[f32; 4]>>> {
        let (geometry, places) = self.geometry(primitive)?;
        let place = places.iter().copied().find(|place| has_tangents(&self.document, *place));
        let read =
            |place| geometry.tangents(&self.document, place).map_err(|error| named(&self.document, place, error));
        place.map(read).transpose()
    }

    /// Where the nodes of the file's scene put each of [`Model::primitives`], and those that are the same: at least one
    /// place, as it is stored where no node has it.
    ///
    /// # Errors
    /// [`Error::File`] for nodes that are damaged.
    pub fn placements(&self) -> Result<Vec<Vec<Placement>>> {
        let of_meshes = placements(&self.document)?;
        let of_primitive = |(_, places): &(Geometry, Vec<Place>)| {
            let mut meshes: Vec<usize> = places.iter().map(|(mesh, _)| *mesh).collect();
            meshes.dedup();
            let placed = |mesh: &usize| of_meshes.get(&(*mesh as u64)).cloned().unwrap_or_else(|| vec![UNMOVED]);
            meshes.iter().flat_map(placed).collect()
        };
        Ok(self.geometries.iter().map(of_primitive).collect())
    }

    /// Gives a primitive, and those that are the same, the tangents that its mesh has got; they are put into the file
    /// by [`Model::write`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such primitive, or the tangents are not those of its mesh; [`Error::File`] if
    /// all tangents together take more than [`ModelReadOptions::max_bytes`].
    pub fn set_tangents(&mut self, primitive: usize, tangents: Tangents) -> Result<()> {
        let (geometry, places) = self.geometry(primitive)?;
        let vertices = Elements::count(&self.document, geometry.position)
            .map_err(|error| named(&self.document, places[0], error))?;
        check(&tangents, vertices)?;
        let (made, limit) = (Made { tangents, bitangents: None }, self.document.max_bytes);
        let before = self.made.get(&primitive).map_or(0, Made::bytes);
        let bytes = self.made_bytes - before + made.bytes();
        if bytes > limit {
            let reason = format!("the tangents of its primitives take {bytes} bytes, above the limit of {limit}");
            return Err(self.document.error(reason, "raise it with --max-bytes, or split the model"));
        }
        self.made_bytes = bytes;
        self.made.insert(primitive, made);
        Ok(())
    }

    /// Gives a primitive that has got tangents the bitangents of the same vertices ([`Tangents::bitangents`]), as the
    /// attribute `_BITANGENT`. No reader needs them: the sign in a tangent's w and the normal rebuild them.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the primitive has got no tangents, or more or fewer.
    pub fn set_bitangents(&mut self, primitive: usize, bitangents: Vec<[f32; 3]>) -> Result<()> {
        let made = self.made.get_mut(&primitive).ok_or_else(|| {
            Error::parameter("primitive", primitive, "one that has got tangents, which come before bitangents")
        })?;
        let (count, wanted) = (bitangents.len(), made.tangents.tangents.len());
        if count != wanted {
            return Err(Error::parameter("number of bitangents", count, format!("{wanted}, one for each tangent")));
        }
        made.bitangents = Some(bitangents);
        Ok(())
    }

    /// Fails if a model cannot be called `path`; nothing is looked up or created.
    ///
    /// # Errors
    /// [`Error::File`] for another extension than .glb and .gltf.
    pub fn check_output(path: &Path) -> Result<()> {
        ModelFormat::of(path).map(drop)
    }

    /// Writes the model as .glb or .gltf, by the extension.
    ///
    /// A .gltf made of a .glb or an OBJ has its buffer beside it (`name.bin`); one made of a .gltf has the new data in
    /// `name_tangents.bin` beside it, or in a data URI if all its buffers are. In another folder than the one it was
    /// read from, the files that the model refers to are copied beside it; a .glb made of a .gltf or an OBJ holds its
    /// images. Missing folders are made. Each file appears when it is complete, the model last; if it replaces another
    /// model, the old one or the new one is there at any moment, with its own buffers.
    ///
    /// A file beside the model is replaced only if it holds a buffer of the model that is replaced.
    ///
    /// # Errors
    /// [`Error::File`] if the extension is another, a file beside the model exists with other content, a file that the
    /// model refers to cannot be read or would lie above the new one's folder, or an attribute of a split vertex
    /// cannot be copied: nothing is written then; [`Error::Io`].
    pub fn write(&self, path: impl AsRef<Path>) -> Result<ModelFiles> {
        self.write_unless_cancelled(path.as_ref(), &Monitor::default())
    }

    /// The same; no file appears if it is cancelled before all are complete.
    pub(crate) fn write_unless_cancelled(&self, path: &Path, monitor: &Monitor) -> Result<ModelFiles> {
        ModelFormat::of(path)?;
        write::write(&self.document, self.edited()?, path, monitor)
    }

    /// The document with what was made for it.
    fn edited(&self) -> Result<Edited<'_>> {
        let mut edited = Edited::new(&self.document);
        for (&primitive, made) in &self.made {
            let (geometry, places) = &self.geometries[primitive];
            edited.apply(geometry, places, made).map_err(|error| named(&self.document, places[0], error))?;
        }
        Ok(edited)
    }

    fn geometry(&self, primitive: usize) -> Result<&(Geometry, Vec<Place>)> {
        let missing = || Error::parameter("primitive", primitive, format!("below {}", self.geometries.len()));
        self.geometries.get(primitive).ok_or_else(missing)
    }
}

/// Fails if tangents are not of a mesh with so many vertices.
fn check(tangents: &Tangents, vertices: usize) -> Result<()> {
    let count = tangents.tangents.len();
    if count != vertices + tangents.copies.len() {
        return Err(Error::parameter("number of tangents", count, format!("{vertices} and one for each copy")));
    }
    if let Some(normals) = tangents.normals.as_ref().filter(|normals| normals.len() != count) {
        return Err(Error::parameter("number of normals", normals.len(), format!("{count}, one for each tangent")));
    }
    if let Some(copy) = tangents.copies.iter().find(|copy| **copy as usize >= vertices) {
        return Err(Error::parameter("source of a copy", copy, format!("below {vertices}")));
    }
    let mut used = tangents.triangles.iter().flat_map(|triangles| triangles.as_flattened());
    match used.find(|vertex| **vertex as usize >= count) {
        Some(vertex) => Err(Error::parameter("index", vertex, format!("below {count}, the number of tangents"))),
        None => Ok(()),
    }
}
