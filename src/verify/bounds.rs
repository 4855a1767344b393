//! What `fast` may differ from `exact` by: the documented bounds, in one table.

use super::agreement::Bound;

/// The bound of an operation on inputs of measure - heights of any scale, normals that lean up to 60 degrees, weights up
/// to 1 in magnitude, triangles that are no slivers -, by the line of the report in which it counts.
pub(crate) fn fast(operation: &str) -> Bound {
    match operation {
        // WGSL lets acos be off by 6.8e-5 radians, by which angles weigh the triangles around a vertex.
        "tangents of mikktspace" => Bound { codes: 0.0, ulps: 3600.0, degrees: 2.5e-2 },
        "tangents of lengyel" | "tangents of hegde" => Bound { codes: 0.0, ulps: 64.0, degrees: 2e-4 },
        _ => Bound { codes: 1.0, ulps: 16.0, degrees: 1e-5 },
    }
}
