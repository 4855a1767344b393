//! A scene: which materials it has, how they are seen, and what may go wrong.

mod reader;

use super::prediction::ErrorOf;
use super::view::Viewpoint;
use crate::batch::{FileGlob, Found, Search};
use crate::error::{Error, Result};
use crate::exact::{Rational, Scale};
use crate::io::ReadOptions;
use crate::map::{Convention, Edges};
use crate::ops::bake::{BakeOptions, Filter};
use std::path::{Path, PathBuf};

/// A scene file.
#[derive(Debug)]
pub struct Scene {
    /// The file.
    pub path: PathBuf,
    /// The folder that holds the textures: the one that `bake` is given.
    pub folder: PathBuf,
    /// What the names of height maps end in, if the scene says so.
    pub suffixes: Option<Vec<String>>,
    materials: Vec<SceneMaterial>,
}

/// Height maps that are seen alike.
#[derive(Debug)]
pub(super) struct SceneMaterial {
    globs: Vec<FileGlob>,
    /// Where it begins in the file.
    line: usize,
    pub facts: Facts,
    pub view: Viewpoint,
    pub tolerance: Tolerance,
    /// Width and height that the map covers, in the unit of the view's distance.
    pub extent: Option<[Rational; 2]>,
    pub format: String,
    pub model: Option<PathBuf>,
}

/// What a material is, whatever is baked of it.
#[derive(Debug, Clone)]
pub(super) struct Facts {
    pub read: ReadOptions,
    pub scale: Scale,
    pub filter: Filter,
    pub edges: Edges,
    pub convention: Convention,
}

/// What may go wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// The largest error of a normal in degrees.
    pub normal: f64,
    /// The error of a parallax offset in pixels.
    pub parallax: f64,
    /// Of which pixels.
    pub parallax_of: ErrorOf,
    /// The most bytes that the maps of a height map may have, over its texels.
    pub bytes_per_texel: Option<f64>,
    /// The most milliseconds that parallax mapping may take for a screen full of the material.
    pub milliseconds: Option<f64>,
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`Error::Io`], or [`Error::File`] with file and line.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(Error::io(path))?;
        reader::scene(path, &text)
    }

    /// The height maps in the folder, each with the last material that is for it; `None`: the scene does not show it.
    ///
    /// # Errors
    /// [`Error::File`] for a material without height map, and folders that cannot be searched.
    pub(super) fn files(&self) -> Result<Vec<(Found, Option<&SceneMaterial>)>> {
        if !self.folder.is_dir() {
            let reason = format!("its folder {} is not there", self.folder.display());
            return Err(Error::file(&self.path, reason, "correct folder: it is looked for from the scene file on"));
        }
        let search = self.suffixes.clone().map_or_else(|| Ok(Search::default()), Search::new)?;
        let (found, errors) = search.find(std::slice::from_ref(&self.folder));
        if let Some(error) = errors.into_iter().next() {
            return Err(error);
        }
        for material in &self.materials {
            if !found.iter().any(|map| material.is_for(map)) {
                let at = format!("{}:{}", self.path.display(), material.line);
                let reason = format!("no height map in {} matches {}", self.folder.display(), material.globs());
                let remedy = format!("correct files or folder; names of height maps end in {}", {
                    search.suffixes().join(", ")
                });
                return Err(Error::file(at, reason, remedy));
            }
        }
        let material_of = |map: &Found| self.materials.iter().rev().find(|material| material.is_for(map));
        Ok(found.into_iter().map(|map| (map.clone(), material_of(&map))).collect())
    }
}

impl SceneMaterial {
    fn is_for(&self, map: &Found) -> bool {
        let path = map.relative();
        self.globs.iter().any(|glob| glob.is_match(&path))
    }

    fn globs(&self) -> String {
        self.globs.iter().map(FileGlob::text).collect::<Vec<_>>().join(", ")
    }
}

impl Facts {
    /// A bake without maps; those that are wanted are to be put in.
    pub fn bake(&self) -> BakeOptions {
        let Self { scale, filter, edges, .. } = *self;
        BakeOptions { scale, filter, edges, normal: None, ..BakeOptions::default() }
    }
}
