//! One height map to bake.

use super::fresh::Written;
use super::heights::HeightWatch;
use super::neighbours::Neighbours;
use super::normals::NormalInput;
use super::outcome::Outcome;
use super::role::{Role, check_same_size};
use super::targets::Files;
use crate::baker::{Baked, Baker};
use crate::error::{Error, Result};
use crate::exact::Scale;
use crate::io::{ReadOptions, WriteOptions, create_codes};
use crate::map::{Maps, Size, TexelFormat};
use crate::ops::bake::BakeOptions;
use crate::stream::{MapOut, Monitor};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One height map to bake.
#[derive(Clone)]
pub struct Job {
    /// The height map file.
    pub input: PathBuf,
    /// The files of its maps, those that `options` ask for; their folders are created.
    pub outputs: Maps<PathBuf>,
    /// A normal map from which a parallax map, baked alone, takes its normals; `None`: those of the heights.
    pub normals: Option<NormalInput>,
    /// The tiles around the input, if it is one of a larger map; `None`: the edges are those of the map itself.
    pub neighbours: Option<Neighbours>,
    /// How the input is read, and by which factor it is reduced.
    pub read: ReadOptions,
    /// What is baked. A scale in texels is one of texels of the file, whatever it is reduced by. Filter and edges do not
    /// matter to a parallax map with a given normal map.
    pub options: BakeOptions,
    /// How the outputs are written.
    pub write: WriteOptions,
    /// Where it runs.
    pub baker: Arc<Baker>,
}

impl Job {
    /// What it reads and writes.
    pub fn files(&self) -> Files<'_> {
        let normals = self.normals.iter().map(|normals| normals.path.as_path());
        let neighbours = self.neighbours.iter().flat_map(Neighbours::files);
        let inputs = [self.input.as_path()].into_iter().chain(normals).chain(neighbours).collect();
        Files { inputs, outputs: self.outputs.iter().map(PathBuf::as_path).collect() }
    }

    /// What each of `jobs` reads and writes.
    pub fn all_files(jobs: &[Self]) -> Vec<Files<'_>> {
        jobs.iter().map(Self::files).collect()
    }

    /// Fails as the bake would if there is no input.
    pub(super) fn check_input(&self) -> Result<()> {
        std::fs::metadata(&self.input).map(drop).map_err(Error::io(&self.input))
    }

    /// Why it failed, with the name of the file; `None` if it did not.
    pub fn failure(&self, outcome: &Outcome) -> Option<String> {
        outcome.failure(self.input.display())
    }

    /// `written` is told what becomes of the outputs.
    pub(super) fn run(&self, written: Option<&Written>, monitor: &Monitor, opened: &dyn Fn(Size)) -> Outcome {
        let create = |size| self.create(size, written);
        Outcome::of(&self.files(), |warnings| {
            let run = Run { create: &create, monitor, opened, warnings };
            match &self.normals {
                None => self.bake(run),
                Some(normals) => self.bake_with(normals, run),
            }
        })
    }

    fn bake(&self, mut run: Run<'_>) -> Result<Baked> {
        let opened = run.opened;
        let heights = HeightWatch::new(&self.input, &self.read);
        let open = || {
            let rows = heights.open(self.options.parallax.is_some())?;
            opened(rows.size());
            Ok(rows)
        };
        let options = BakeOptions { scale: self.scale()?, ..self.options };
        let baked = match &self.neighbours {
            None => self.baker.bake_rows(&open, run.create, &options, run.monitor),
            Some(neighbours) => self.bake_tile(neighbours, &open, &options, &mut run),
        };
        run.warnings.extend(heights.warnings(baked.is_ok()));
        run.warnings.extend(baked.as_ref().ok().and_then(inexact_scale));
        baked
    }

    fn bake_with(&self, normals: &NormalInput, run: Run<'_>) -> Result<Baked> {
        let Run { create, monitor, opened, warnings } = run;
        let (Maps { normal: None, parallax: Some(_), roughness: None }, Some(format), None) =
            (&self.outputs, self.options.parallax, self.options.normal)
        else {
            return Err(Error::parameter("maps", "other maps", "parallax alone, where a normal map is given"));
        };
        if self.neighbours.is_some() {
            return Err(Error::parameter("neighbours", "given", "left out, where a normal map is given"));
        }
        if self.write.mips {
            return Err(Error::parameter("mips", "on", "left out where a normal map is given: levels are of slopes"));
        }
        let given = &normals.path;
        let (heights, normals) = (HeightWatch::new(&self.input, &self.read), normals.watch(Role::GivenNormals));
        let open = || {
            let (rows, normals) = (heights.open(true)?, normals.open()?);
            let remedy = "give the normal map of these heights";
            check_same_size((&self.input, rows.size()), (given, normals.size()), remedy)?;
            opened(rows.size());
            Ok((rows, normals))
        };
        let create = |size| {
            // A scale out of range is told before there is a file.
            self.scale()?.resolve(size)?;
            let Maps { parallax, .. } = create(size)?;
            parallax.map(|map| map.rows).ok_or_else(|| Error::parameter("maps", "none", "parallax"))
        };
        let ran = self.baker.parallax_with_normals_rows(&open, &create, format, self.options.precision, monitor);
        warnings.extend(heights.warnings(ran.is_ok()));
        warnings.extend(normals.warnings(ran.is_ok()).into_iter().map(|text| format!("the normal map {text}")));
        let (ran, size) = ran?;
        let scale = self.scale()?.resolve(size)?;
        let baked = Baked { ran, size, height_type: heights.height_type(), scale };
        warnings.extend(inexact_scale(&baked));
        Ok(baked)
    }

    /// The scale over the map as it is read.
    fn scale(&self) -> Result<Scale> {
        self.options.scale.shrunk(self.read.shrink)
    }

    /// A sink for each output, of whose file `written` is told.
    fn create(&self, size: Size, written: Option<&Written>) -> Result<Maps<MapOut>> {
        self.outputs.iter().try_for_each(|path| create_folder_of(path))?;
        let create = |path: &Option<PathBuf>, format: Option<TexelFormat>| {
            let Some((path, format)) = path.as_ref().zip(format) else { return Ok(None) };
            let witness = written.map(|written| written.witness(path));
            create_codes(path, size, format, &self.write, witness).map(Some)
        };
        let BakeOptions { normal, parallax, roughness, .. } = &self.options;
        Ok(Maps {
            normal: create(&self.outputs.normal, normal.map(|format| format.texel()))?,
            parallax: create(&self.outputs.parallax, parallax.map(|format| format.texel()))?,
            roughness: create(&self.outputs.roughness, roughness.map(|options| options.format.texel()))?,
        })
    }
}

