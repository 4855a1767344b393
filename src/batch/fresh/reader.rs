//! Files are read no more often than it takes to know what is in them.

use super::content::{Content, Look, hash};
use crate::stream::Monitor;
use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// What was read of files that nobody was writing to. It is what a file holds for as long as its state stays the same.
/// A tile, which is an input of itself and of those around it, is so read once.
#[derive(Debug, Default)]
pub(super) struct Seen(Mutex<HashMap<PathBuf, Content>>);

/// Reads files until an interrupt.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    pub seen: &'a Seen,
    pub monitor: &'a Monitor,
    /// Bytes of a file that are read in spite of an interrupt.
    pub patience: u64,
}

impl Seen {
    /// The content of the file that was found as `look` says, if it was read in that state.
    pub fn content(&self, path: &Path, look: &Look) -> Option<Content> {
        let contents = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        contents.get(path).filter(|content| content.is_known_by(look)).cloned()
    }

    fn add(&self, path: &Path, content: &Content) {
        if content.state.is_some() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(path.into(), content.clone());
        }
    }
}

impl Reader<'_> {
    /// The content of the file that was found as `look` says; `None` if it changed since. It is read unless it was seen.
    ///
    /// # Errors
    /// What the system says; [`io::ErrorKind::Interrupted`] if the monitor says so.
    pub fn content(&self, path: &Path, look: &Look) -> io::Result<Option<Content>> {
        if let Some(content) = self.seen.content(path, look) {
            return Ok(Some(content));
        }
        if !std::fs::metadata(path)?.is_file() {
            return Err(io::Error::other("it is no file"));
        }
        let content =
            Content { hash: hash(&mut File::open(path)?, self.patience, self.monitor)?, state: look.settled() };
        if Look::at(path)?.state != look.state {
            return Ok(None);
        }
        self.seen.add(path, &content);
        Ok(Some(content))
    }

    /// The content `then` with the state in which the file at `path` has it; `None` if it has another one. The file is
    /// read only if its state is another one.
    ///
    /// # Errors
    /// As [`Reader::content`].
    pub fn still(&self, then: &Content, path: &Path) -> io::Result<Option<Content>> {
        let look = Look::at(path)?;
        if then.is_known_by(&look) {
            return Ok(Some(then.clone()));
        }
        let now = self.content(path, &look)?;
        Ok(now.filter(|now| now.hash == then.hash))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Whether a file that the reader has read in one state is read again.
    fn is_read_again(is_settled: bool) -> bool {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.raw");
        fs::write(&path, "heights").unwrap();
        let (seen, monitor) = (Seen::default(), Monitor::default());
        let reader = Reader { seen: &seen, monitor: &monitor, patience: 0 };
        let look = Look { is_settled, ..Look::at(&path).unwrap() };
        let first = reader.content(&path, &look).unwrap().unwrap();
        assert_eq!(first.hash, blake3::hash(b"heights").to_hex().as_str());
        fs::remove_file(&path).unwrap();
        match reader.content(&path, &look) {
            Ok(second) => {
                assert_eq!(second, Some(first));
                false
            }
            Err(error) => {
                assert_eq!(error.kind(), io::ErrorKind::NotFound);
                true
            }
        }
    }

    #[test]
    fn what_was_left_alone_is_read_once() {
        assert_eq!([true, false].map(is_read_again), [false, true]);
    }

    #[test]
    fn another_state_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.raw");
        let (seen, monitor) = (Seen::default(), Monitor::default());
        let reader = Reader { seen: &seen, monitor: &monitor, patience: 0 };
        for (content, look_is_old) in [("heights", false), ("others", false), ("and others", true)] {
            let before = Look::at(&path).ok();
            fs::write(&path, content).unwrap();
            let look = Look { is_settled: true, ..before.filter(|_| look_is_old).unwrap_or(Look::at(&path).unwrap()) };
            let hash = reader.content(&path, &look).unwrap().map(|content| content.hash);
            // By an old state the file of before is known.
            let expected = if look_is_old { "others" } else { content };
            assert_eq!(hash.as_deref(), Some(blake3::hash(expected.as_bytes()).to_hex().as_str()));
        }
        // A state that nobody has seen, and that is not the file's.
        let look = Look { is_settled: true, ..Look::at(folder.path()).unwrap() };
        assert_eq!(reader.content(&path, &look).unwrap(), None);
    }
}
