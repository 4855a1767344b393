//! What `fast` may differ from `exact` by: the documented bounds, in one table.
//!
//! WGSL lets + - * give either neighbour, which is an error of u = 2^-23 relative to the result, and inverseSqrt be off by
//! two units. A factor that all components share turns no direction.

use super::agreement::Bound;

/// The bound of an operation, by the line of the report in which it counts: for heights of any scale, float heights by
/// central differences and scales up to 24, normals that lean up to 60 degrees, weights up to 1 in magnitude, and
/// triangles that are no slivers.
pub(crate) fn fast(operation: &str) -> Bound {
    match operation {
        // A slope is a rounded constant times a sum without error, 1.5 u; a component one product more, 1 u: 2.5 u =
        // 3.0e-7 rad. Of float heights the difference is one rounding more. Lengths: half of three u and inverseSqrt.
        "normal map" | "parallax map" | "both in one pass" => Bound { codes: 1.0, ulps: 8.0, degrees: 2.5e-5 },
        // Components of two normals are read with 1.5 u each, multiplied twice and weighted: 5 u of slopes up to
        // 2 tan 60 = 3.5, 18 u = 2.1e-6 rad.
        "blend" => Bound { codes: 1.0, ulps: 20.0, degrees: 1.3e-4 },
        "parallax map of given normals" => Bound { codes: 1.0, ulps: 8.0, degrees: 0.0 },
        // Acos may be off by 2^-11, and so may the weights of triangles by their angles: of directions up to a radian
        // apart the mean by as much. A division by 2.5 units and a root are in each of some 30 roundings besides.
        "tangents of mikktspace" => Bound { codes: 0.0, ulps: 4200.0, degrees: 2.9e-2 },
        // Some 30 roundings of u: 3.6e-6 rad.
        _ => Bound { codes: 0.0, ulps: 32.0, degrees: 2.1e-4 },
    }
}
