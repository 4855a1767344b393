//! A model whose meshes get tangents.

use super::outcome::Outcome;
use super::report::{RunReport, as_text};
use super::targets::{self, Files};
use crate::baker::{Baker, Ran};
use crate::error::{Error, Result};
use crate::io::{LeftOut, Model, ModelFile, ModelFiles, ModelReadOptions, Primitive};
use crate::ops::tangents::{MissingNormals, TangentOptions, TangentReport};
use crate::stream::Monitor;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A model file, glTF or OBJ, to be written with tangents.
#[derive(Clone)]
pub struct TangentJob {
    /// The model.
    pub input: PathBuf,
    /// The file that is written, `.glb` or `.gltf`; its folders are created.
    pub output: PathBuf,
    /// How tangents are computed.
    pub options: TangentOptions,
    /// Whether bitangents are written too.
    pub bitangents: bool,
    /// How the model is read.
    pub read: ModelReadOptions,
    /// Where it runs.
    pub baker: Arc<Baker>,
}

/// What became of the meshes of a model.
#[derive(Debug, Clone, Default)]
pub struct ModelTangents {
    /// How it ran; `None` if there was nothing to compute.
    pub ran: Option<Ran>,
    /// The primitives that got tangents.
    pub primitives: Vec<PrimitiveTangents>,
    /// Those that did not, and why.
    pub left_out: Vec<LeftOut>,
    /// The files that were read and written: images and buffers, too.
    pub files: ModelFiles,
    /// What computing took, without files.
    pub computing: Duration,
}

/// A primitive with tangents.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PrimitiveTangents {
    /// Its mesh and its number there.
    pub name: String,
    /// How many primitives of the file are the same, and share the result.
    pub shared_by: usize,
    /// How many of them had tangents, which were replaced.
    pub had_tangents: usize,
    /// Whether it had normals of its own.
    pub has_normals: bool,
    /// What was found in it.
    #[serde(flatten)]
    pub found: TangentReport,
}

impl ModelTangents {
    /// The sum over the primitives.
    pub fn total(&self) -> TangentReport {
        self.primitives.iter().map(|primitive| primitive.found).sum()
    }

    /// Vertices, of the meshes as they were read, that got normals because their mesh had none.
    pub fn normals_of_their_own(&self) -> usize {
        let without = self.primitives.iter().filter(|primitive| !primitive.has_normals);
        without.map(|primitive| primitive.found.normals_made).sum()
    }

    /// How many primitives of the file had tangents, which were replaced.
    pub fn had_tangents(&self) -> usize {
        self.primitives.iter().map(|primitive| primitive.had_tangents).sum()
    }

    /// How many primitives of the file have tangents now.
    pub fn with_tangents(&self) -> usize {
        self.primitives.iter().map(|primitive| primitive.shared_by).sum()
    }
}

impl TangentJob {
    /// What it reads and writes.
    pub fn files(&self) -> Files<'_> {
        Files { inputs: vec![&self.input], outputs: vec![&self.output] }
    }

    /// Why it failed, with the name of the file; `None` if it did not.
    pub fn failure(&self, outcome: &Outcome<ModelTangents>) -> Option<String> {
        outcome.failure(self.input.display())
    }

    /// Reads the model, computes the tangents of its primitives and writes it. An output that would overwrite the
    /// input is refused.
    pub fn run(&self, monitor: &Monitor) -> Outcome<ModelTangents> {
        let files = self.files();
        if self.input.is_dir() {
            return Outcome::unopened(a_folder(&self.input));
        }
        if let Some(refusal) = targets::refusals(std::slice::from_ref(&files)).into_iter().flatten().next() {
            return Outcome::unopened(refusal.error());
        }
        let mut outcome = Outcome::of(&files, |warnings| {
            Model::check_output(&self.output)?;
            let mut model = Model::read_with(&self.input, &self.read)?;
            let mut done = self.compute(&mut model, monitor)?;
            done.files = model.write_unless_cancelled(&self.output, monitor)?;
            warnings.extend_from_slice(model.warnings());
            warnings.extend(self::warnings(&done, &self.options));
            Ok(done)
        });
        if let Ok(done) = &outcome.result {
            let sum = |files: &[ModelFile]| files.iter().map(|file| file.bytes).sum();
            (outcome.bytes_in, outcome.bytes_out) = (sum(&done.files.read), sum(&done.files.written));
        }
        outcome
    }

    /// Computes the tangents of one primitive after the other; each is shared out among the threads.
    fn compute(&self, model: &mut Model, monitor: &Monitor) -> Result<ModelTangents> {
        let mut done = ModelTangents { left_out: model.left_out().to_vec(), ..ModelTangents::default() };
        for (index, primitive) in model.primitives().to_vec().into_iter().enumerate() {
            monitor.check()?;
            let mesh = model.mesh(index)?;
            let start = Instant::now();
            let (ran, tangents) = self.baker.tangents_with(&mesh, None, &self.options)?;
            done.computing += start.elapsed();
            // A device that failed once is worth telling, whatever ran the last primitive.
            done.ran = done.ran.filter(|ran| ran.fallback.is_some()).or(Some(ran));
            let Primitive { name, shared_by, had_tangents } = primitive;
            let (has_normals, found) = (mesh.normals().is_some(), tangents.report);
            done.primitives.push(PrimitiveTangents { name, shared_by, had_tangents, has_normals, found });
            let bitangents = self.bitangents.then(|| tangents.bitangents(&mesh)).transpose()?;
            model.set_tangents(index, tangents)?;
            bitangents.map_or(Ok(()), |bitangents| model.set_bitangents(index, bitangents))?;
        }
        Ok(done)
    }
}

