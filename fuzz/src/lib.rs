//! What the targets share: files to read, a bound on memory, and what must hold whatever a file holds.
//!
//! A target hands bytes to one of these functions, which panics if something does not hold.

pub mod explained;
pub mod maps;
pub mod memory;
pub mod models;
pub mod streams;
pub mod text;

use std::path::PathBuf;
use std::sync::LazyLock;
use tempfile::TempDir;

/// The folder of this process; of one that a crash ends, it stays behind.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let fast = std::path::Path::new("/dev/shm");
    let made = if fast.is_dir() { TempDir::new_in(fast) } else { TempDir::new() };
    made.expect("a folder for files")
});

/// The path of a file of this process.
pub fn path(name: &str) -> PathBuf {
    FOLDER.path().join(name)
}

/// A file with these bytes.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = path(name);
    std::fs::write(&path, bytes).expect("a file is written");
    path
}

/// The first byte, which chooses options, and the file behind it.
pub fn choice(data: &[u8]) -> Option<(usize, &[u8])> {
    data.split_first().map(|(first, file)| (usize::from(*first), file))
}
