//! Files that are read: what may be one, and whether it stayed as it was.

use super::file_state::FileState;
use super::samples::{Layout, Opened, SampleRows, len};
use crate::error::{Error, Result};
use crate::map::HeightsMut;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Opens a file. Pipes are refused, since files are read more than once: their format is found out first, and a map
/// that wraps may be read twice.
///
/// # Errors
/// [`Error::Io`]; [`Error::File`] for a pipe or a device.
pub(super) fn open(path: &Path) -> Result<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        // A pipe that nobody writes is refused too, not waited for. To files it makes no difference.
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(libc::O_NONBLOCK);
    }
    let file = options.open(path).map_err(Error::io(path))?;
    let kind = file.metadata().map_err(Error::io(path))?.file_type();
    if kind.is_dir() {
        return Err(Error::io(path)(ErrorKind::IsADirectory.into()));
    }
    if !kind.is_file() {
        let reason = "it is a pipe or a device, and files are read more than once";
        return Err(Error::file(path, reason, "write what it gives into a file, and name that"));
    }
    Ok(file)
}

/// The bytes of a file, up to `limit` and one more.
///
/// # Errors
/// As [`open`].
pub(super) fn read(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(Error::io(path))?;
    Ok(bytes)
}

/// Watches over a file that must stay as it was found.
pub(super) struct Watch {
    path: PathBuf,
    state: FileState,
}

impl Watch {
    /// Looks at a file before it is opened.
    ///
    /// # Errors
    /// [`Error::Io`] if there is none.
    pub fn at(path: &Path) -> Result<Self> {
        let state = FileState::at(path).map_err(Error::io(path))?;
        Ok(Self { path: path.into(), state })
    }

    /// Its bytes.
    pub fn length(&self) -> u64 {
        self.state.length()
    }

    /// Fails unless the same file is there, and nobody has written to it.
    pub fn check(&self) -> Result<()> {
        if FileState::at(&self.path).is_ok_and(|now| now.is_unwritten_since(&self.state)) {
            return Ok(());
        }
        Err(Error::file(&self.path, "it changed or went while it was read", "run again once it is complete"))
    }

    /// The file once it was opened, whose last row is given only if it stayed as it was.
    pub fn over(self, opened: Result<Opened>) -> Result<Opened> {
        let opened = self.explain(opened)?;
        let samples = Box::new(Watched { watch: self, rows: opened.samples, next_row: 0 });
        Ok(Opened { samples, ..opened })
    }

    /// A result of reading the file: if it changed, that is the reason of any error.
    fn explain<T>(&self, result: Result<T>) -> Result<T> {
        result.or_else(|error| self.check().and(Err(error)))
    }
}

/// Rows of a file that must not change before the last one is read.
struct Watched {
    watch: Watch,
    rows: Box<dyn SampleRows>,
    next_row: usize,
}

impl SampleRows for Watched {
    fn layout(&self) -> Layout {
        self.rows.layout()
    }

    fn read(&mut self, rows: HeightsMut<'_>) -> Result<()> {
        let Layout { size, .. } = self.layout();
        let end = self.next_row + len(&rows) / self.layout().per_row();
        self.watch.explain(self.rows.read(rows))?;
        self.next_row = end;
        if end == size.height() { self.watch.check() } else { Ok(()) }
    }

    fn seek(&mut self, row: usize) -> Result<()> {
        self.watch.explain(self.rows.seek(row))?;
        self.next_row = row;
        Ok(())
    }

    fn last_row_is_near(&self) -> bool {
        self.rows.last_row_is_near()
    }

    fn held_bytes(&self) -> u64 {
        self.rows.held_bytes()
    }
}
