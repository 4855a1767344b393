//! A run that waits at its first word, so that a test can do something behind its back.

use crate::cli::support::Run;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::process::{Child, Command, Output, Stdio};

/// A program whose stderr takes nothing more: it stops at the first line that it prints there.
pub struct Paused {
    pub child: Child,
    /// The other end of its stderr, full of bytes that are not the program's.
    stderr: UnixStream,
    filled: usize,
}

impl Paused {
    pub fn spawn(mut command: Command) -> Self {
        let (stderr, mut end) = UnixStream::pair().unwrap();
        end.set_nonblocking(true).unwrap();
        let mut filled = 0;
        // Down to single bytes, since a socket that refuses many may take a few.
        for size in [4096, 1] {
            loop {
                match end.write(&vec![b'.'; size]) {
                    Ok(written) => filled += written,
                    Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                    Err(error) => panic!("{error}"),
                }
            }
        }
        end.set_nonblocking(false).unwrap();
        let child = command.stdout(Stdio::piped()).stderr(OwnedFd::from(end)).spawn().unwrap();
        Self { child, stderr, filled }
    }

    /// Lets it go on, and waits for its end.
    pub fn go_on(mut self) -> Run {
        let mut stderr = Vec::new();
        self.stderr.read_to_end(&mut stderr).unwrap();
        let mut stdout = Vec::new();
        self.child.stdout.take().unwrap().read_to_end(&mut stdout).unwrap();
        Output { status: self.child.wait().unwrap(), stdout, stderr: stderr.split_off(self.filled) }.into()
    }
}
