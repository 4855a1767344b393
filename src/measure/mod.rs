//! What each shortcut costs, measured on the user's own maps.
//!
//! [`measure`] measures everything; its pieces are public too: [`TrueNormals`] has the angles of a baked map, [`Views`]
//! the offsets of parallax methods, [`Front`] what each step buys and costs.
//!
//! ```
//! use texbake::measure::{Measured, MeasureOptions, measure};
//! use texbake::stream::Monitor;
//! use texbake::{BakeOptions, Baker, Grid, HeightMap, Scale};
//!
//! let heights = HeightMap::from(Grid::from_fn(32, 32, |x, y| (8 * x ^ 8 * y) as u8)?);
//! let measured = Measured { heights: &heights, detail: None, models: &[], devices: &[Baker::cpu()] };
//! let bake = BakeOptions { scale: Scale::texels(8), ..Default::default() };
//! let options = MeasureOptions { bake, quick: true, runs: 1, ..Default::default() };
//! let figures = measure(&measured, &options, &Monitor::default(), &mut |_| {})?;
//! for step in &figures.fronts[0].steps {
//!     println!("{}", step.words); // from snorm 8 xy to ...: 2 more bytes per texel buys ... times less error, ...
//! }
//! # assert_eq!(figures.normal_maps.len(), 32);
//! # Ok::<(), texbake::Error>(())
//! ```

mod blends;
mod errors;
mod figures;
#[cfg(feature = "cli")]
mod folder;
mod formats;
mod frames;
mod front;
mod fronts;
#[cfg(feature = "gpu")]
mod gpu_time;
mod maps;
mod markdown;
mod normals;
mod offsets;
mod parallax;
#[cfg(feature = "cli")]
mod plots;
mod real;
mod region;
mod report;
mod seen;
mod steps;
mod surfaces;
mod time;

pub use blends::BlendFigure;
pub use errors::Errors;
pub use figures::{Figures, MeasureOptions, Measured, measure};
#[cfg(feature = "cli")]
pub use folder::ReportFolder;
pub use formats::{normal_formats, parallax_formats};
pub use frames::FrameFigure;
pub use front::{Candidate, Front, Statistic, Step, digits, pareto_front};
#[cfg(all(test, feature = "gpu"))]
pub(crate) use gpu_time::WGSL as OFFSET_TIME;
#[cfg(feature = "cli")]
pub(crate) use maps::timed;
pub use maps::{NormalFigure, ParallaxFigure, Stored};
pub use normals::TrueNormals;
#[cfg(feature = "cli")]
pub(crate) use offsets::distance;
pub use offsets::{View, Views};
pub use parallax::{OffsetFigure, OffsetTime, parallax_methods};
pub use region::Region;
pub use report::{Input, Machine, Report};
pub use steps::Progress;
#[cfg(feature = "cli")]
pub(crate) use time::median_time;