/// One model at a time.
fn a_folder(path: &Path) -> Error {
    let folder = path.display();
    let remedy = format!(
        "name a model file in it; several go one by one: \
         for model in {folder}/*.glb; do texbake tangents \"$model\" -o out/; done"
    );
    Error::file(path, "it is a folder", remedy)
}

/// What a user should know about the meshes.
fn warnings(done: &ModelTangents, options: &TangentOptions) -> Vec<String> {
    let counted = |count: &dyn Fn(&PrimitiveTangents) -> usize| {
        let concerned = || done.primitives.iter().filter(|primitive| count(primitive) > 0);
        let total: usize = concerned().map(count).sum();
        let names: Vec<&str> = concerned().map(|primitive| primitive.name.as_str()).collect();
        (total > 0).then(|| format!("{total} ({})", listed(&names)))
    };
    let made = |has_normals: bool| {
        counted(&|primitive| if primitive.has_normals == has_normals { primitive.found.normals_made } else { 0 })
    };
    let undirected = counted(&|primitive| primitive.found.undirected).map(|places| {
        format!(
            "undirected vertices: {places}: their triangles have no area in the texture, or their tangents cancel; \
             they got any tangent at a right angle to the normal, and a normal map does not fit there"
        )
    });
    let jumps = counted(&|primitive| match primitive.found {
        TangentReport { jumps, mirrored: 1.., .. } if !options.unwrap => jumps,
        _ => 0,
    });
    let jumps = jumps.map(|places| {
        format!(
            "triangles whose u spans more than half of the texture: {places}: if it jumps from 1 to 0 there, --unwrap"
        )
    });
    let remade = match options.missing_normals {
        MissingNormals::Flat => "each triangle got its own, as glTF prescribes; --normals smooth rounds the edges",
        MissingNormals::Smooth => "they got smooth ones",
    };
    let missing = made(false).map(|places| format!("vertices without a normal: {places}: {remade}"));
    let zero = made(true).map(|places| format!("vertices whose normal is zero: {places}: they got smooth ones"));
    let normalised = counted(&|primitive| primitive.found.normals_normalised)
        .map(|places| format!("vertices whose normal is not of unit length: {places}: it was normalised"));
    let mut by_reason: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    done.left_out.iter().for_each(|left| by_reason.entry(&left.reason).or_default().push(&left.name));
    let left_out = by_reason.iter().map(|(reason, names)| format!("left out: {}: {reason}", listed(names)));
    let nothing = done.primitives.is_empty().then(|| "no primitive got tangents".to_owned());
    [undirected, jumps, missing, zero, normalised].into_iter().flatten().chain(left_out).chain(nothing).collect()
}

/// Names, of many only the first.
fn listed(names: &[&str]) -> String {
    const SHOWN: usize = 3;
    let shown = names[..names.len().min(SHOWN)].join("; ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown}; and {more} more"),
    }
}

