//! What is in a file.

use super::state::{FileState, Look};
use crate::stream::Monitor;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The content of a file, and what may spare reading it again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Content {
    /// BLAKE3 of its bytes.
    pub hash: String,
    /// The state in which it has them for sure; `None`: it was read too soon after a write to tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<FileState>,
}

impl Content {
    /// Reads the file that was found as `look` says.
    ///
    /// # Errors
    /// What the system says; [`ErrorKind::Other`] if it changed since; [`ErrorKind::Interrupted`] if `monitor` says so.
    pub fn read(path: &Path, look: &Look, monitor: &Monitor) -> io::Result<Self> {
        let hash = hash(path, monitor)?;
        if Look::at(path)?.state != look.state {
            return Err(io::Error::other("it changed while it was read"));
        }
        Ok(Self { hash, state: look.settled() })
    }

    /// What is in the file at `path`; `None` if it cannot be read, or is written to.
    pub fn now(path: &Path) -> Option<Self> {
        let look = Look::at(path).ok()?;
        Self::read(path, &look, &Monitor::default()).ok()
    }

    /// What is in the file at `path` now, and whether that is this content; the file is read only if its state is
    /// another one.
    ///
    /// # Errors
    /// As [`Content::read`].
    pub fn compare(&self, path: &Path, monitor: &Monitor) -> io::Result<(Self, bool)> {
        let look = Look::at(path)?;
        if self.state.is_some() && self.state == look.state {
            return Ok((self.clone(), true));
        }
        let now = Self::read(path, &look, monitor)?;
        let is_same = now.hash == self.hash;
        Ok((now, is_same))
    }
}

/// BLAKE3 of a file's bytes, in hexadecimal digits.
fn hash(path: &Path, monitor: &Monitor) -> io::Result<String> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is no file"));
    }
    let mut file = File::open(path)?;
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 256 << 10];
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Ok(hasher.finalize().to_hex().to_string()),
            Ok(read) => _ = hasher.update(&buffer[..read]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        if monitor.is_cancelled() {
            return Err(ErrorKind::Interrupted.into());
        }
    }
}
