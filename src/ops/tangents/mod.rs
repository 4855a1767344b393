//! Tangents for meshes: two reductions of a fixed order, so that no result depends on who computes it.
//!
//! ```text
//! mesh -> surface -> fans -> [ triangle: frame -> fan: sum, project, normalise ] -> split vertices
//! ```
//!
//! A fan is the set of corners that share a tangent. Which corners those are is decided once, on the CPU; what a
//! backend computes is the arithmetic between the brackets.

mod faces;
mod fans;
mod finish;
mod formula;
mod mikktspace;
mod options;
mod pieces;
mod reference;
mod seams;
mod shading;
mod surface;
mod triangles;

pub(crate) use faces::Faces;
pub(crate) use fans::Fans;
pub(crate) use finish::finish;
pub use finish::{TangentReport, Tangents};
pub(crate) use formula::*;
pub use options::{MissingNormals, TangentMethod, TangentOptions};
#[cfg(feature = "gpu")]
pub(crate) use reference::tangent_of_fan;
pub(crate) use reference::tangents_of_fans;
pub(crate) use shading::Shading;
pub(crate) use surface::{Surface, TriangleEdges};
pub(crate) use triangles::{BLOCK, Plane, Triangles};

use super::Precision;

/// What a backend needs to know to compute a tangent for each fan.
#[derive(Debug)]
pub(crate) struct TangentPlan<'a> {
    pub method: TangentMethod,
    #[cfg_attr(not(feature = "gpu"), expect(dead_code, reason = "the CPU is fast and exact"))]
    pub precision: Precision,
    pub surface: &'a Surface<'a>,
    pub fans: &'a Fans<'a>,
}
