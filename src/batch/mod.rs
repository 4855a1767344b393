//! Many textures: which files are height maps, what their maps are called, how they are baked side by side, and what
//! is reported about them. One pair of normal maps: how it is blended, and what is reported about it. One model: how
//! its meshes get tangents, and what is reported about them.
//!
//! ```no_run
//! use std::sync::Arc;
//! use texbake::batch::{Job, MapKind, NameTemplate, Search, run};
//! use texbake::io::{ReadOptions, WriteOptions};
//! use texbake::{BakeOptions, Baker, stream::Monitor};
//!
//! let baker = Arc::new(Baker::auto());
//! let (found, _unreadable_folders) = Search::default().find(&["textures".into()]);
//! let jobs = found.iter().map(|map| {
//!     let outputs = NameTemplate::default().outputs(map, &[MapKind::Normal], "baked".as_ref(), "png")?;
//!     let (read, write, options) = (ReadOptions::default(), WriteOptions::default(), BakeOptions::default());
//!     let (input, baker) = (map.path.clone(), baker.clone());
//!     Ok(Job { input, outputs, normals: None, neighbours: None, read, options, write, baker })
//! });
//! let jobs: Vec<Job> = jobs.collect::<texbake::Result<_>>()?;
//! for (job, outcome) in jobs.iter().zip(run(&jobs, 8, &Monitor::default(), &|_| ())) {
//!     println!("{}: {:?}", job.input.display(), outcome.result);
//! }
//! # Ok::<(), texbake::Error>(())
//! ```

mod blend;
mod discovery;
mod fresh;
#[cfg(feature = "cli")]
mod glob;
mod heights;
mod job;
mod mask;
mod naming;
mod neighbours;
mod normals;
mod offsets;
mod outcome;
mod place;
mod queue;
mod report;
mod role;
mod tangents;
mod targets;
mod tile;
mod tile_template;

pub use blend::{BlendJob, BlendOutcome, BlendReport, FormatReport, LayerFacts, LayerReport, UsedWeights};
pub use discovery::{Found, Search, TemplateOf};
pub use fresh::{Change, FreshPlan, Freshness, KERNEL_VERSION, Reason};
#[cfg(feature = "cli")]
pub use glob::FileGlob;
pub use job::Job;
pub use mask::MaskInput;
pub use naming::{MapKind, NameTemplate, OUTPUT_EXTENSIONS};
pub use neighbours::{Neighbours, TileFolders};
pub use normals::{Degenerate, NormalInput};
pub use offsets::{Decoding, ParallaxNumbers, ParallaxSidecar, WelshNumbers, describe_codes};
pub use outcome::Outcome;
pub(crate) use place::place;
pub use place::with_real_folder;
pub use queue::{Event, run};
pub use report::{
    FileReport, FileResult, JsonFile, Options, Outputs, Report, RunReport, SizeReport, Totals, UsedScale,
};
pub use tangents::{
    LeftOutReport, ModelFileReport, ModelTangents, ModelTangentsReport, PrimitiveTangents, TangentJob,
    TangentOptionsReport,
};
pub use targets::Files;
pub use tile_template::TileTemplate;
