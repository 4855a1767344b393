//! What tells, without reading it, that a file is as it was.

use serde::{Deserialize, Serialize};
use std::fs::{self, Metadata};
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Length, times and number of a file: each write changes one of them, once the clock has gone on since the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct FileState {
    bytes: u64,
    /// Of the last write, in nanoseconds since 1970.
    modified: u64,
    /// Of the last change of any kind, which no program can set back.
    #[serde(skip_serializing_if = "Option::is_none")]
    changed: Option<u64>,
    /// The file's number in its file system.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<u64>,
}

/// A file's state at some moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// `None` where the file system has no such times.
    pub state: Option<FileState>,
    /// Whether any later write would give another state.
    pub is_settled: bool,
}

/// The coarsest clock of a file system: FAT's. A file that was written in the same tick as before has the same times.
const TICK: Duration = Duration::from_secs(2);

impl Look {
    /// Looks at a file.
    ///
    /// # Errors
    /// If there is none.
    pub fn at(path: &Path) -> io::Result<Self> {
        let state = FileState::of(&fs::metadata(path)?);
        let tick_ago = nanoseconds(SystemTime::now() - TICK);
        let is_settled = state.zip(tick_ago).is_some_and(|(state, tick_ago)| state.last() < tick_ago);
        Ok(Self { state, is_settled })
    }

    /// The state, if it is enough to know the file again.
    pub fn settled(&self) -> Option<FileState> {
        self.state.filter(|_| self.is_settled)
    }
}

impl FileState {
    fn of(file: &Metadata) -> Option<Self> {
        let modified = nanoseconds(file.modified().ok()?)?;
        #[cfg(unix)]
        let (changed, number) = {
            use std::os::unix::fs::MetadataExt;
            let changed = file.ctime().checked_mul(1_000_000_000)?.checked_add(file.ctime_nsec())?;
            (Some(u64::try_from(changed).ok()?), Some(file.ino()))
        };
        #[cfg(not(unix))]
        let (changed, number) = (None, None);
        Some(Self { bytes: file.len(), modified, changed, file: number })
    }

    /// The later of its times.
    fn last(&self) -> u64 {
        self.modified.max(self.changed.unwrap_or(0))
    }
}

/// Nanoseconds since 1970; `None` before.
fn nanoseconds(time: SystemTime) -> Option<u64> {
    time.duration_since(UNIX_EPOCH).ok()?.as_nanos().try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_that_were_left_alone_for_a_tick_are_settled() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(!Look::at(file.path()).unwrap().is_settled, "just made");
        // Whatever its time of writing says: another program may set that, and not the time of the change.
        file.as_file().set_modified(UNIX_EPOCH + Duration::from_secs(1)).unwrap();
        assert_eq!(Look::at(file.path()).unwrap().is_settled, cfg!(not(unix)));
        file.as_file().set_modified(SystemTime::now() + Duration::from_secs(3600)).unwrap();
        assert!(!Look::at(file.path()).unwrap().is_settled, "from the future");
        let moment = |bytes, modified, changed| FileState { bytes, modified, changed, file: None };
        assert_eq!([moment(1, 5, None).last(), moment(1, 5, Some(7)).last(), moment(1, 9, Some(7)).last()], [5, 7, 9]);
    }
}
