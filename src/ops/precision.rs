//! Exact bytes, or speed.

use crate::names::named;

/// Exact bytes, or speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Precision {
    /// The same bytes on every backend; where all inputs hold integer codes the correctly rounded ones.
    #[default]
    Exact,
    /// Native floats. Measured by `cargo bench --bench accuracy`, with normals off by 1e-5 degrees at most:
    ///
    /// - 8 bits: 2.5e-6 of the codes differ, each by one.
    /// - 16 bits: 1e-1 of the codes differ, each by one.
    /// - 16f: a code next to the exact one, where that lies close to the middle between two.
    /// - 32f: most codes differ, in their last four bits; two devices need not agree.
    ///
    /// Tangents (`TEXBAKE_MODELS=target/models cargo bench --bench accuracy -- tangents`, on software GPUs):
    ///
    /// - MikkTSpace: off by 2e-4 degrees at most on smooth surfaces; on real models by 1e-3 in 999 of 1000 corners and
    ///   2.4e-2 at most, where triangles are slivers. Corners whose tangents are equal may be split, or the other way
    ///   round: one vertex of 149 meshes.
    /// - Lengyel, Hegde: no difference where the device divides and takes roots as IEEE says.
    /// - Signs: none differ.
    ///
    /// `texbake verify` holds every device to these bounds, which follow from what WGSL lets operations be off, for
    /// heights of any scale (float heights up to 24), normals that lean up to 60 degrees, weights up to 1 in magnitude
    /// and triangles that are no slivers: one integer code; 8 units in the last place of 1 (2^-10 of 16f, 2^-23 of 32f)
    /// and 2.5e-5 degrees, of blends 20 units and 1.3e-4 degrees; tangents 2.1e-4 degrees, and MikkTSpace's 2.9e-2, since
    /// acos may be off by 2^-11, and angles weigh triangles.
    Fast,
}

named! {
    Precision "precision" { Exact = "exact", Fast = "fast" }
}
