//! What a file is to a job of several: the options that say how it is read have names of their own there.

use crate::error::{Error, Result};
use crate::map::Size;
use std::path::Path;

/// What a file is to a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// The first normal map of a blend.
    Base,
    /// The second normal map of a blend.
    Detail,
    /// The mask of a blend.
    Mask,
    /// The normal map that a parallax map is given.
    GivenNormals,
}

impl Role {
    /// An error about how the file is read, by the names that the options have for it.
    pub fn named(self, error: Error) -> Error {
        match error {
            Error::Unclear { path, reason, remedy, option, values } => {
                Error::Unclear { path, reason, remedy, option: self.option(option), values }
            }
            Error::Parameter { parameter, value, range } => {
                Error::Parameter { parameter: self.option(parameter), value, range }
            }
            error => error,
        }
    }

    /// The option that is called `name` where there is one file.
    pub fn option(self, name: &'static str) -> &'static str {
        match (self, name) {
            (Self::Base, "encoding") => "base-encoding",
            (Self::Base, "channels") => "base-channels",
            (Self::Detail, "encoding") => "detail-encoding",
            (Self::Detail, "channels") => "detail-channels",
            (Self::GivenNormals, "encoding") => "normal-encoding",
            (Self::GivenNormals, "channels") => "normal-channels",
            (Self::Mask, "channel") => "mask-channel",
            (_, other) => other,
        }
    }
}

/// Fails if the file `other` is not of the size of `first`.
pub(super) fn check_same_size(
    (first, size): (&Path, Size),
    (other, other_size): (&Path, Size),
    remedy: &str,
) -> Result<()> {
    if other_size == size {
        return Ok(());
    }
    let reason = format!("it is {other_size}, and {} is {size}", first.display());
    Err(Error::file(other, reason, remedy))
}
