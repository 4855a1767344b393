//! The material that is shown: of a height map, or of maps that were baked before.

use super::{PreviewArguments, check_overwrites_none};
use crate::cli::exit::Failure;
use crate::cli::print::say;
use crate::cli::settings::{Settings, open_baker};
use std::fs;
use std::path::{Path, PathBuf};
use texbake::batch::{Found, Search};
use texbake::io::{NormalReadOptions, ParallaxReadOptions, WriteOptions};
use texbake::material::Material;
use texbake::{BakeOptions, Error, Grid, HeightMap, NormalFormat, NormalMap, ParallaxFormat, ParallaxMap, Result};

/// A material, and what it is made of.
pub struct Shown {
    pub material: Material,
    /// What it is called.
    pub name: String,
    /// Without heights there is no truth.
    pub has_heights: bool,
    /// Without offsets there are no steps.
    pub has_parallax: bool,
}

/// The files of a material that was baked before.
struct Baked {
    normal: PathBuf,
    parallax: Option<PathBuf>,
    heights: Option<PathBuf>,
    stem: String,
}

impl Shown {
    /// The material that the arguments mean.
    pub fn of(arguments: &PreviewArguments) -> Result<Self, Failure> {
        let settings = &arguments.settings;
        let baked = arguments.material.as_deref().map(Baked::find).transpose()?;
        check_overwrites_none(&arguments.output, baked.iter().flat_map(Baked::files))?;
        let height_file = arguments.input.as_ref().or(baked.as_ref().and_then(|baked| baked.heights.as_ref()));
        let heights =
            height_file.map(|path| heard(path, HeightMap::read_with(path, &settings.input.read()), arguments));
        let heights = heights.transpose()?;
        let format = normal_format(settings)?;
        let parallax = Some(ParallaxFormat::default());
        let options = settings.slope.bake(Some(format), parallax, None)?;
        // --scale is in texels of the file.
        let options = BakeOptions { scale: options.scale.shrunk(settings.input.read().shrink)?, ..options };
        if settings.slope.scale.is_none() && settings.slope.size.is_none() && !arguments.quiet {
            say("the scale is 1, the default, which is nearly flat: most tiling textures take --scale 8 to 50");
        }
        match (baked, heights) {
            (None, None) => {
                Err(Failure::Usage("give a height map, or --material with the folder of a material".into()))
            }
            (None, Some(heights)) => {
                let material = Material::bake(&open_baker(&settings.device.place()?)?, &heights, &options)?;
                let name = arguments.input.as_deref().unwrap_or(Path::new("")).file_name().unwrap_or_default();
                let name = name.to_string_lossy().into_owned();
                Ok(Self { material, name, has_heights: true, has_parallax: true })
            }
            (Some(baked), heights) => baked.shown(arguments, heights, &options),
        }
    }
}

