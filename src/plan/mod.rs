//! What a scene needs: the cheapest maps that keep within its tolerances, measured on the maps themselves.
//!
//! A [`Scene`] says which materials there are, how they are seen, and what may go wrong. A [`Plan`] bakes candidates in
//! memory, measures them and chooses, coarsest resolution and fewest bytes first:
//!
//! - no normal map where no normal leans by more than the tolerance; no parallax where no offset is larger than it;
//! - no texel that covers less than a pixel at the nearest view;
//! - the cheapest codes, the fewest lookups, no tangents where none are needed.
//!
//! What is right is, for a normal, that of the mean slope of the texels that one texel of the map stands for, in double
//! precision; for an offset, that of relief intersection with the whole height map, from pixels spread over it, of which
//! each is seen from its own side, at the shallowest angle and at three more up to straight above. An offset counts as
//! seen from straight above: at a shallow angle the screen shows less of it. The largest error decides, or that of the
//! pixel that 99 of 100 do not exceed: at silhouettes every march finds another edge.
//!
//! The same scene gives the same plan, but for what depends on time: a bake is fast where that saves some on this machine,
//! and a bound on milliseconds is held on its CPU.
//!
//! A plan is a settings file that `texbake bake` runs; its [`Prediction`]s are what was measured, and
//! [`Prediction::check`] measures what was baked against them.
//!
//! A height map and its candidates are held in memory.

mod check;
mod choose;
mod decision;
mod file_plan;
mod frames;
mod method;
mod normals;
mod parallax;
mod precision;
mod prediction;
mod scene;
mod settings;
mod subject;
mod text;
mod unmet;
mod view;
mod visible;

pub use check::Checked;
pub use decision::{Decision, Rejected};
pub use file_plan::{FilePlan, Plan};
pub use prediction::{
    ErrorOf, MapPrediction, MaterialFacts, NormalPrediction, ParallaxPrediction, Prediction, TangentSpace, predictions,
};
pub use scene::{Scene, Tolerance};
pub use settings::check_place;
pub use view::{Seen, Sight, Viewpoint};
