//! `texbake.toml`: defaults, then overrides by glob.
//!
//! Each key is handed to the parser of the command line, so both know the same options and the same values.

use super::args::PerFile;
use clap::{Args, Command, FromArgMatches};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use texbake::batch::{FileGlob, TileTemplate};
use texbake::plan::{Prediction, predictions};
use texbake::{Error, Result};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A settings file.
#[derive(Debug)]
pub struct Config {
    pub path: PathBuf,
    pub suffixes: Option<Vec<String>>,
    /// What a plan predicts; only a check looks at it.
    pub predictions: Vec<Prediction>,
    defaults: PerFile,
    overrides: Vec<Override>,
}

#[derive(Debug)]
struct Override {
    glob: FileGlob,
    settings: PerFile,
}

/// What a settings file is called where none is named.
pub const SETTINGS_NAME: &str = "texbake.toml";

/// The most bytes of a settings file: thousands of overrides. One may lie in a folder that somebody else made.
const MOST_BYTES: u64 = 1 << 20;

impl Config {
    /// Reads `given`, or the settings file in the first folder of `paths`, or the one in the current folder, or none.
    ///
    /// # Errors
    /// [`Error::Io`], or [`Error::File`] with file and line.
    pub fn find(given: Option<&Path>, paths: &[PathBuf]) -> Result<Option<Self>> {
        let first_folder = paths.iter().find(|path| path.is_dir());
        let usual =
            first_folder.map(|folder| folder.join(SETTINGS_NAME)).into_iter().chain([PathBuf::from(SETTINGS_NAME)]);
        let path = given.map(Path::to_owned).or_else(|| usual.into_iter().find(|path| path.is_file()));
        let Some(path) = path else { return Ok(None) };
        let io = |source| Error::Io { path: path.clone(), source };
        let mut bytes = Vec::new();
        // What is no file may have no end.
        File::open(&path).and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes)).map_err(io)?;
        if bytes.len() as u64 > MOST_BYTES {
            let reason = format!("settings have at most {MOST_BYTES} bytes, and it has more");
            return Err(Error::File { path, reason, remedy: "is it another file?".into() });
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes());
            Source { path: &path, text: &text }.error(valid, "it is no text in UTF-8", "save it as UTF-8")
        })?;
        Self::parse(&path, &text).map(Some)
    }

    /// The settings of the file at `path` below the folder that was searched: key by key, those of the last override
    /// that matches and has the key, then the defaults.
    pub fn settings(&self, path: &Path) -> PerFile {
        let matching = self.overrides.iter().rev().filter(|candidate| candidate.glob.is_match(path));
        let overridden = matching.fold(PerFile::default(), |stronger, weaker| stronger.or(&weaker.settings));
        overridden.or(&self.defaults)
    }

    /// What tiles are called, by any of the settings.
    pub fn templates(&self) -> impl Iterator<Item = &TileTemplate> {
        let all = self.overrides.iter().map(|candidate| &candidate.settings).chain([&self.defaults]);
        all.filter_map(|each| each.settings.tiles.neighbours.as_ref())
    }

    /// The globs that match none of `paths`.
    pub fn unused<'a>(&'a self, paths: &'a [PathBuf]) -> impl Iterator<Item = &'a str> {
        let unused = |candidate: &&Override| !paths.iter().any(|path| candidate.glob.is_match(path));
        self.overrides.iter().filter(unused).map(|candidate| candidate.glob.text())
    }

    fn parse(path: &Path, text: &str) -> Result<Self> {
        let source = Source { path, text };
        let document = DeTable::parse(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            source.error(start, error.message(), "correct it")
        })?;
        let (defaults, overrides) = (PerFile::default(), Vec::new());
        let mut config = Self { path: path.into(), suffixes: None, predictions: Vec::new(), defaults, overrides };
        for (key, value) in document.get_ref() {
            match (key.get_ref().as_ref(), value.get_ref()) {
                ("suffix", DeValue::Array(values)) => {
                    let suffixes = values.iter().map(|value| source.string("suffix", value).map(str::to_owned));
                    config.suffixes = Some(suffixes.collect::<Result<_>>()?);
                }
                ("suffix", _) => config.suffixes = Some(vec![source.string("suffix", value)?.to_owned()]),
                ("defaults", DeValue::Table(table)) => config.defaults = source.settings(table, value.span().start)?,
                ("override", DeValue::Array(tables)) => {
                    config.overrides =
                        tables.iter().map(|table| source.parse_override(table)).collect::<Result<_>>()?;
                }
                ("plan", _) => config.predictions = predictions(path, text)?,
                ("defaults", _) => {
                    return Err(source.error(key.span().start, "defaults is no table", "write [defaults]"));
                }
                ("override", _) => {
                    return Err(source.error(key.span().start, "override is no list of tables", "write [[override]]"));
                }
                (other, _) => {
                    let reason = format!("{other} has no meaning here");
                    let remedy =
                        "a settings file holds suffix, [defaults] and [[override]]; options go into the tables";
                    return Err(source.error(key.span().start, reason, remedy));
                }
            }
        }
        Ok(config)
    }
}

