//! A scene: which materials it has, how they are seen, and what may go wrong.

use super::prediction::ErrorOf;
use super::text::{Text, document};
use super::view::{Sight, View, ViewText};
use crate::batch::{Found, OUTPUT_EXTENSIONS, Search};
use crate::error::{Error, Result};
use crate::exact::{Rational, Scale};
use crate::io::{Channel, ColorSpace, RawLayout, ReadOptions};
use crate::map::{Convention, Edges};
use crate::ops::bake::{BakeOptions, Filter};
use globset::{GlobBuilder, GlobMatcher};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// A scene file.
#[derive(Debug)]
pub struct Scene {
    /// The file.
    pub path: PathBuf,
    /// The folder that holds the textures: the one that `bake` is given.
    pub folder: PathBuf,
    /// What the names of height maps end in, if the scene says so.
    pub suffixes: Option<Vec<String>>,
    materials: Vec<Material>,
}

/// Height maps that are seen alike.
#[derive(Debug)]
pub(super) struct Material {
    globs: Vec<GlobMatcher>,
    /// Where it begins in the file.
    line: usize,
    pub facts: Facts,
    pub view: View,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SceneText {
    folder: Option<PathBuf>,
    suffix: Option<OneOrMany>,
    #[serde(default)]
    view: ViewText,
    #[serde(default)]
    tolerance: ToleranceText,
    #[serde(default)]
    material: Vec<Spanned<MaterialText>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

#[derive(Deserialize, Default, Clone)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ToleranceText {
    normal: Option<Spanned<f64>>,
    parallax: Option<Spanned<f64>>,
    #[serde(rename = "parallax-99")]
    parallax_99: Option<Spanned<f64>>,
    bytes_per_texel: Option<Spanned<f64>>,
    milliseconds: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MaterialText {
    files: Spanned<OneOrMany>,
    scale: Option<Text<Rational>>,
    size: Option<Spanned<[Text<Rational>; 2]>>,
    depth: Option<Text<Rational>>,
    filter: Option<Text<Filter>>,
    edge: Option<Text<Edges>>,
    convention: Option<Text<Convention>>,
    channel: Option<String>,
    color_space: Option<Text<ColorSpace>>,
    raw: Option<Text<RawLayout>>,
    format: Option<Spanned<String>>,
    model: Option<PathBuf>,
    #[serde(default)]
    view: ViewText,
    #[serde(default)]
    tolerance: ToleranceText,
}

impl OneOrMany {
    fn into_vec(self) -> Vec<String> {
        match self {
            Self::One(text) => vec![text],
            Self::Many(texts) => texts,
        }
    }
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// [`Error::Io`], or [`Error::File`] with file and line.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(Error::io(path))?;
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &str) -> Result<Self> {
        let scene: SceneText = document(path, text)?;
        let folder_of_scene = path.parent().unwrap_or(Path::new(""));
        let reader = Reader { path, text, folder: folder_of_scene };
        if scene.material.is_empty() {
            let remedy = "list what the scene shows, as [[material]] with files = \"walls/*\"";
            return Err(reader.error(0, "it has no material", remedy));
        }
        let general = (&scene.view, &scene.tolerance);
        let materials = scene.material.into_iter().map(|material| reader.material(material, general));
        Ok(Self {
            path: path.into(),
            folder: match scene.folder {
                Some(folder) => folder_of_scene.join(folder),
                None if folder_of_scene.as_os_str().is_empty() => ".".into(),
                None => folder_of_scene.into(),
            },
            suffixes: scene.suffix.map(OneOrMany::into_vec),
            materials: materials.collect::<Result<_>>()?,
        })
    }

    /// The height maps in the folder, each with the last material that is for it; `None`: the scene does not show it.
    ///
    /// # Errors
    /// [`Error::File`] for a material without height map, and folders that cannot be searched.
    pub(super) fn files(&self) -> Result<Vec<(Found, Option<&Material>)>> {
        let search = self.suffixes.clone().map_or_else(|| Ok(Search::default()), Search::new)?;
        let (found, errors) = search.find(std::slice::from_ref(&self.folder));
        if let Some(error) = errors.into_iter().next() {
            return Err(error);
        }
        for material in &self.materials {
            if !found.iter().any(|map| material.is_for(&below(map))) {
                let at = format!("{}:{}", self.path.display(), material.line);
                let reason = format!("no height map in {} matches {}", self.folder.display(), material.globs());
                let remedy = format!("correct files or folder; names of height maps end in {}", {
                    search.suffixes().join(", ")
                });
                return Err(Error::file(at, reason, remedy));
            }
        }
        let material_of = |map: &Found| self.materials.iter().rev().find(|material| material.is_for(&below(map)));
        Ok(found.into_iter().map(|map| (map.clone(), material_of(&map))).collect())
    }
}

/// The path of a file below the folder that was searched, which globs match.
pub(super) fn below(map: &Found) -> PathBuf {
    map.folder.join(map.path.file_name().unwrap_or_default())
}

impl Material {
    /// As the globs of texbake.toml: one without a folder matches names in every folder.
    fn is_for(&self, path: &Path) -> bool {
        let name = path.file_name().map_or(path, Path::new);
        self.globs.iter().any(|glob| glob.is_match(if glob.glob().glob().contains('/') { path } else { name }))
    }

