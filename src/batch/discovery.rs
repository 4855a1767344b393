//! Which files are height maps.

use super::place::with_real_folder;
use super::tile_template::TileTemplate;
use crate::error::{Error, Result};
use crate::io::INPUT_EXTENSIONS;
use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use walkdir::{DirEntry, WalkDir};

/// A height map file, and how its name is put together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The file.
    pub path: PathBuf,
    /// The folder that it lies in, relative to the one that was searched; empty for a file that was named.
    pub folder: PathBuf,
    /// Its name without suffix, resolution and extension: `wall` of `wall_height_2k.png`.
    pub stem: String,
    /// The resolution after the suffix, with its underscore: `_2k`. May be empty.
    pub size: String,
    /// Whether the file itself was named, and not a folder above it.
    pub is_named: bool,
}

/// What tiles are called of which a file is one, by its path below the folder that was searched; `None`: it is no tile.
pub type TemplateOf<'a> = &'a dyn Fn(&Path) -> Option<TileTemplate>;

impl Found {
    fn new(path: &Path, folder: &Path, (stem, size): (&str, &str)) -> Self {
        Self { path: path.into(), folder: folder.into(), stem: stem.into(), size: size.into(), is_named: false }
    }

    /// Its path below the folder that was searched, which globs match.
    pub fn relative(&self) -> PathBuf {
        self.folder.join(self.path.file_name().unwrap_or_default())
    }
}

/// What makes a file in a folder a height map: a suffix after its stem, with or without `_2k` or the like behind it,
/// in any case, and the extension of a format that can be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Search {
    suffixes: Vec<String>,
}

impl Default for Search {
    /// [`Search::SUFFIXES`].
    fn default() -> Self {
        Self { suffixes: Self::SUFFIXES.map(str::to_owned).to_vec() }
    }
}

