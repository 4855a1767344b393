//! What a job wrote.

use super::content::{Content, hash};
use crate::io::Witness;
use crate::stream::Monitor;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The contents of a job's outputs, read before these had their names: under its name another program may have put
/// another file by now.
#[derive(Debug, Clone, Default)]
pub(in crate::batch) struct Written(Arc<Mutex<HashMap<PathBuf, Content>>>);

impl Written {
    /// Reads what will be called `output`; a later try takes the place of one that failed.
    pub fn witness(&self, output: &Path) -> Witness {
        let (Self(contents), output) = (self.clone(), output.to_owned());
        Box::new(move |bytes| {
            // As much as is on its way to the disk at that moment, and that is not interrupted either.
            let content = Content::written(hash(bytes, 0, &Monitor::default())?);
            contents.lock().unwrap_or_else(PoisonError::into_inner).insert(output, content);
            Ok(())
        })
    }

    /// What was written under the name `output`, if anything was.
    pub(super) fn content(&self, output: &Path) -> Option<Content> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(output).cloned()
    }
}