    fn globs(&self) -> String {
        self.globs.iter().map(|glob| glob.glob().glob()).collect::<Vec<_>>().join(", ")
    }
}

impl Facts {
    /// A bake without maps; those that are wanted are to be put in.
    pub fn bake(&self) -> BakeOptions {
        let Self { scale, filter, edges, .. } = *self;
        BakeOptions { scale, filter, edges, normal: None, ..BakeOptions::default() }
    }
}

/// A scene file as text, to say where something is wrong.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    folder: &'a Path,
}

impl Reader<'_> {
    fn material(
        &self,
        material: Spanned<MaterialText>,
        (view, tolerance): (&ViewText, &ToleranceText),
    ) -> Result<Material> {
        let start = material.span().start;
        let text = material.into_inner();
        let files = text.files.span().start;
        let globs =
            text.files.into_inner().into_vec().iter().map(|glob| self.glob(glob, files)).collect::<Result<_>>()?;
        let extent = text.size.as_ref().map(|size| size.get_ref().each_ref().map(|side| side.0));
        if let Some(size) =
            text.size.as_ref().filter(|_| extent.is_some_and(|it| it.iter().any(|it| it.numerator() <= 0)))
        {
            let remedy = "write the width and height that the map covers, as size = [2.0, 1.5]";
            return Err(self.error(size.span().start, "size is not above zero", remedy));
        }
        let scale = match (text.scale, extent, text.depth) {
            (Some(Text(scale)), _, None) => Scale::texels(scale),
            (None, Some([width, height]), Some(Text(depth))) => Scale::physical(width, height, depth),
            (Some(_), _, Some(_)) => {
                let remedy = "depth is the height of white in the unit of size, scale the same in texels: give one";
                return Err(self.error(start, "this material has both scale and depth", remedy));
            }
            (None, _, _) => {
                let remedy = "write scale = 24 (texels), or size = [2.0, 2.0] and depth = 0.1";
                return Err(self.error(start, "how high this material's white is is missing", remedy));
            }
        };
        let format = text.format.map_or(Ok("png".into()), |format| {
            let wrong = |text: &str| format!("{text} is no format of a map");
            match OUTPUT_EXTENSIONS.contains(&format.get_ref().as_str()) {
                true => Ok(format.get_ref().clone()),
                false => Err(self.error(format.span().start, wrong(format.get_ref()), "write png, tif or exr")),
            }
        })?;
        let view = self.view(&text.view.over(view), extent, start)?;
        let tolerance = self.tolerance(&text.tolerance, tolerance, start)?;
        if tolerance.milliseconds.is_some() && view.resolution.is_none() {
            let remedy = "write resolution = [1920, 1080] into the view";
            return Err(self.error(start, "milliseconds are for a screen, whose resolution is missing", remedy));
        }
        let read = ReadOptions {
            channel: text.channel.map(|name| match name.parse::<Channel>() {
                Ok(channel) => channel,
                Err(never) => match never {},
            }),
            color_space: text.color_space.map(|it| it.0).unwrap_or_default(),
            raw: text.raw.map(|it| it.0),
            ..ReadOptions::default()
        };
        let facts = Facts {
            read,
            scale,
            filter: text.filter.map(|it| it.0).unwrap_or_default(),
            edges: text.edge.map(|it| it.0).unwrap_or_default(),
            convention: text.convention.map(|it| it.0).unwrap_or_default(),
        };
        let model = text.model.map(|model| self.folder.join(model));
        Ok(Material { globs, line: self.line(start), facts, view, tolerance, extent, format, model })
    }

    fn glob(&self, glob: &str, at: usize) -> Result<GlobMatcher> {
        let matcher = GlobBuilder::new(glob).literal_separator(true).build();
        matcher.map(|glob| glob.compile_matcher()).map_err(|error| self.error(at, error, "correct the glob"))
    }

    fn view(&self, view: &ViewText, extent: Option<[Rational; 2]>, start: usize) -> Result<View> {
        let view = view.resolve().map_err(|wrong| {
            self.error(wrong.at.unwrap_or(start), format!("in the view {}", wrong.reason), wrong.remedy)
        })?;
        if matches!(view.sight, Sight::Perspective { .. }) && extent.is_none() {
            let remedy = "write size = [2.0, 2.0], in the unit of the distance; or texels-per-pixel in the view, for a \
                          distance";
            return Err(self.error(start, "how large this material is is missing: it is seen from a distance", remedy));
        }
        Ok(view)
    }

    fn tolerance(&self, own: &ToleranceText, general: &ToleranceText, start: usize) -> Result<Tolerance> {
        let bound = |name: &str, own: &Option<Spanned<f64>>, general: &Option<Spanned<f64>>| {
            let Some(bound) = own.as_ref().or(general.as_ref()) else { return Ok(None) };
            let value = *bound.get_ref();
            if value.is_finite() && value > 0.0 {
                return Ok(Some(value));
            }
            let reason = format!("the tolerance {name} is {value}");
            Err(self.error(bound.span().start, reason, "write a number above zero"))
        };
        let needed = |name: &str, what: &str, found: Option<f64>| {
            found.ok_or_else(|| {
                let remedy = format!("write {name} = {what} into [tolerance] or into this material's tolerance");
                self.error(start, format!("the tolerance {name} is missing"), remedy)
            })
        };
        // A tolerance of a material takes the place of the scene's, whichever pixels either is for.
        let own_parallax = own.parallax.is_some() || own.parallax_99.is_some();
        let parallax_text = if own_parallax { own } else { general };
        if let (Some(_), Some(most)) = (&parallax_text.parallax, &parallax_text.parallax_99) {
            let reason = "both parallax and parallax-99 are given";
            return Err(self.error(most.span().start, reason, "give one: of all pixels, or of 99 of 100"));
        }
        let of_all = bound("parallax", &parallax_text.parallax, &None)?;
        let of_most = bound("parallax-99", &parallax_text.parallax_99, &None)?;
        Ok(Tolerance {
            normal: needed("normal", "1.0 (degrees)", bound("normal", &own.normal, &general.normal)?)?,
            parallax: needed("parallax", "1.0 (pixels)", of_all.or(of_most))?,
            parallax_of: if of_most.is_some() { ErrorOf::Most } else { ErrorOf::All },
            bytes_per_texel: bound("bytes-per-texel", &own.bytes_per_texel, &general.bytes_per_texel)?,
            milliseconds: bound("milliseconds", &own.milliseconds, &general.milliseconds)?,
        })
    }

    fn line(&self, at: usize) -> usize {
        super::text::line(self.text, at)
    }

    fn error(&self, at: usize, reason: impl ToString, remedy: impl Into<String>) -> Error {
        Error::file(format!("{}:{}", self.path.display(), self.line(at)), reason, remedy)
    }
}