impl Search {
    /// What height maps are commonly called.
    pub const SUFFIXES: [&'static str; 6] = ["_height", "_h", "_disp", "_displacement", "_bump", "_heightmap"];

    /// Files whose stem ends in one of `suffixes`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is none, or one is empty.
    pub fn new(suffixes: Vec<String>) -> Result<Self> {
        if suffixes.is_empty() || suffixes.iter().any(String::is_empty) {
            return Err(Error::parameter("suffix", "empty", "the end of a file's stem, as _height"));
        }
        Ok(Self { suffixes })
    }

    /// What a height map's stem ends in.
    pub fn suffixes(&self) -> &[String] {
        &self.suffixes
    }

    /// The height maps among `paths`: folders are searched in the order of names, links are followed but not in
    /// circles; anything else is taken as it is. What would be found twice at one place counts once. The second list
    /// says which folders could not be searched.
    pub fn find(&self, paths: &[PathBuf]) -> (Vec<Found>, Vec<Error>) {
        self.find_with_tiles(paths, &|_| None)
    }

    /// The same, and tiles of larger maps: `template_of` says what they are called, for the path of each file below the
    /// folder that was searched. Such a name needs no suffix, and keeps its end unless the template
    /// ends in a suffix.
    pub fn find_with_tiles(&self, paths: &[PathBuf], template_of: TemplateOf<'_>) -> (Vec<Found>, Vec<Error>) {
        let (mut found, mut errors) = (Vec::new(), Vec::new());
        for path in paths {
            if path.is_dir() {
                self.find_below(path, template_of, &mut found, &mut errors);
            } else {
                found.push(self.named(path, template_of));
            }
        }
        let mut seen = HashSet::new();
        found.retain(|map| seen.insert((with_real_folder(&map.path), map.folder.clone())));
        (found, errors)
    }

    fn find_below(&self, root: &Path, template_of: TemplateOf<'_>, found: &mut Vec<Found>, errors: &mut Vec<Error>) {
        let wanted = |path: &Path| self.tile(root, path, template_of).or_else(|| self.height_map(root, path));
        // What begins with a dot is some program's own: .git, macOS's ._wall_height.png.
        let is_shown = |entry: &DirEntry| entry.depth() == 0 || !entry.file_name().as_encoded_bytes().starts_with(b".");
        let entries = WalkDir::new(root).follow_links(true).sort_by_file_name().into_iter();
        for entry in entries.filter_entry(is_shown) {
            match entry {
                Ok(entry) if entry.file_type().is_file() => found.extend(wanted(entry.path())),
                Ok(_) => {}
                Err(error) if error.loop_ancestor().is_some() => {}
                Err(error) => match error.path().map(|path| (path.to_owned(), wanted(path))) {
                    // A link to nothing: when it is baked, the error says so.
                    Some((_, Some(map))) => found.push(map),
                    Some((path, None)) if !path.is_symlink() => errors.push(Error::io(path)(error.into())),
                    Some(_) => {}
                    None => errors.push(Error::io(root)(error.into())),
                },
            }
        }
    }

    /// The file `path` below `root`, if its name says that it is a height map.
    pub fn height_map(&self, root: &Path, path: &Path) -> Option<Found> {
        let extension = path.extension()?;
        if !INPUT_EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known)) {
            return None;
        }
        // What is no Unicode becomes replacement characters in the output's name.
        let stem = path.file_stem()?.to_string_lossy();
        Some(Found::new(path, path.parent()?.strip_prefix(root).ok()?, self.split(&stem)?))
    }

    /// The file `path` below `root`, if its name says that it is a tile.
    fn tile(&self, root: &Path, path: &Path, template_of: TemplateOf<'_>) -> Option<Found> {
        let below = path.strip_prefix(root).ok()?;
        let template = template_of(below).filter(|template| template.fits(path))?;
        let stem = path.file_stem()?.to_string_lossy();
        Some(Found::new(path, below.parent()?, self.split_tile(&template, &stem)))
    }

    /// A file that the user named, whatever it is called.
    fn named(&self, path: &Path, template_of: TemplateOf<'_>) -> Found {
        let folder = path.parent().unwrap_or(Path::new(""));
        let found = self.tile(folder, path, template_of).unwrap_or_else(|| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            Found::new(path, Path::new(""), self.split(&stem).unwrap_or((&stem, "")))
        });
        Found { is_named: true, ..found }
    }

    /// What stands before the suffix and after it in the stem of a tile; its numbers are part of no suffix.
    fn split_tile<'a>(&self, template: &TileTemplate, stem: &'a str) -> (&'a str, &'a str) {
        let pattern = template.to_string();
        let pattern = Path::new(&pattern).file_stem().and_then(OsStr::to_str);
        let has_suffix = pattern.is_some_and(|pattern| self.split(pattern).is_some());
        self.split(stem).filter(|_| has_suffix).unwrap_or((stem, ""))
    }

    /// What stands before the suffix and after it; `None` without a suffix.
    fn split<'a>(&self, stem: &'a str) -> Option<(&'a str, &'a str)> {
        let (rest, size) = stem.split_at(resolution_start(stem));
        let longest = self.suffixes.iter().filter(|suffix| ends_with(rest, suffix)).map(String::len).max()?;
        Some((&rest[..rest.len() - longest], size))
    }
}

/// Where `_2k` and the like begins at the end of a stem; its length if it has none.
fn resolution_start(stem: &str) -> usize {
    let is_resolution = |tail: &str| {
        let digits = tail.strip_suffix(['k', 'K']).unwrap_or("");
        !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    stem.rfind('_').filter(|&at| is_resolution(&stem[at + 1..])).unwrap_or(stem.len())
}

/// Whether `text` ends in `suffix`, in any case.
fn ends_with(text: &str, suffix: &str) -> bool {
    let start = text.len().checked_sub(suffix.len());
    start.and_then(|start| text.get(start..)).is_some_and(|end| end.eq_ignore_ascii_case(suffix))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_split_at_their_suffix() {
        let search = Search::default();
        for (stem, parts) in [
            ("wall_height", Some(("wall", ""))),
            ("wall_height_2k", Some(("wall", "_2k"))),
            ("Rock_2K_Displacement", Some(("Rock_2K", ""))),
            ("a_h_H", Some(("a_h", ""))),
            ("plank_HeightMap_16K", Some(("plank", "_16K"))),
            ("_bump", Some(("", ""))),
            ("wall_height_k", None),
            ("wall_height_2", None),
            ("wall_heights", None),
            ("height", None),
            ("épée_h", Some(("épée", ""))),
            ("é", None),
        ] {
            assert_eq!(search.split(stem), parts, "{stem}");
        }
    }

    #[test]
    fn the_longest_suffix_counts() {
        let search = Search::new(vec!["map".into(), "_heightmap".into()]).unwrap();
        assert_eq!(search.split("wall_heightmap"), Some(("wall", "")));
        assert!(Search::new(vec![String::new()]).is_err());
    }
}