/// The work on a model, for other programs: JSON.
#[derive(Debug, Clone, Serialize)]
pub struct ModelTangentsReport {
    /// Version of texbake.
    pub version: &'static str,
    /// The model.
    #[serde(serialize_with = "as_text")]
    pub input: PathBuf,
    /// The model with tangents.
    #[serde(serialize_with = "as_text")]
    pub output: PathBuf,
    /// What was asked for, by the names of the command line.
    pub options: TangentOptionsReport,
    /// Sums over the primitives.
    pub total: TangentReport,
    /// The primitives that got tangents.
    pub primitives: Vec<PrimitiveTangents>,
    /// Those that did not.
    pub left_out: Vec<LeftOutReport>,
    /// The files that were read: the model, its buffers, and the images that were copied or embedded.
    pub files_read: Vec<ModelFileReport>,
    /// The files of the new model, itself last.
    pub files_written: Vec<ModelFileReport>,
    /// What computing took, without files; null if it did not end well.
    pub compute_milliseconds: Option<f64>,
    /// How it went.
    #[serde(flatten)]
    pub run: RunReport,
}

/// A file of a model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ModelFileReport {
    /// Where it is.
    #[serde(serialize_with = "as_text")]
    pub path: PathBuf,
    /// Its size in bytes.
    pub bytes: u64,
}

/// A primitive that got no tangents.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOutReport {
    /// Its mesh and its number there.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// How tangents were computed, by the names of the command line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TangentOptionsReport {
    /// The formula.
    pub method: String,
    /// Which way green points.
    pub convention: String,
    /// Exact or fast.
    pub precision: String,
    /// Normals for meshes that have none.
    pub normals: String,
    /// Whether texture coordinates were unwrapped.
    pub unwrap: bool,
    /// Degrees between tangents that were made equal.
    pub weld_seams: Option<f32>,
    /// Whether bitangents were written.
    pub bitangent: bool,
    /// Whether primitives without a normal map were taken.
    pub all: bool,
    /// The most bytes that reading might hold in memory.
    pub max_bytes: u64,
}

impl ModelTangentsReport {
    /// What `job` came to.
    pub fn new(job: &TangentJob, outcome: &Outcome<ModelTangents>) -> Self {
        let done = outcome.result.as_ref().ok();
        let ran = done.and_then(|model| model.ran.as_ref());
        let left_out = done.iter().flat_map(|model| &model.left_out);
        let reported = |files: &[ModelFile]| -> Vec<ModelFileReport> {
            files.iter().map(|file| ModelFileReport { path: file.path.clone(), bytes: file.bytes }).collect()
        };
        let files = done.map(|model| model.files.clone()).unwrap_or_default();
        let TangentOptions { method, convention, missing_normals, unwrap, weld_seams, precision } = job.options;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            input: job.input.clone(),
            output: job.output.clone(),
            options: TangentOptionsReport {
                method: method.to_string(),
                convention: convention.to_string(),
                precision: precision.to_string(),
                normals: missing_normals.to_string(),
                unwrap,
                weld_seams,
                bitangent: job.bitangents,
                all: job.read.all,
                max_bytes: job.read.max_bytes,
            },
            total: done.map(ModelTangents::total).unwrap_or_default(),
            primitives: done.map(|model| model.primitives.clone()).unwrap_or_default(),
            left_out: left_out
                .map(|LeftOut { name, reason }| LeftOutReport { name: name.clone(), reason: reason.clone() })
                .collect(),
            files_read: reported(&files.read),
            files_written: reported(&files.written),
            compute_milliseconds: done.map(|model| (model.computing.as_secs_f64() * 1e6).round() / 1e3),
            run: RunReport::new(outcome, ran, &job.baker, job.failure(outcome)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interrupt_before_the_file_has_its_name_leaves_none() {
        let folder = tempfile::tempdir().unwrap();
        let input = folder.path().join("empty.gltf");
        std::fs::write(&input, r#"{ "asset": { "version": "2.0" } }"#).unwrap();
        let job = TangentJob {
            input,
            output: folder.path().join("out/m.glb"),
            options: TangentOptions::default(),
            bitangents: false,
            read: ModelReadOptions::default(),
            baker: Arc::new(Baker::reference()),
        };
        // There is nothing to compute, so nothing but writing can notice it.
        let interrupted = Monitor::default();
        interrupted.cancel();
        assert!(matches!(job.run(&interrupted).result, Err(Error::Cancelled)));
        assert!(!folder.path().join("out").exists());
        assert!(job.run(&Monitor::default()).result.is_ok());
    }
}
