//! What a normal map is called.

use super::Found;
use crate::error::{Error, Result};
use crate::names::one_of;
use std::fmt;
use std::path::{Component, Path, PathBuf};
use std::str::FromStr;

/// Formats that a folder bake writes.
pub const OUTPUT_EXTENSIONS: [&str; 3] = ["png", "tif", "exr"];

/// The name of an output without its extension: text, `{stem}` for the input's name without its suffix, and `{size}`
/// for the resolution after it (`_2k`, or nothing).
///
/// ```
/// use texbake::batch::NameTemplate;
///
/// assert_eq!(NameTemplate::default().to_string(), "{stem}_normal{size}");
/// assert!("maps/{stem}_n".parse::<NameTemplate>().is_ok());
/// assert!("../{stem}".parse::<NameTemplate>().is_err());
/// assert!("{name}_n".parse::<NameTemplate>().is_err());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NameTemplate(String);

const STEM: &str = "{stem}";
const SIZE: &str = "{size}";

impl Default for NameTemplate {
    /// `{stem}_normal{size}`: `wall_height_2k.png` becomes `wall_normal_2k.png`.
    fn default() -> Self {
        Self("{stem}_normal{size}".into())
    }
}

impl FromStr for NameTemplate {
    type Err = Error;

    /// # Errors
    /// [`Error::Parameter`] for other braces than `{stem}` and `{size}`, or a name that would leave the folder.
    fn from_str(text: &str) -> Result<Self> {
        let plain = text.replace(STEM, "").replace(SIZE, "");
        let stays = Path::new(text).components().all(|part| matches!(part, Component::Normal(_)));
        if plain.contains(['{', '}']) || !stays || text.is_empty() || text.ends_with(['/', '\\']) {
            let range = "a file name without extension in which {stem} and {size} stand for parts of the input's name";
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
    /// Where the normal map of `map` goes below the folder `out`; the input's folders are kept.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `extension` is not one of [`OUTPUT_EXTENSIONS`].
    pub fn output(&self, map: &Found, out: &Path, extension: &str) -> Result<PathBuf> {
        if !OUTPUT_EXTENSIONS.contains(&extension) {
            return Err(Error::parameter("format", extension, one_of(&OUTPUT_EXTENSIONS)));
        }
        // A stem that is all suffix (`--suffix height`, `height.png`) leaves an underscore without its left side.
        let name = self.0.replace(SIZE, &map.size);
        let name = if map.stem.is_empty() { name.replace("{stem}_", "") } else { name };
        let name = name.replace(STEM, &map.stem);
        Ok(out.join(&map.folder).join(format!("{name}.{extension}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(template: &str, stem: &str, size: &str) -> String {
        let map = Found { path: "x".into(), folder: "brick/old".into(), stem: stem.into(), size: size.into() };
        let path = template.parse::<NameTemplate>().unwrap().output(&map, Path::new("out"), "png").unwrap();
        path.to_str().unwrap().replace('\\', "/")
    }

    #[test]
    fn templates_put_the_parts_in_place() {
        for (template, stem, size, path) in [
            ("{stem}_normal{size}", "wall", "_2k", "out/brick/old/wall_normal_2k.png"),
            ("{stem}_normal{size}", "wall.v2", "", "out/brick/old/wall.v2_normal.png"),
            ("{stem}_normal{size}", "", "_4k", "out/brick/old/normal_4k.png"),
            ("{stem}/n", "wall", "_2k", "out/brick/old/wall/n.png"),
            ("n", "wall", "", "out/brick/old/n.png"),
        ] {
            assert_eq!(output(template, stem, size), path);
        }
    }

    #[test]
    fn other_formats_are_refused() {
        let map = Found { path: "x".into(), folder: PathBuf::new(), stem: "x".into(), size: String::new() };
        let error = NameTemplate::default().output(&map, Path::new("out"), "jpg").unwrap_err();
        assert_eq!(error.to_string(), "format is jpg: it must be png, tif or exr");
    }
}
