//! What `fast` may differ from `exact` by: the documented bounds, in one table.

use super::agreement::Bound;

/// The bound of an operation, by the line of the report in which it counts.
pub(crate) fn fast(operation: &str) -> Bound {
    match operation {
        _ => Bound { codes: 1.0, ulps: 16.0, degrees: 1e-5 },
    }
}
