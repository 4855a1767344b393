//! Files under a name that will not last, and those that killed processes left behind.
//!
//! A temporary file is locked for as long as it is written; the system unlocks it when its process ends, in whatever
//! way. So one that can be locked belongs to nobody, and the next process that writes into its folder removes it. On a
//! file system without locks nothing is removed. Where locks do not reach other machines that write into the same
//! folder (NFS mounted with `local_lock` or `nolock`), let those machines write into folders of their own.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use tempfile::NamedTempFile;

const PREFIX: &str = ".texbake-";
const SUFFIX: &str = ".tmp";

/// Letters and digits between them, chosen by chance.
const RANDOM: usize = 6;

/// An empty file in `folder`, which goes when it is dropped; before the first one, those of dead processes go.
pub(super) fn create(folder: &Path) -> io::Result<NamedTempFile> {
    remove_leftovers_once(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
    #[cfg(unix)]
    {
        // What File::create asks for; the system takes the umask away. Temporary files are private otherwise.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    loop {
        let temporary = builder.tempfile_in(folder)?;
        if is_ours(&temporary) {
            return Ok(temporary);
        }
    }
}

/// Locks a new file. Another process may have taken it for a dead one's before it was locked.
fn is_ours(temporary: &NamedTempFile) -> bool {
    match temporary.as_file().try_lock() {
        Ok(()) => temporary.path().exists(),
        Err(TryLockError::WouldBlock) => false,
        // Without locks, nobody takes it for a dead one's.
        Err(TryLockError::Error(_)) => true,
    }
}

/// Once is enough: this process removes its own files itself.
fn remove_leftovers_once(folder: &Path) {
    static LOOKED_AT: LazyLock<Mutex<HashSet<PathBuf>>> = LazyLock::new(Mutex::default);
    let Ok(folder) = fs::canonicalize(folder) else { return };
    // Held while it is looked at, so that no file of this process is there yet.
    let mut looked_at = LOOKED_AT.lock().unwrap_or_else(PoisonError::into_inner);
    if !looked_at.contains(&folder) {
        remove_leftovers(&folder);
        looked_at.insert(folder);
    }
}

fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_temporary(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            remove_if_dead(&entry.path());
        }
    }
}

fn is_temporary(name: &OsStr) -> bool {
    let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
    random.is_some_and(|random| random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric()))
}

/// Removes a file while its lock is held, so that nobody else can begin to write it. What fails is left as it is.
fn remove_if_dead(path: &Path) {
    // Some file systems lock only what is open for writing.
    let Ok(file) = File::options().read(true).write(true).open(path) else { return };
    if file.try_lock().is_ok() {
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn leftovers_go_and_everything_else_stays() {
        let folder = tempfile::tempdir().unwrap();
        let others =
            [".texbake-abc12.tmp", ".texbake-abc1234.tmp", ".texbake-ab_123.tmp", "texbake-abc123.tmp", "n.png"];
        for name in others.iter().chain(&[".texbake-abc123.tmp", ".texbake-XYZ789.tmp"]) {
            fs::write(folder.path().join(name), b"half").unwrap();
        }
        fs::create_dir(folder.path().join(".texbake-folder.tmp")).unwrap();
        let ours = create(folder.path()).unwrap();
        let mut left: Vec<&str> = others.into_iter().chain([".texbake-folder.tmp"]).collect();
        left.push(ours.path().file_name().unwrap().to_str().unwrap());
        left.sort_unstable();
        assert_eq!(names(folder.path()), left);
    }

    #[test]
    fn a_file_that_is_written_stays() {
        let folder = tempfile::tempdir().unwrap();
        let ours = create(folder.path()).unwrap();
        // The process that the file belongs to is this one, and lives; to the lock, it might be another.
        remove_leftovers(folder.path());
        assert!(ours.path().exists());
        // Without its lock it is a dead process's.
        ours.as_file().unlock().unwrap();
        remove_leftovers(folder.path());
        assert!(!ours.path().exists());
    }

    #[test]
    fn a_file_that_was_taken_for_a_dead_ones_is_not_used() {
        let folder = tempfile::tempdir().unwrap();
        let new = || tempfile::Builder::new().tempfile_in(folder.path()).unwrap();
        let (locked, removed, free) = (new(), new(), new());
        let other = File::options().read(true).write(true).open(locked.path()).unwrap();
        other.lock().unwrap();
        fs::remove_file(removed.path()).unwrap();
        assert_eq!([&locked, &removed, &free].map(is_ours), [false, false, true]);
    }
}
