//! What a user can choose.

use crate::map::Convention;
use crate::names::named;
use crate::ops::Precision;

/// How a mesh gets its tangents.
///
/// The default: MikkTSpace for normal maps with green up, flat normals where a mesh has none, `exact`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TangentOptions {
    /// The formula.
    pub method: TangentMethod,
    /// Which way green points in the normal maps, and with it the bitangent: up the image (against v) or down.
    pub convention: Convention,
    /// Normals for a mesh that has none.
    pub missing_normals: MissingNormals,
    /// Whether u that spans more than half the texture, and not more than all of it, in a triangle is taken to have
    /// jumped from 1 to 0 there (Hegde's cylinder). A triangle that would lose its texture area stays as it is. Not for
    /// meshes of which a triangle rightly spans so much.
    pub unwrap: bool,
    /// Degrees, 0 to 90: tangents of vertices at one position become equal if they have the same handedness and neither
    /// they nor the normals are further apart (FGED2 section 7.5).
    pub weld_seams: Option<f32>,
    /// Exact bytes, or speed.
    pub precision: Precision,
}

/// The formula that gives a vertex its tangent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum TangentMethod {
    /// What glTF and every engine expect: Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008, and his
    /// reference implementation. Vertices whose triangles do not belong together are split.
    #[default]
    Mikktspace,
    /// The sum of the triangles' tangents as they are (FGED2 listing 7.4), so a triangle weighs the more the larger
    /// the texture lies on it. A vertex between mirrored halves is split.
    Lengyel,
    /// The average of each triangle's edge along growing u (Hegde, Messing with Tangent Space). A vertex between
    /// mirrored halves is split.
    Hegde,
}

/// Normals for a mesh that has none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MissingNormals {
    /// Each triangle's own, as glTF prescribes: every edge is sharp, and vertices are split.
    #[default]
    Flat,
    /// The sum of the normals of all triangles at a position, each as long as twice its triangle's area.
    Smooth,
}

named! {
    TangentMethod "method" { Mikktspace = "mikktspace", Lengyel = "lengyel", Hegde = "hegde" }
    MissingNormals "normals" { Flat = "flat", Smooth = "smooth" }
}
