//! What is in a file.

use crate::io::file_state::FileState;
use crate::stream::Monitor;
use serde::{Deserialize, Serialize};
use std::io::{self, ErrorKind, Read};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// The content of a file, and what may spare reading it again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Content {
    /// BLAKE3 of its bytes.
    pub hash: String,
    /// The state in which it has them for sure; `None`: it was read too soon after a write to tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<FileState>,
}

/// A file's state at some moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    pub state: FileState,
    /// Whether any later write would give another state.
    pub is_settled: bool,
}

/// The coarsest clock of a file system: FAT's. A file that was written in the same tick as before has the same times.
const TICK: Duration = Duration::from_secs(2);

/// Bytes that are read between two looks for an interrupt.
pub(super) const PIECE: usize = 1 << 20;

impl Content {
    /// Of a file that was just written, and may be another one by now.
    pub fn written(hash: String) -> Self {
        Self { hash, state: None }
    }

    /// Whether the file that was found as `look` says has this content for sure.
    pub fn is_known_by(&self, look: &Look) -> bool {
        self.state == Some(look.state)
    }
}

impl Look {
    /// Looks at a file.
    ///
    /// # Errors
    /// If there is none.
    pub fn at(path: &Path) -> io::Result<Self> {
        let tick_ago = SystemTime::now() - TICK;
        let state = FileState::at(path)?;
        Ok(Self { state, is_settled: state.is_from_before(tick_ago) })
    }

    /// The state, if it is enough to know the file again.
    pub fn settled(&self) -> Option<FileState> {
        self.is_settled.then_some(self.state)
    }
}

/// BLAKE3 of the bytes to come, in hexadecimal digits.
///
/// # Errors
/// What the system says; [`ErrorKind::Interrupted`] if `monitor` says so, but no sooner than `patience` bytes are read.
pub(super) fn hash(bytes: &mut dyn Read, patience: u64, monitor: &Monitor) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    let mut piece = vec![0; PIECE];
    loop {
        match bytes.read(&mut piece) {
            Ok(0) => return Ok(hasher.finalize().to_hex().to_string()),
            Ok(read) => _ = hasher.update(&piece[..read]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        if hasher.count() >= patience && monitor.is_cancelled() {
            return Err(ErrorKind::Interrupted.into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::UNIX_EPOCH;

    #[test]
    fn an_interrupt_is_noticed_where_patience_ends() {
        let (bytes, monitor) = (vec![7; 3 * PIECE], Monitor::default());
        monitor.cancel();
        let hash_of = |patience: usize| hash(&mut bytes.as_slice(), patience as u64, &monitor);
        assert_eq!(hash_of(2 * PIECE).unwrap_err().kind(), ErrorKind::Interrupted);
        assert_eq!(hash_of(4 * PIECE).unwrap(), blake3::hash(&bytes).to_hex().as_str());
    }

    #[test]
    fn only_files_that_were_left_alone_for_a_tick_are_settled() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(!Look::at(file.path()).unwrap().is_settled, "just made");
        // Whatever its time of writing says: another program may set that, and not the time of the change.
        file.as_file().set_modified(UNIX_EPOCH + Duration::from_secs(1)).unwrap();
        assert_eq!(Look::at(file.path()).unwrap().is_settled, cfg!(not(unix)));
        file.as_file().set_modified(SystemTime::now() + Duration::from_secs(3600)).unwrap();
        assert!(!Look::at(file.path()).unwrap().is_settled, "from the future");
    }
}
