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

/// Bytes that are read between two looks for an interrupt.
const PIECE: usize = 1 << 20;

impl Content {
    /// Of a file that was just written, and may be another one by now.
    pub fn written(hash: String) -> Self {
        Self { hash, state: None }
    }

    /// Reads the file that was found as `look` says; `None` if it changed since.
    ///
    /// # Errors
    /// What the system says; [`ErrorKind::Interrupted`] if `monitor` says so.
    pub fn read(path: &Path, look: &Look, monitor: &Monitor) -> io::Result<Option<Self>> {
        if !std::fs::metadata(path)?.is_file() {
            return Err(io::Error::other("it is no file"));
        }
        let hash = hash(&mut File::open(path)?, monitor)?;
        let is_same = Look::at(path)?.state == look.state;
        Ok(is_same.then(|| Self { hash, state: look.settled() }))
    }

    /// Whether the file that was found as `look` says has this content for sure.
    pub fn is_known_by(&self, look: &Look) -> bool {
        self.state.is_some() && self.state == look.state
    }

    /// This content with the state in which the file at `path` has it; `None` if it has another one. The file is read
    /// only if its state is another one.
    ///
    /// # Errors
    /// As [`Content::read`].
    pub fn still_in(&self, path: &Path, monitor: &Monitor) -> io::Result<Option<Self>> {
        let look = Look::at(path)?;
        if self.is_known_by(&look) {
            return Ok(Some(self.clone()));
        }
        let now = Self::read(path, &look, monitor)?;
        Ok(now.filter(|now| now.hash == self.hash))
    }
}

/// BLAKE3 of the bytes to come, in hexadecimal digits.
///
/// # Errors
/// As [`Content::read`]; what is shorter than a MiB is read to its end, interrupted or not.
pub(super) fn hash(bytes: &mut dyn Read, monitor: &Monitor) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    let mut piece = vec![0; PIECE];
    loop {
        match bytes.read(&mut piece) {
            Ok(0) => return Ok(hasher.finalize().to_hex().to_string()),
            Ok(read) => _ = hasher.update(&piece[..read]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        if hasher.count() >= PIECE as u64 && monitor.is_cancelled() {
            return Err(ErrorKind::Interrupted.into());
        }
    }
}