impl Baked {
    /// The one material in a folder, or the one of this name in the folder before it.
    fn find(path: &Path) -> Result<Self, Failure> {
        let (folder, name) = match path.is_dir() {
            true => (path, None),
            false => (path.parent().unwrap_or(Path::new("")), path.file_name().map(|name| name.to_string_lossy())),
        };
        let files = files_of(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
        let named = |suffixes: &[&str]| -> Result<Vec<Found>> {
            let search = Search::new(suffixes.iter().map(|&suffix| suffix.to_owned()).collect())?;
            let below = |path: &PathBuf| search.height_map(folder, path);
            Ok(files.iter().filter_map(below).collect())
        };
        let mut normals = named(&["_normal"])?;
        normals.retain(|found| name.as_ref().is_none_or(|name| *name == found.stem));
        let missing =
            |reason: String, remedy: &str| Err(Failure::Failed(format!("{}: {reason}; {remedy}", path.display())));
        let normal = match &normals[..] {
            [normal] => normal.clone(),
            [] => {
                let reason = match &name {
                    None => "there is no normal map in it, NAME_normal.png or the like".to_owned(),
                    Some(name) => format!("there is neither a folder of this name nor {name}_normal.png or the like"),
                };
                return missing(reason, "bake the maps with texbake bake --maps normal,parallax");
            }
            several => {
                let names: Vec<&str> = several.iter().map(|found| found.stem.as_str()).collect();
                let (names, first) = (names.join(", "), path.join(names[0]));
                let remedy = format!("name one, as --material {}", first.display());
                return missing(format!("it holds several materials: {names}"), &remedy);
            }
        };
        let beside = |suffixes: &[&str]| -> Result<Option<PathBuf>> {
            let same = |found: &Found| (&found.stem, &found.size) == (&normal.stem, &normal.size);
            Ok(named(suffixes)?.into_iter().find(same).map(|found| found.path))
        };
        Ok(Self {
            parallax: beside(&["_parallax"])?,
            heights: beside(&Search::SUFFIXES)?,
            stem: normal.stem.clone(),
            normal: normal.path.clone(),
        })
    }

    /// What is read of it.
    fn files(&self) -> impl Iterator<Item = &Path> {
        [Some(&self.normal), self.parallax.as_ref(), self.heights.as_ref()].into_iter().flatten().map(PathBuf::as_path)
    }

    fn shown(
        self,
        arguments: &PreviewArguments,
        heights: Option<HeightMap>,
        options: &BakeOptions,
    ) -> Result<Shown, Failure> {
        let settings = &arguments.settings.normal;
        let read = NormalReadOptions {
            encoding: settings.encoding,
            channels: settings.channels,
            convention: settings.convention.unwrap_or_default(),
            max_bytes: arguments.settings.input.read().max_bytes,
        };
        let normals = heard(&self.normal, NormalMap::read_with(&self.normal, &read), arguments)?;
        let (has_heights, has_parallax) = (heights.is_some(), self.parallax.is_some() || heights.is_some());
        let heights = match heights {
            Some(heights) => heights,
            // In the plane, everywhere.
            None => {
                HeightMap::try_from(Grid::from_fn(normals.size().width(), normals.size().height(), |_, _| 0.5f32)?)?
            }
        };
        let parallax = match &self.parallax {
            Some(path) => {
                let read = ParallaxReadOptions { encoding: arguments.parallax_encoding, max_bytes: read.max_bytes };
                heard(path, ParallaxMap::read_with(path, &read).map_err(of_parallax), arguments)?
            }
            None => {
                let baker = open_baker(&arguments.settings.device.place()?)?;
                let only = BakeOptions { normal: None, parallax: Some(ParallaxFormat::default()), ..*options };
                let maps = baker.bake(&heights, &only)?;
                maps.parallax.ok_or_else(|| Failure::Failed("no parallax map was baked".into()))?
            }
        };
        let scale = options.scale.resolve(heights.size())?;
        let material = Material::of_maps(&heights, &normals, &parallax, scale, options.edges);
        Ok(Shown { material, name: self.stem, has_heights, has_parallax })
    }
}

/// The files of a folder, by name.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>> {
    let wrong = |source| Error::Io { path: folder.into(), source };
    let paths = fs::read_dir(folder).map_err(wrong)?.map(|entry| entry.map(|entry| entry.path()));
    let mut paths: Vec<PathBuf> = paths.collect::<std::io::Result<_>>().map_err(wrong)?;
    paths.sort();
    Ok(paths)
}

/// A map, once its warnings are said.
fn heard<T>(path: &Path, read: Result<(T, Vec<String>)>, arguments: &PreviewArguments) -> Result<T> {
    let (map, warnings) = read?;
    if !arguments.quiet {
        warnings.iter().for_each(|text| say(format_args!("warning: {}: {text}", path.display())));
    }
    Ok(map)
}

/// An error of the parallax map's encoding; the option `encoding` is the normal map's here.
fn of_parallax(error: Error) -> Error {
    match error {
        Error::Parameter { parameter: "encoding", value, range } => {
            Error::Parameter { parameter: "parallax-encoding", value, range }
        }
        error => error,
    }
}

/// The format that was asked for, if one kind of file can hold it.
fn normal_format(settings: &Settings) -> Result<NormalFormat> {
    let held_by = |name| settings.normal.format(Path::new(name), &WriteOptions::default());
    held_by("map.png").or_else(|error| held_by("map.tif").or_else(|_| held_by("map.exr")).map_err(|_| error))
}
