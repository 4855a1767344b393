//! Files that appear under their name only when they are complete.
//!
//! Under a final name there is, at any moment, what was there before, or the complete new file: when the bake fails or
//! is interrupted, when the disk is full, and when the process is killed. The bytes are on the disk before the file
//! gets its name. What is being written stands beside it as `.texbake-XXXXXX.tmp`; see `temporary` for who removes
//! what a killed process left.

use super::sync_ahead::SyncAhead;
use super::temporary;
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use tempfile::NamedTempFile;

/// A file beside its target, to take the target's place; dropped before that, it is removed.
pub(crate) struct Replacement {
    temporary: NamedTempFile,
    /// The file as the user names it.
    target: PathBuf,
    /// Where it is, links aside.
    place: PathBuf,
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
    ahead: SyncAhead,
}

impl Replacement {
    /// An empty file in the folder of `target`.
    ///
    /// # Errors
    /// If the folder does not take files, or `target` is a folder or read-only: sooner than after a long bake.
    pub fn create(target: &Path) -> Result<Self> {
        // A link keeps its place and its target is replaced.
        let place = fs::canonicalize(target).unwrap_or_else(|_| target.into());
        let existing = match fs::metadata(&place) {
            Ok(existing) => Some(existing),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            // A name that is too long, a circle of links: better told now than after the bake.
            Err(error) => return Err(Error::io(target)(error)),
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
        let folder = match place.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let temporary = temporary::create(folder).map_err(|source| {
            // The user knows the target, not the temporary file's name.
            Error::io(target)(io::Error::new(source.kind(), system_reason(&source)))
        })?;
        if let Some(existing) = existing {
            temporary.as_file().set_permissions(existing.permissions()).map_err(Error::io(target))?;
        }
        Ok(Self { temporary, target: target.into(), place, failure: Failure::default() })
    }

    /// The file, to write.
    pub fn output(&self) -> Result<Output> {
        let file = self.temporary.as_file().try_clone().map_err(Error::io(&self.target))?;
        Ok(Output { file, failure: self.failure.clone(), ahead: SyncAhead::default() })
    }

    /// As [`Replacement::output`], into another file: a device that is always full, say.
    #[cfg(test)]
    pub fn output_into(&self, file: File) -> Output {
        Output { file, failure: self.failure.clone(), ahead: SyncAhead::default() }
    }

    /// Fails as the first write that failed, whatever became of its error since.
    pub fn check(&self) -> Result<()> {
        let Some((kind, reason)) = self.failure.get() else { return Ok(()) };
        Err(Error::io(&self.target)(io::Error::new(*kind, reason.as_str())))
    }

    /// Lets somebody read the bytes that were written.
    pub fn show(&self, read: impl FnOnce(&mut dyn Read) -> io::Result<()>) -> Result<()> {
        let mut file = self.temporary.as_file();
        file.rewind().and_then(|()| read(&mut file)).map_err(Error::io(&self.target))
    }

    /// Brings the bytes to the disk.
    pub fn sync(&self) -> Result<()> {
        self.check()?;
        self.temporary.as_file().sync_all().map_err(Error::io(&self.target))
    }

    /// Brings the bytes to the disk, then gives the file its name.
    pub fn commit(self) -> Result<()> {
        self.sync()?;
        let Self { temporary, target, place, .. } = self;
        temporary.persist(place).map_err(|failed| match failed.error.kind() {
            ErrorKind::NotFound => Error::file(&target, "its folder went while it was written", "run it again"),
            _ => Error::io(&target)(failed.error),
        })?;
        Ok(())
    }
}

/// A change to a folder's files.
pub(crate) enum Step {
    /// A complete file gets its name.
    Place(Replacement),
    /// A file that nothing needs any more goes.
    Remove(PathBuf),
}

impl Step {
    /// What it is about.
    #[cfg(test)]
    pub fn path(&self) -> &Path {
        match self {
            Self::Place(file) => &file.target,
            Self::Remove(path) => path,
        }
    }

    pub fn take(self) -> Result<()> {
        match self {
            Self::Place(file) => file.commit(),
            Self::Remove(path) => {
                // What cannot be removed does no harm.
                let _ = fs::remove_file(path);
                Ok(())
            }
        }
    }
}

/// Takes steps in their order; the first one waits until all files are on the disk.
pub(crate) fn take(steps: Vec<Step>) -> Result<()> {
    let files = steps.iter().filter_map(|step| if let Step::Place(file) = step { Some(file) } else { None });
    files.into_iter().try_for_each(Replacement::sync)?;
    steps.into_iter().try_for_each(Step::take)
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

impl Drop for Output {
    /// What the disk refused meanwhile is the file's failure.
    fn drop(&mut self) {
        let result = self.ahead.finish();
        let _ = self.remember(result);
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.file.write(bytes);
        if let Ok(written) = result {
            self.ahead.wrote(written, &self.file);
        }
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

/// What is no file, a device or a pipe, opened to be written as it is.
///
/// # Errors
/// [`Error::File`] for a pipe that nobody reads; it is not waited for. [`Error::Io`].
#[cfg(feature = "cli")]
pub(crate) fn open_stream(path: &Path) -> Result<File> {
    let mut options = File::options();
    options.write(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        let unread = |error: io::Error| match error.raw_os_error() {
            Some(libc::ENXIO) => {
                Error::file(path, "it is a pipe that nobody reads", "start what reads it first, or name a file")
            }
            _ => Error::io(path)(error),
        };
        // Held open, so that there is no waiting below.
        let _reader = File::options().write(true).custom_flags(libc::O_NONBLOCK).open(path).map_err(unread)?;
        options.open(path).map_err(Error::io(path))
    }
    #[cfg(not(unix))]
    options.open(path).map_err(Error::io(path))
}

/// The system's words for an error, without the temporary file's name that `tempfile` adds.
fn system_reason(error: &io::Error) -> String {
    let reason = error.to_string();
    reason.split(" at path ").next().unwrap_or(&reason).into()
}

/// Writes a whole file, which appears under its name when it is complete; its folders are made.
///
/// # Errors
/// [`Error::File`] if there is something else than a file under its name; [`Error::Io`].
#[cfg(any(feature = "cli", feature = "gpu"))]
pub(crate) fn replace_file(path: &Path, content: &[u8]) -> Result<()> {
    std::fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).map_err(Error::io(path))?;
    let file = Replacement::create(path)?;
    file.output()?.write_all(content).map_err(Error::io(path))?;
    file.commit()
}
