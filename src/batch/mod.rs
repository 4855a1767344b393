//! Many textures: which files are height maps, what their normal maps are called, how they are baked side by side,
//! and what is reported about them.
//!
//! ```no_run
//! use std::sync::Arc;
//! use texbake::batch::{Job, NameTemplate, Search, run};
//! use texbake::{Baker, NormalOptions, io::ReadOptions, stream::Monitor};
//!
//! let baker = Arc::new(Baker::auto());
//! let (found, _unreadable_folders) = Search::default().find(&["textures".into()]);
//! let jobs = found.iter().map(|map| {
//!     let output = NameTemplate::default().output(map, "baked".as_ref(), "png")?;
//!     let (read, options) = (ReadOptions::default(), NormalOptions::default());
//!     Ok(Job { input: map.path.clone(), output, read, options, baker: baker.clone() })
//! });
//! let jobs: Vec<Job> = jobs.collect::<texbake::Result<_>>()?;
//! for (job, outcome) in jobs.iter().zip(run(&jobs, 8, &Monitor::default(), &|_| ())) {
//!     println!("{}: {:?}", job.input.display(), outcome.result);
//! }
//! # Ok::<(), texbake::Error>(())
//! ```

mod discovery;
mod job;
mod naming;
mod report;
mod targets;

pub use discovery::{Found, Search};
pub use job::{Event, Job, Outcome, run};
pub use naming::{NameTemplate, OUTPUT_EXTENSIONS};
pub use report::{FileReport, FileResult, Options, Report, ReportFile, Totals, UsedScale};
