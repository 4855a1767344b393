//! What tells, without reading them, whether two files are one, and whether a file is as it was.

use serde::{Deserialize, Serialize};
#[cfg(feature = "cli")]
use std::fs::File;
use std::fs::{self, Metadata};
use std::io;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// What is the same for all names of one file, hard links included.
#[cfg(all(feature = "cli", unix))]
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Identity {
    device: u64,
    file: u64,
}

/// What is the same for all names of one file but hard links.
#[cfg(all(feature = "cli", not(unix)))]
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Identity(std::path::PathBuf);

/// Length, times and number of a file: each write changes one of them, once the clock has gone on since the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct FileState {
    bytes: u64,
    /// Of the last write, in nanoseconds since 1970; `None` where the file system has no such times.
    modified: Option<i64>,
    /// Of the last change of any kind, which no program can set back.
    #[serde(skip_serializing_if = "Option::is_none")]
    changed: Option<i64>,
    /// The file's number in its file system. That one's own number is another one each time that it is mounted.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<u64>,
}

#[cfg(feature = "cli")]
impl Identity {
    /// `None` if there is no such file.
    pub fn at(path: &Path) -> Option<Self> {
        #[cfg(unix)]
        return fs::metadata(path).ok().map(|file| Self::of(&file));
        #[cfg(not(unix))]
        return path.canonicalize().ok().map(Self);
    }

    #[cfg(unix)]
    fn of(file: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self { device: file.dev(), file: file.ino() }
    }
}

/// Whether an open file is still the one of this name.
#[cfg(all(feature = "cli", unix))]
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    file.metadata().ok().map(|file| Identity::of(&file)) == Identity::at(path)
}

/// Elsewhere an open file keeps its name.
#[cfg(all(feature = "cli", not(unix)))]
pub(crate) fn is_at(_: &File, _: &Path) -> bool {
    true
}

impl FileState {
    /// That of a file now.
    ///
    /// # Errors
    /// If there is none.
    pub fn at(path: &Path) -> io::Result<Self> {
        fs::metadata(path).map(|file| Self::of(&file))
    }

    fn of(file: &Metadata) -> Self {
        #[cfg(unix)]
        let (changed, number) = {
            use std::os::unix::fs::MetadataExt;
            let seconds = file.ctime().checked_mul(1_000_000_000);
            (seconds.and_then(|seconds| seconds.checked_add(file.ctime_nsec())), Some(file.ino()))
        };
        #[cfg(not(unix))]
        let (changed, number) = (None, None);
        Self { bytes: file.len(), modified: file.modified().ok().and_then(nanoseconds), changed, file: number }
    }

    /// Bytes of the file.
    pub fn length(&self) -> u64 {
        self.bytes
    }

    /// Whether nobody has written to the file since, as far as programs tell the truth: it may have other rights, or
    /// another name beside its own.
    pub fn is_unwritten_since(&self, then: &Self) -> bool {
        Self { changed: None, ..*self } == Self { changed: None, ..*then }
    }

    /// Whether the last of its changes is known, and was before `moment`.
    #[cfg(feature = "cli")]
    pub fn is_from_before(&self, moment: SystemTime) -> bool {
        let last = self.modified.map(|modified| modified.max(self.changed.unwrap_or(modified)));
        last.zip(nanoseconds(moment)).is_some_and(|(last, moment)| last < moment)
    }
}

/// Nanoseconds since 1970; `None` centuries away from it.
fn nanoseconds(time: SystemTime) -> Option<i64> {
    match time.duration_since(UNIX_EPOCH) {
        Ok(since) => since.as_nanos().try_into().ok(),
        Err(before) => i64::try_from(before.duration().as_nanos()).ok().map(|nanoseconds| -nanoseconds),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_later_of_its_times_tells_how_old_a_state_is() {
        let second = |second: i64| second * 1_000_000_000;
        let state = |modified: Option<i64>, changed: Option<i64>| {
            let [modified, changed] = [modified, changed].map(|time| time.map(second));
            FileState { bytes: 1, modified, changed, file: None }
        };
        let moment = UNIX_EPOCH + Duration::from_secs(7);
        let is_before = |modified, changed| state(modified, changed).is_from_before(moment);
        assert!(is_before(Some(5), None) && is_before(Some(5), Some(6)) && is_before(Some(-3), None));
        assert!(!is_before(Some(7), None) && !is_before(Some(5), Some(7)) && !is_before(Some(9), Some(5)));
        assert!(!is_before(None, Some(5)), "no time is no old one");
        assert_eq!(nanoseconds(UNIX_EPOCH - Duration::from_secs(3)), Some(second(-3)));
    }

    #[test]
    fn a_write_is_told_from_another_change() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.raw");
        fs::write(&path, [0; 4]).unwrap();
        let before = FileState::at(&path).unwrap();
        fs::hard_link(&path, folder.path().join("other.raw")).unwrap();
        assert!(FileState::at(&path).unwrap().is_unwritten_since(&before));
        let file = fs::File::options().write(true).open(&path).unwrap();
        file.set_modified(UNIX_EPOCH - Duration::from_secs(3)).unwrap();
        assert!(!FileState::at(&path).unwrap().is_unwritten_since(&before));
        file.set_len(5).unwrap();
        assert_eq!(FileState::at(&path).unwrap().length(), 5);
        // Another file of the same length and time.
        let before = FileState::at(&path).unwrap();
        let copy = folder.path().join("copy.raw");
        fs::write(&copy, [0; 5]).unwrap();
        fs::File::options().write(true).open(&copy).unwrap().set_modified(before_time(&path)).unwrap();
        fs::rename(&copy, &path).unwrap();
        assert_eq!(FileState::at(&path).unwrap().is_unwritten_since(&before), cfg!(not(unix)));
    }

    fn before_time(path: &Path) -> SystemTime {
        fs::metadata(path).unwrap().modified().unwrap()
    }

    #[cfg(all(feature = "cli", unix))]
    #[test]
    fn all_names_of_a_file_are_one() {
        let folder = tempfile::tempdir().unwrap();
        let [path, link, other] = ["h.raw", "link.raw", "other.raw"].map(|name| folder.path().join(name));
        assert_eq!(Identity::at(&path), None);
        let file = File::create(&path).unwrap();
        fs::hard_link(&path, &link).unwrap();
        fs::write(&other, "").unwrap();
        assert!(Identity::at(&path) == Identity::at(&link) && Identity::at(&path) != Identity::at(&other));
        assert!(is_at(&file, &path) && is_at(&file, &link) && !is_at(&file, &other));
        fs::rename(&other, &path).unwrap();
        assert!(!is_at(&file, &path));
    }
}
