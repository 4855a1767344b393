//! Which files settings are for.

use crate::error::{Error, Result};
use globset::{GlobBuilder, GlobMatcher};
use std::path::Path;

/// A glob of height maps, as settings and scenes have it: `walls/*`, `**/dem_*`. One without a folder matches names in
/// every folder.
#[derive(Debug, Clone)]
pub struct FileGlob(GlobMatcher);

impl FileGlob {
    /// # Errors
    /// [`Error::Parameter`] if the text is no glob.
    pub fn new(text: &str) -> Result<Self> {
        let glob = GlobBuilder::new(text).literal_separator(true).build();
        let glob = glob.map_err(|error| Error::parameter("glob", text, format!("a glob: {}", error.kind())))?;
        Ok(Self(glob.compile_matcher()))
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        self.0.glob().glob()
    }

    /// Whether it is for the file at this path below the folder that was searched.
    pub fn is_match(&self, path: &Path) -> bool {
        let has_folder = self.text().contains('/');
        self.0.is_match(if has_folder { path } else { path.file_name().map_or(path, Path::new) })
    }
}
