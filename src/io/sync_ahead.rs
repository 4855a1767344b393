//! A large file reaches the disk while it is still written, so that at its end there is little left to wait for.

use std::fs::File;
use std::io;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};

/// Bytes after which those that were written so far are brought to the disk.
pub(super) const AHEAD_BYTES: usize = 8 << 20;

/// Counts what is written to one file; from [`AHEAD_BYTES`] on, a thread brings it to the disk.
#[derive(Default)]
pub(super) struct SyncAhead {
    written: usize,
    /// `None` also where the system refuses a thread: then the end of the file waits.
    syncing: Option<Syncing>,
}

struct Syncing {
    wake: SyncSender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl SyncAhead {
    /// Notes that `bytes` more were written to `file`.
    pub fn wrote(&mut self, bytes: usize, file: &File) {
        self.written += bytes;
        if self.written < AHEAD_BYTES {
            return;
        }
        self.written = 0;
        if self.syncing.is_none() {
            self.syncing = file.try_clone().and_then(Syncing::start).ok();
        }
        if let Some(syncing) = &self.syncing {
            // A thread that is behind has a word waiting, which is for these bytes too.
            let _ = syncing.wake.try_send(());
        }
    }

    /// Waits for the thread, and returns what the disk said.
    pub fn finish(&mut self) -> io::Result<()> {
        let Some(Syncing { wake, thread }) = self.syncing.take() else { return Ok(()) };
        drop(wake);
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Syncing {
    fn start(file: File) -> io::Result<Self> {
        let (wake, woken) = sync_channel(1);
        let sync_all = move || woken.iter().try_for_each(|()| file.sync_data());
        Ok(Self { wake, thread: Builder::new().name("texbake sync".into()).spawn(sync_all)? })
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::io::replace::Replacement;
    use std::io::Write;

    /// What is written to `/dev/null` goes nowhere, and the system says so when it is asked to bring it to a disk.
    #[test]
    fn what_the_disk_refuses_meanwhile_is_the_file_s_failure() {
        let folder = tempfile::tempdir().unwrap();
        for (bytes, is_failed) in [(AHEAD_BYTES - 1, false), (AHEAD_BYTES, true)] {
            let replacement = Replacement::create(&folder.path().join("n.png")).unwrap();
            let mut output = replacement.output_into(File::options().write(true).open("/dev/null").unwrap());
            output.write_all(&vec![0; bytes]).unwrap();
            drop(output);
            assert_eq!(replacement.check().is_err(), is_failed, "{bytes} bytes");
        }
    }
}
