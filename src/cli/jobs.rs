//! What is to be done with each file of a folder, as its settings say.

use super::args::PerFile;
use super::bake::Session;
use super::config::Config;
use super::exit::Failure;
use super::settings::{CodeChoice, Place, open_baker};
use super::values::MapChoice;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use texbake::batch::{Found, Job, MapKind, Neighbours, TileFolders};
use texbake::io::{ReadOptions, WriteOptions, check_roughness};
use texbake::{BakeOptions, Error, Maps, ParallaxFormat};

/// What becomes of the height maps that were found.
#[derive(Default)]
pub struct Jobs {
    pub jobs: Vec<Job>,
    /// Those that get no map.
    pub left_out: Vec<PathBuf>,
    /// Those that cannot be baked as their settings say, which stops no other.
    pub refused: Vec<Refused>,
}

/// A height map that cannot be baked as its settings say.
pub struct Refused {
    pub input: PathBuf,
    /// Why, with the name of the file that is wrong.
    pub reason: String,
}

/// What a settings file says about the file at `path` below the folder that was searched.
pub fn settings_in(config: Option<&Config>, path: &Path) -> PerFile {
    config.map_or_else(PerFile::default, |config| config.settings(path))
}

/// One warning for each tile that is missing between others.
pub fn missing_tiles(jobs: &[Job]) -> Vec<String> {
    let missing: BTreeSet<&PathBuf> =
        jobs.iter().flat_map(|job| &job.neighbours).flat_map(Neighbours::missing).collect();
    let warning = |path: &&PathBuf| {
        format!("{} is missing: tiles beside it are baked as if the whole map ended there", path.display())
    };
    missing.iter().map(warning).collect()
}

/// An error of the settings file `config`, or else of the command line.
pub fn blame(error: Error, config: Option<&Config>) -> Failure {
    match (error, config) {
        (error @ Error::Parameter { .. }, Some(config)) => {
            Failure::Usage(format!("{}: {error}", config.path.display()))
        }
        (error, _) => error.into(),
    }
}

/// What the settings of one file say.
struct Chosen {
    outputs: Maps<PathBuf>,
    place: Place,
    neighbours: Option<Neighbours>,
    options: BakeOptions,
    read: ReadOptions,
    write: WriteOptions,
}

impl Chosen {
    /// `None` if the file gets no map.
    fn new(each: &PerFile, map: &Found, out: &Path, folders: &mut TileFolders) -> texbake::Result<Option<Self>> {
        let settings = &each.settings;
        let maps = MapChoice::kinds(each.maps.as_deref().unwrap_or(&[MapChoice::Map(MapKind::Normal)]))?;
        if maps.is_empty() {
            return Ok(None);
        }
        let (name, format) = (each.name.clone().unwrap_or_default(), each.format.as_deref().unwrap_or("png"));
        let outputs = name.outputs(map, &maps, out, format)?;
        let place = settings.device.place()?;
        let write = settings.mips.write(settings.file.write());
        let normal = outputs.normal.as_ref().map(|path| settings.normal.format(path, &write)).transpose()?;
        let parallax = outputs.parallax.as_ref().map(|path| parallax(each.parallax(), path, &write)).transpose()?;
        let roughness = outputs.roughness.as_ref().map(|path| {
            let options = settings.roughness.options();
            check_roughness(path, options.format, &write).map(|()| options).map_err(|error| match error {
                Error::Parameter { parameter: "roughness", .. } => Error::Parameter {
                    parameter: "maps",
                    value: "roughness too".into(),
                    range: "used with --format ktx2 or dds and with --mips: roughness is what mip levels lose".into(),
                },
                error => error,
            })
        });
        let options = settings.slope.bake(normal, parallax, roughness.transpose()?)?;
        let (read, neighbours) = (settings.input.read(), settings.tiles.around_found(folders, map, &options)?);
        neighbours.iter().try_for_each(|neighbours| neighbours.check(&read, &options, &write))?;
        Ok(Some(Self { outputs, place, neighbours, options, read, write }))
    }
}

/// The format of a parallax map; here its options have longer names.
fn parallax(codes: CodeChoice, output: &Path, write: &WriteOptions) -> texbake::Result<ParallaxFormat> {
    codes.parallax(output, write).map_err(|error| match error {
        Error::Parameter { parameter: "bits", value, range } => {
            Error::Parameter { parameter: "parallax-bits", value, range }
        }
        Error::Parameter { parameter: "encoding", value, range } => {
            Error::Parameter { parameter: "parallax-encoding", value, range }
        }
        error => error,
    })
}

impl Session<'_> {
    /// One job for each file, with its own settings; files that run at the same place share a baker.
    ///
    /// # Errors
    /// [`Failure`] for settings that are wrong for any file, and for options of the command line that are for none.
    pub fn jobs(&self, config: Option<&Config>, found: &[Found]) -> Result<Jobs, Failure> {
        let (arguments, mut bakers) = (self.arguments, self.bakers.borrow_mut());
        let mut folders = TileFolders::default();
        let mut all = Jobs::default();
        for map in found {
            let below = settings_in(config, &map.relative());
            let mut choose = |settings| Chosen::new(settings, map, &arguments.out, &mut folders);
            let chosen = match choose(&arguments.each.clone().or(&below)) {
                Ok(chosen) => chosen,
                Err(error @ Error::Parameter { .. }) => {
                    // Where the command line alone would do, the mistake is in the file.
                    return Err(blame(error, config.filter(|_| choose(&arguments.each).is_ok())));
                }
                Err(error) => {
                    all.refused.push(Refused { input: map.path.clone(), reason: error.to_string() });
                    continue;
                }
            };
            let Some(Chosen { outputs, place, neighbours, options, read, write }) = chosen else {
                all.left_out.push(map.path.clone());
                continue;
            };
            let baker = match bakers.get(&place) {
                Some(baker) => Arc::clone(baker),
                None => {
                    let baker = Arc::new(open_baker(&place)?);
                    bakers.insert(place, baker.clone());
                    baker
                }
            };
            let input = map.path.clone();
            all.jobs.push(Job { input, outputs, normals: None, neighbours, read, options, write, baker });
        }
        if all.refused.is_empty() {
            check_effect(&arguments.each, &all.jobs)?;
        }
        Ok(all)
    }
}

/// Fails if an option of the command line is for none of the maps.
fn check_effect(each: &PerFile, jobs: &[Job]) -> Result<(), Failure> {
    let outputs = || jobs.iter().flat_map(|job| job.outputs.iter());
    if each.parallax() != CodeChoice::default() && jobs.iter().all(|job| job.outputs.parallax.is_none()) {
        let reason = "--parallax-encoding and --parallax-bits are for parallax maps: ask for them with --maps";
        return Err(Failure::Usage(reason.into()));
    }
    each.settings.file.check_effect(outputs().map(PathBuf::as_path))?;
    each.settings.roughness.check_effect(jobs.iter().any(|job| job.outputs.roughness.is_some()))?;
    Ok(each.settings.tiles.check_effect(jobs.iter().any(|job| job.neighbours.is_some()))?)
}
