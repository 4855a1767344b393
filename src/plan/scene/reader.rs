//! Scene files.

use super::{Facts, Scene, SceneMaterial, Tolerance};
use crate::batch::{FileGlob, OUTPUT_EXTENSIONS};
use crate::error::{Error, Result};
use crate::exact::{Rational, Scale};
use crate::io::{Channel, ColorSpace, INPUT_EXTENSIONS, RawLayout, ReadOptions};
use crate::map::{Convention, Edges};
use crate::ops::bake::Filter;
use crate::plan::prediction::ErrorOf;
use crate::plan::text::{Text, document, line};
use crate::plan::view::{Sight, ViewText, Viewpoint};
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};
use std::fmt;
use std::path::{Path, PathBuf};
use toml::Spanned;

#[derive(serde::Deserialize)]
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

/// One text or a list of them.
struct OneOrMany(Vec<String>);

#[derive(serde::Deserialize, Default, Clone)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ToleranceText {
    normal: Option<Spanned<f64>>,
    parallax: Option<Spanned<f64>>,
    #[serde(rename = "parallax-99")]
    parallax_99: Option<Spanned<f64>>,
    bytes_per_texel: Option<Spanned<f64>>,
    milliseconds: Option<Spanned<f64>>,
}

#[derive(serde::Deserialize)]
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

impl<'de> Deserialize<'de> for OneOrMany {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Texts;
        impl<'de> Visitor<'de> for Texts {
            type Value = OneOrMany;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("text, or a list of texts")
            }

            fn visit_str<E: de::Error>(self, text: &str) -> Result<OneOrMany, E> {
                Ok(OneOrMany(vec![text.into()]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut texts: A) -> Result<OneOrMany, A::Error> {
                let mut all = Vec::new();
                while let Some(text) = texts.next_element()? {
                    all.push(text);
                }
                Ok(OneOrMany(all))
            }
        }
        deserializer.deserialize_any(Texts)
    }
}

/// The scene of a file.
///
/// # Errors
/// [`Error::File`] with file and line.
pub(super) fn scene(path: &Path, text: &str) -> Result<Scene> {
    let scene: SceneText = document(path, text, "correct it; texbake plan --help has the keys")?;
    let folder_of_scene = path.parent().unwrap_or(Path::new(""));
    let reader = Reader { path, text, folder: folder_of_scene };
    if scene.material.is_empty() {
        let remedy = "list what the scene shows, as [[material]] with files = \"walls/*\"";
        return Err(reader.error(0, "it has no material", remedy));
    }
    let general = (&scene.view, &scene.tolerance);
    let materials = scene.material.into_iter().map(|material| reader.material(material, general));
    Ok(Scene {
        path: path.into(),
        folder: match scene.folder {
            Some(folder) => folder_of_scene.join(folder),
            None if folder_of_scene.as_os_str().is_empty() => ".".into(),
            None => folder_of_scene.into(),
        },
        suffixes: scene.suffix.map(|OneOrMany(suffixes)| suffixes),
        materials: materials.collect::<Result<_>>()?,
    })
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
    ) -> Result<SceneMaterial> {
        let start = material.span().start;
        let text = material.into_inner();
        let files = text.files.span().start;
        let OneOrMany(globs) = text.files.into_inner();
        let glob = |glob: &String| FileGlob::new(glob).map_err(|error| self.error(files, error, "correct the glob"));
        let globs = globs.iter().map(glob).collect::<Result<_>>()?;
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
                return Err(self.error(start, "scale, or size and depth, is missing", remedy));
            }
        };
        let format = text.format.map_or(Ok("png".into()), |format| {
            let wrong = |text: &str| format!("{text} is no format of a map");
            // A plan reads its maps again.
            let is_read = |name: &str| OUTPUT_EXTENSIONS.contains(&name) && INPUT_EXTENSIONS.contains(&name);
            match is_read(format.get_ref()) {
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
        if let Some(model) = model.as_ref().filter(|model| !model.is_file()) {
            let reason = format!("its model {} is not there", model.display());
            return Err(self.error(start, reason, "correct model: it is looked for from the scene file on"));
        }
        Ok(SceneMaterial { globs, line: self.line(start), facts, view, tolerance, extent, format, model })
    }

    fn view(&self, view: &ViewText, extent: Option<[Rational; 2]>, start: usize) -> Result<Viewpoint> {
        let view = view.resolve().map_err(|wrong| {
            self.error(wrong.at.unwrap_or(start), format!("in the view {}", wrong.reason), wrong.remedy)
        })?;
        if matches!(view.sight, Sight::Perspective { .. }) && extent.is_none() {
            let remedy = "write size = [2.0, 2.0], in the unit of the distance; or texels-per-pixel in the view, for a \
                          distance";
            return Err(self.error(start, "size is missing: this material is seen from a distance", remedy));
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
        line(self.text, at)
    }

    fn error(&self, at: usize, reason: impl ToString, remedy: impl Into<String>) -> Error {
        Error::file(format!("{}:{}", self.path.display(), self.line(at)), reason, remedy)
    }
}
