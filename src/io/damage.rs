//! What is said about damaged files, in every format.

use crate::error::Error;
use std::path::Path;

/// The file ends too early.
pub(super) fn truncated(path: &Path) -> Error {
    Error::file(path, "the file ends before its last row: it is truncated", "copy or export it again")
}

/// The file is not what its format demands, for `reason`.
pub(super) fn damaged(path: &Path, reason: impl ToString) -> Error {
    Error::file(path, reason, "it is damaged; copy or export it again")
}