/// What a bake needs to run, and whom it tells what.
pub(super) struct Run<'a> {
    /// Makes the sinks of the outputs.
    pub create: &'a dyn Fn(Size) -> Result<Maps<MapOut>>,
    pub monitor: &'a Monitor,
    /// Is told the size of the map.
    pub opened: &'a dyn Fn(Size),
    pub warnings: &'a mut Vec<String>,
}

/// Makes the folders above a file.
pub(super) fn create_folder_of(file: &Path) -> Result<()> {
    let folder = file.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder).map_err(Error::io(folder))
}

/// Says so if the scale had to be rounded.
fn inexact_scale(baked: &Baked) -> Option<String> {
    let scale = baked.scale;
    (!scale.exact).then(|| format!("the scale has too many digits: {scale}, the nearest one that fits, was used"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::NormalReadOptions;

    #[test]
    fn a_given_normal_map_is_for_a_parallax_map_alone() {
        let given = NormalInput { path: "given.png".into(), read: NormalReadOptions::default() };
        let job = Job {
            input: "h.png".into(),
            outputs: Maps { normal: Some("n.png".into()), parallax: None, roughness: None },
            normals: Some(given),
            neighbours: None,
            read: ReadOptions::default(),
            options: BakeOptions::default(),
            write: WriteOptions::default(),
            baker: Arc::new(Baker::reference()),
        };
        let failure = job.failure(&job.run(None, &Monitor::default(), &|_| ())).unwrap();
        assert_eq!(failure, "h.png: maps is other maps: it must be parallax alone, where a normal map is given");
    }
}