/// A settings file as text, to say where something is wrong.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    fn parse_override(&self, value: &Spanned<DeValue<'_>>) -> Result<Override> {
        let start = value.span().start;
        let DeValue::Table(table) = value.get_ref() else {
            return Err(self.error(start, "override is no list of tables", "write [[override]]"));
        };
        let Some(glob) = table.get("glob") else {
            let remedy = "write which files it is for, as glob = \"**/dem_*\"";
            return Err(self.error(start, "this override has no glob", remedy));
        };
        let at = glob.span().start;
        let glob =
            FileGlob::new(self.string("glob", glob)?).map_err(|error| self.error(at, error, "correct the glob"))?;
        Ok(Override { glob, settings: self.settings(table, start)? })
    }

    /// The options of a table; `start` is where it begins.
    fn settings(&self, table: &DeTable<'_>, start: usize) -> Result<PerFile> {
        let mut arguments = Vec::new();
        for (key, value) in table.iter().filter(|(key, _)| key.get_ref() != "glob") {
            let argument = self.argument(key, value)?;
            self.parsed(std::slice::from_ref(&argument), key.span().start)?;
            arguments.push(argument);
        }
        self.parsed(&arguments, start)
    }

    /// `--scale=7/3` for `scale = "7/3"`, `--maps=normal,parallax` for `maps = ["normal", "parallax"]`.
    fn argument(&self, key: &Spanned<std::borrow::Cow<'_, str>>, value: &Spanned<DeValue<'_>>) -> Result<String> {
        let command = parser();
        let name = key.get_ref();
        let Some(option) = command.get_arguments().find(|option| option.get_long() == Some(name)) else {
            let known: Vec<_> = command.get_arguments().filter_map(|option| option.get_long()).collect();
            let remedy = format!("the settings are {}", known.join(", "));
            return Err(self.error(key.span().start, format!("{name} is no setting"), remedy));
        };
        let is_switch = option.get_possible_values().iter().any(|value| value.get_name() == "true");
        let texts: Option<Vec<String>> = match value.get_ref() {
            DeValue::Array(values) => values.iter().map(plain_text).collect(),
            DeValue::Boolean(value) if is_switch => Some(vec![value.to_string()]),
            _ => plain_text(value).map(|text| vec![text]),
        };
        let text = texts.filter(|texts| !texts.is_empty()).map(|texts| texts.join(","));
        let text = text.ok_or_else(|| {
            let remedy = format!("write it as on the command line, {name} = \"...\"");
            let reason = match value.get_ref() {
                DeValue::Array(values) if values.is_empty() => format!("{name} is an empty list"),
                _ => format!("{name} is neither text nor a number, nor a list of them"),
            };
            self.error(value.span().start, reason, remedy)
        })?;
        Ok(format!("--{name}={text}"))
    }

    fn parsed(&self, arguments: &[String], start: usize) -> Result<PerFile> {
        let matches = parser().try_get_matches_from(arguments);
        let settings = matches.and_then(|matches| PerFile::from_arg_matches(&matches));
        settings.map_err(|error| {
            // The parser's first paragraph is the reason; the rest is about a command line.
            let text = error.to_string();
            let reason = text.split("\n\n").next().unwrap_or_default().trim_start_matches("error: ");
            self.error(start, reason.split_whitespace().collect::<Vec<_>>().join(" "), "see texbake bake --help")
        })
    }

    fn string<'v>(&self, key: &str, value: &'v Spanned<DeValue<'_>>) -> Result<&'v str> {
        match value.get_ref() {
            DeValue::String(text) => Ok(text),
            _ => Err(self.error(value.span().start, format!("{key} is no text"), "put it into quotes")),
        }
    }

    fn error(&self, at: usize, reason: impl ToString, remedy: impl Into<String>) -> Error {
        let line = 1 + self.text.as_bytes().iter().take(at).filter(|byte| **byte == b'\n').count();
        let path = format!("{}:{line}", self.path.display()).into();
        Error::File { path, reason: reason.to_string(), remedy: remedy.into() }
    }
}

/// A value as it is written on the command line; `None` if it cannot be.
fn plain_text(value: &Spanned<DeValue<'_>>) -> Option<String> {
    match value.get_ref() {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(number) => Some(number.to_string()),
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        _ => None,
    }
}

