//! The way out for snapshots: a channel of one place in which the newest replaces the last.

use super::Snapshot;
use crossbeam_channel::{Receiver, Sender};
use std::sync::{Mutex, PoisonError};

pub(super) struct Mailbox {
    /// Held while a snapshot is exchanged, so that there is one sender at a time.
    sender: Mutex<Sender<Snapshot>>,
    waiting: Receiver<Snapshot>,
    notify: Box<dyn Fn() + Send + Sync>,
}

impl Mailbox {
    pub(super) fn new(
        sender: Sender<Snapshot>,
        waiting: Receiver<Snapshot>,
        notify: Box<dyn Fn() + Send + Sync>,
    ) -> Mailbox {
        Mailbox { sender: Mutex::new(sender), waiting, notify }
    }

    /// Makes a snapshot and leaves it for the receiver, in place of one not yet taken, whose dirty
    /// tiles it takes over. Never blocks on the receiver.
    pub(super) fn send(&self, make: impl FnOnce() -> Snapshot) {
        let sender = self.sender.lock().unwrap_or_else(PoisonError::into_inner);
        let mut snapshot = make();
        if let Ok(missed) = self.waiting.try_recv()
            && missed.epoch == snapshot.epoch
        {
            snapshot.dirty.extend(missed.dirty);
            snapshot.dirty.sort_unstable();
            snapshot.dirty.dedup();
        }
        // There is room: only this thread fills it. A receiver that is gone wants nothing.
        let _ = sender.try_send(snapshot);
        drop(sender);
        (self.notify)();
    }
}
