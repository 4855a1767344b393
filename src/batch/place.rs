//! Where paths lead to.

use std::path::{Component, Path, PathBuf};

/// A path with its folders written in one way only; a link keeps its own name.
pub fn with_real_folder(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    folder.canonicalize().map_or_else(|_| path.to_owned(), |folder| folder.join(path.file_name().unwrap_or_default()))
}

/// Where a file is written: links are resolved as far as there is something, the rest is as the file system compares
/// it.
pub(crate) fn place(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let resolved = |ancestor: &Path| Some((ancestor.canonicalize().ok()?, path.strip_prefix(ancestor).ok()?));
    let place = path.ancestors().find_map(resolved).map(|(existing, rest)| append(existing, rest));
    let place = place.unwrap_or_else(|| path.clone());
    if cfg!(any(windows, target_os = "macos")) { place.to_string_lossy().to_lowercase().into() } else { place }
}

/// A path below a folder in which nothing of it exists yet, and so no link.
fn append(folder: PathBuf, below: &Path) -> PathBuf {
    below.components().fold(folder, |mut path, part| {
        match part {
            Component::ParentDir => _ = path.pop(),
            part => path.push(part),
        }
        path
    })
}