/// The options of one file, without anything else.
fn parser() -> Command {
    let command = Command::new(SETTINGS_NAME).no_binary_name(true).disable_help_flag(true).disable_version_flag(true);
    PerFile::augment_args(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Config> {
        Config::parse(Path::new("texbake.toml"), text)
    }

    #[test]
    fn each_key_comes_from_the_last_override_that_has_it_then_from_the_defaults() {
        let config = parse(
            "suffix = ['_dem']\n[defaults]\nscale = 24\nfilter = 'sobel'\n\
             [[override]]\nglob = '**/dem_*'\nscale = 0.35\nbits = 16\n\
             [[override]]\nglob = '*_x.png'\nscale = '7/3'\n",
        );
        let config = config.unwrap();
        let settings = |path: &str| {
            let settings = config.settings(Path::new(path)).settings;
            let (slope, normal) = (settings.slope, settings.normal);
            let text = |value: Option<String>| value.unwrap_or_default();
            let (scale, filter) = (slope.scale.map(|it| it.to_string()), slope.filter.map(|it| it.to_string()));
            (text(scale), text(filter), text(normal.bits.map(|it| it.to_string())))
        };
        let expected = |scale: &str, bits: &str| (scale.to_owned(), "sobel".to_owned(), bits.to_owned());
        assert_eq!(settings("wall.png"), expected("24", ""));
        assert_eq!(settings("dem_1.png"), expected("0.35", "16"));
        assert_eq!(settings("a/b/dem_1.png"), expected("0.35", "16"));
        assert_eq!(settings("a/dem_x.png"), expected("7/3", "16"));
        assert_eq!(config.suffixes, Some(vec!["_dem".to_owned()]));
        let paths = ["a/dem_x.png".into()];
        assert_eq!(config.unused(&paths).count(), 0);
        let paths = ["a/dem_y.png".into()];
        assert_eq!(config.unused(&paths).collect::<Vec<_>>(), ["*_x.png"]);
    }

    #[test]
    fn maps_are_text_or_a_list() {
        use crate::cli::values::MapChoice::{Map, None};
        use texbake::batch::MapKind;
        let (normal, parallax) = (Map(MapKind::Normal), Map(MapKind::Parallax));
        let config = "[defaults]\nmaps = 'parallax,normal'\n[[override]]\nglob = 'a'\nmaps = ['normal', 'parallax']\n\
                      [[override]]\nglob = 'b'\nmaps = ['parallax']\n[[override]]\nglob = 'd'\nmaps = 'none'\n";
        let config = parse(config).unwrap();
        let expected =
            [("a", vec![normal, parallax]), ("b", vec![parallax]), ("c", vec![parallax, normal]), ("d", vec![None])];
        for (name, maps) in expected {
            assert_eq!(config.settings(Path::new(name)).maps, Some(maps), "{name}");
        }
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, parts) in [
            ("[defaults]\nscal = 24\n", ["texbake.toml:2:", "scal is no setting", "maps, name, format"]),
            ("[defaults]\n\nscale = 'x'\n", ["texbake.toml:3:", "'x' for '--scale", "it must be an integer"]),
            ("[defaults]\nfilter = 'sobl'\n", ["texbake.toml:2:", "'sobl' for '--filter", "sobel, scharr"]),
            (
                "[defaults]\nscale = true\n",
                ["texbake.toml:2:", "scale is neither text nor a number", "as on the command line"],
            ),
            ("[defaults]\nmaps = []\n", ["texbake.toml:2:", "maps is an empty list", "maps = \"...\""]),
            ("[defaults]\nmaps = [true]\n", ["texbake.toml:2:", "maps is neither text", "maps = \"...\""]),
            ("[defaults]\nmaps = ['normal', 'bump']\n", ["texbake.toml:2:", "'bump' for '--maps", "normal, parallax"]),
            ("scale = 24\n", ["texbake.toml:1:", "scale has no meaning here", "[defaults] and [[override]]"]),
            ("\n[[override]]\nscale = 24\n", ["texbake.toml:2:", "no glob", "glob = \"**/dem_*\""]),
            ("[[override]]\nglob = '[a'\n", ["texbake.toml:2:", "[a", "correct the glob"]),
            ("[defaults]\nscale = \n", ["texbake.toml:2:", "", "correct it"]),
            ("[defaults]\nscale = 1\nsize = '1x1'\n", ["texbake.toml:1:", "cannot be used with", "--size"]),
            ("[override]\nscale = 1\n", ["texbake.toml:1:", "no list", "write [[override]]"]),
        ] {
            let error = parse(text).unwrap_err().to_string();
            for part in parts {
                assert!(error.contains(part), "{text:?} gives {error:?}, without {part:?}");
            }
        }
    }
}
