//! Files that appear under their name only when they are complete.
//!
//! Under a final name there is, at any moment, what was there before, or the complete new file: when the bake fails or
//! is interrupted, when the disk is full, and when the process is killed. The bytes are on the disk before the file
//! gets its name. What is being written stands beside it as `.texbake-XXXXXX.tmp`; see `temporary` for who removes
//! what a killed process left.

use super::temporary;
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use tempfile::NamedTempFile;

/// A file beside its target, to take the target's place; dropped before that, it is removed.
pub(crate) struct Replacement {
    temporary: NamedTempFile,
    target: PathBuf,
    failure: Failure,
}

/// The first failure of a write, for [`Replacement::check`].
type Failure = Arc<OnceLock<(ErrorKind, String)>>;

/// The bytes of a [`Replacement`].
///
/// Encoders write where an error goes unheard, or repeat it in words of their own; this remembers it.
pub(crate) struct Output {
    file: File,
    failure: Failure,
}

impl Replacement {
    /// An empty file in the folder of `target`.
    ///
    /// # Errors
    /// If the folder does not take files, or `target` is a folder or read-only: sooner than after a long bake.
    pub fn create(target: &Path) -> Result<Self> {
        // A link keeps its place and its target is replaced.
        let target = fs::canonicalize(target).unwrap_or_else(|_| target.into());
        let existing = match fs::metadata(&target) {
            Ok(existing) => Some(existing),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            // A name that is too long, a circle of links: better told now than after the bake.
            Err(error) => return Err(Error::io(&target)(error)),
        };
        if let Some(existing) = &existing {
            if existing.is_dir() {
                return Err(Error::file(target, "it is a folder", "give the name of a file"));
            }
            if !existing.is_file() {
                return Err(Error::file(target, "it is a device or a pipe", "give the name of a file"));
            }
            if existing.permissions().readonly() {
                return Err(Error::file(target, "it is read-only", "make it writable, or write elsewhere"));
            }
        }
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let temporary = temporary::create(folder).map_err(|source| {
            // The user knows the target, not the temporary file's name.
            Error::io(&target)(io::Error::new(source.kind(), system_reason(&source)))
        })?;
        if let Some(existing) = existing {
            temporary.as_file().set_permissions(existing.permissions()).map_err(Error::io(&target))?;
        }
        Ok(Self { temporary, target, failure: Failure::default() })
    }

    /// The file, to write.
    pub fn output(&self) -> Result<Output> {
        let file = self.temporary.as_file().try_clone().map_err(Error::io(&self.target))?;
        Ok(Output { file, failure: self.failure.clone() })
    }

    /// As [`Replacement::output`], into another file: a device that is always full, say.
    #[cfg(test)]
    pub fn output_into(&self, file: File) -> Output {
        Output { file, failure: self.failure.clone() }
    }

    /// Fails as the first write that failed, whatever became of its error since.
    pub fn check(&self) -> Result<()> {
        let Some((kind, reason)) = self.failure.get() else { return Ok(()) };
        Err(Error::io(&self.target)(io::Error::new(*kind, reason.as_str())))
    }

    /// Brings the bytes to the disk.
    pub fn sync(&self) -> Result<()> {
        self.check()?;
        self.temporary.as_file().sync_all().map_err(Error::io(&self.target))
    }

    /// Brings the bytes to the disk, then gives the file its name.
    pub fn commit(self) -> Result<()> {
        self.sync()?;
        let Self { temporary, target, .. } = self;
        temporary.persist(&target).map_err(|failed| match failed.error.kind() {
            ErrorKind::NotFound => Error::file(&target, "its folder went while it was written", "run it again"),
            _ => Error::io(&target)(failed.error),
        })?;
        Ok(())
    }
}

impl Output {
    fn remember<T>(&self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result {
            // Only the first failure is kept.
            let _ = self.failure.set((error.kind(), error.to_string()));
        }
        result
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.file.write(bytes);
        self.remember(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.file.flush();
        self.remember(result)
    }
}

impl Seek for Output {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        let result = self.file.seek(position);
        self.remember(result)
    }
}

/// The system's words for an error, without the temporary file's name that `tempfile` adds.
fn system_reason(error: &io::Error) -> String {
    let reason = error.to_string();
    reason.split(" at path ").next().unwrap_or(&reason).into()
}
