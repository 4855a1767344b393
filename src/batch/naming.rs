//! What the maps of a height map are called.

use super::Found;
use crate::error::{Error, Result};
use crate::map::Maps;
use crate::names::{named, one_of};
use std::fmt;
use std::path::{Component, Path, PathBuf};
use std::str::FromStr;

/// Formats that a folder bake writes.
pub const OUTPUT_EXTENSIONS: [&str; 5] = ["png", "tif", "exr", "ktx2", "dds"];

/// A map that a height map is baked into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapKind {
    /// The normal map.
    Normal,
    /// The parallax map.
    Parallax,
    /// The roughness map of mip levels, beside another map.
    Roughness,
}

named! {
    MapKind "maps" { Normal = "normal", Parallax = "parallax", Roughness = "roughness" }
}

/// The name of an output without its extension: text, `{stem}` for the input's name without its suffix, `{map}` for
/// `normal`, `parallax` or `roughness`, and `{size}` for the resolution after the suffix (`_2k`, or nothing).
///
/// ```
/// use texbake::batch::NameTemplate;
///
/// assert_eq!(NameTemplate::default().to_string(), "{stem}_{map}{size}");
/// assert!("maps/{stem}_n".parse::<NameTemplate>().is_ok());
/// assert!("../{stem}".parse::<NameTemplate>().is_err());
/// assert!("{name}_n".parse::<NameTemplate>().is_err());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NameTemplate(String);

const STEM: &str = "{stem}";
const MAP: &str = "{map}";
const SIZE: &str = "{size}";

impl Default for NameTemplate {
    /// `{stem}_{map}{size}`: `wall_height_2k.png` becomes `wall_normal_2k.png`.
    fn default() -> Self {
        Self("{stem}_{map}{size}".into())
    }
}

impl FromStr for NameTemplate {
    type Err = Error;

    /// # Errors
    /// [`Error::Parameter`] for other braces than `{stem}`, `{map}` and `{size}`, or a name that would leave the folder.
    fn from_str(text: &str) -> Result<Self> {
        let plain = [STEM, MAP, SIZE].iter().fold(text.to_owned(), |text, part| text.replace(part, ""));
        let stays = Path::new(text).components().all(|part| matches!(part, Component::Normal(_)));
        if plain.contains(['{', '}'])
            || plain.contains(char::is_control)
            || !stays
            || text.is_empty()
            || text.ends_with(['/', '\\'])
        {
            let range = "a file name without extension in which {stem} and {size} stand for parts of the input's name, \
                         and {map} for normal, parallax or roughness";
            return Err(Error::parameter("name", text, range));
        }
        Ok(Self(text.into()))
    }
}

impl fmt::Display for NameTemplate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl NameTemplate {
    /// Where the `maps` of `found` go below the folder `out`; the input's folders are kept.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `extension` is not one of [`OUTPUT_EXTENSIONS`], there is no map, or two maps would have
    /// one name.
    pub fn outputs(&self, found: &Found, maps: &[MapKind], out: &Path, extension: &str) -> Result<Maps<PathBuf>> {
        if !OUTPUT_EXTENSIONS.contains(&extension) {
            return Err(Error::parameter("format", extension, one_of(&OUTPUT_EXTENSIONS)));
        }
        let output =
            |kind| maps.contains(&kind).then(|| out.join(&found.folder).join(self.name(found, kind, extension)));
        let kinds = [MapKind::Normal, MapKind::Parallax, MapKind::Roughness];
        match kinds.map(output) {
            [None, None, None] => Err(Error::parameter("maps", "none", "normal, parallax or normal,parallax")),
            [None, None, Some(_)] => Err(Error::parameter("maps", "roughness", "normal,roughness: it goes with a map")),
            [normal, parallax, _] if normal.is_some() && normal == parallax => {
                let range = "a name with {map} in it, which keeps the normal map and the parallax map apart, \
                             as {stem}_{map}{size}";
                Err(Error::parameter("name", self, range))
            }
            [normal, parallax, roughness] if roughness.is_some() && [&normal, &parallax].contains(&&roughness) => {
                let range = "a name with {map} in it, which keeps the roughness map apart, as {stem}_{map}{size}";
                Err(Error::parameter("name", self, range))
            }
            [normal, parallax, roughness] => Ok(Maps { normal, parallax, roughness }),
        }
    }

    fn name(&self, found: &Found, kind: MapKind, extension: &str) -> PathBuf {
        let name = self.0.replace(SIZE, &found.size).replace(MAP, &kind.to_string());
        // A stem that is all suffix (`--suffix height`, `height.png`) leaves an underscore without its left side.
        let name = if found.stem.is_empty() { name.replace("{stem}_", "") } else { name };
        let name = format!("{}.{extension}", name.replace(STEM, &found.stem));
        // A part of the path that comes out empty, or as `..`, leads nowhere else: `{size}/{stem}` without a size.
        Path::new(&name).components().filter(|part| matches!(part, Component::Normal(_))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::MapKind::{Normal, Parallax};
    use super::*;

    fn outputs(template: &str, stem: &str, size: &str, maps: &[MapKind]) -> Result<Vec<String>> {
        let map = Found {
            path: "x".into(),
            folder: "brick/old".into(),
            stem: stem.into(),
            size: size.into(),
            is_named: false,
        };
        let paths = template.parse::<NameTemplate>().unwrap().outputs(&map, maps, Path::new("out"), "png")?;
        Ok(paths.iter().map(|path| path.to_str().unwrap().replace('\\', "/")).collect())
    }

    #[test]
    fn templates_put_the_parts_in_place() {
        for (template, stem, size, path) in [
            ("{stem}_{map}{size}", "wall", "_2k", "out/brick/old/wall_normal_2k.png"),
            ("{stem}_{map}{size}", "wall.v2", "", "out/brick/old/wall.v2_normal.png"),
            ("{stem}_{map}{size}", "", "_4k", "out/brick/old/normal_4k.png"),
            ("{map}/{stem}", "{map}", "", "out/brick/old/normal/{map}.png"),
            ("{stem}/n", "wall", "_2k", "out/brick/old/wall/n.png"),
            ("n", "wall", "", "out/brick/old/n.png"),
        ] {
            assert_eq!(outputs(template, stem, size, &[Normal]).unwrap(), [path]);
        }
    }

    #[test]
    fn each_map_has_a_name_of_its_own() {
        let both = ["out/brick/old/wall_normal_2k.png", "out/brick/old/wall_parallax_2k.png"];
        assert_eq!(outputs("{stem}_{map}{size}", "wall", "_2k", &[Parallax, Normal]).unwrap(), both);
        assert_eq!(outputs("{stem}_p", "wall", "", &[Parallax]).unwrap(), ["out/brick/old/wall_p.png"]);
        let error = outputs("{stem}_n", "wall", "", &[Normal, Parallax]).unwrap_err().to_string();
        assert!(error.starts_with("name is {stem}_n: it must be a name with {map} in it"), "{error}");
        let error = outputs("{stem}_n", "wall", "", &[]).unwrap_err().to_string();
        assert_eq!(error, "maps is none: it must be normal, parallax or normal,parallax");
    }

    #[test]
    fn other_formats_are_refused() {
        let map =
            Found { path: "x".into(), folder: PathBuf::new(), stem: "x".into(), size: String::new(), is_named: false };
        let error = NameTemplate::default().outputs(&map, &[Normal], Path::new("out"), "jpg").unwrap_err();
        assert_eq!(error.to_string(), "format is jpg: it must be png, tif, exr, ktx2 or dds");
    }
}
