//! Buffers that go round between two threads: filled on one side, used on the other, given back.

use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};

/// Buffers between two threads: one being filled, one waiting, one being used.
pub(crate) const BUFFERS: usize = 3;

/// The side that uses buffers.
#[derive(Debug)]
pub(super) struct Recycling<T> {
    full: Receiver<T>,
    empty: Sender<T>,
}

/// The side that fills buffers.
pub(crate) struct Filling<T> {
    full: SyncSender<T>,
    empty: Receiver<T>,
    /// Buffers that may still be made.
    unmade: usize,
    abandoned: bool,
}

/// A ring of at most [`BUFFERS`] buffers.
pub(super) fn recycling<T>() -> (Recycling<T>, Filling<T>) {
    let (full_sender, full) = sync_channel(BUFFERS);
    let (empty, empty_receiver) = channel();
    let filling = Filling { full: full_sender, empty: empty_receiver, unmade: BUFFERS, abandoned: false };
    (Recycling { full, empty }, filling)
}

impl<T> Recycling<T> {
    /// The next full buffer; `None` when the other side has ended.
    pub fn receive(&self) -> Option<T> {
        self.full.recv().ok()
    }

    /// Returns a buffer to be filled again.
    pub fn give_back(&self, buffer: T) {
        // The other side may have ended already; then the buffer is not needed.
        let _ = self.empty.send(buffer);
    }
}

impl<T> Filling<T> {
    /// A buffer to fill: `Some(None)` if one is to be made, `None` if nobody wants one any more.
    pub fn take(&mut self) -> Option<Option<T>> {
        if self.abandoned {
            return None;
        }
        if self.unmade > 0 {
            self.unmade -= 1;
            return Some(None);
        }
        self.empty.recv().ok().map(Some)
    }

    /// Hands a full buffer over.
    pub fn send(&mut self, buffer: T) {
        self.abandoned = self.full.send(buffer).is_err();
    }
}
