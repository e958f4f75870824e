//! Worker threads behind a handle.

use super::{Params, ParamsError, Snapshot};
use crossbeam_channel::Receiver;

/// Passes are traced in the background until the handle is dropped.
#[derive(Debug)]
pub struct Session {
    snapshots: Receiver<Snapshot>,
}

impl Session {
    /// Largest pass limit.
    pub const MAX_PASSES: u64 = 1 << 32;

    /// Starts `threads` workers (0 for one a core). `notify` is called from a worker whenever a
    /// new snapshot waits; it must not block.
    pub fn start(
        params: Params,
        limit: u64,
        threads: usize,
        notify: impl Fn() + Send + Sync + 'static,
    ) -> Result<Session, ParamsError> {
        let _ = (params, limit, threads, notify);
        todo!()
    }

    /// Renders these from now on. Returns the epoch that their snapshots will carry; it is the
    /// present one when nothing changed. Takes effect within one tile.
    pub fn set(&self, params: Params) -> Result<u64, ParamsError> {
        let _ = params;
        todo!()
    }

    /// Starts the present parameters from the first pass again, as a new epoch.
    pub fn restart(&self) -> u64 {
        todo!()
    }

    /// Stops at this many passes (1 to [`Session::MAX_PASSES`]); a higher one goes on.
    pub fn set_limit(&self, passes: u64) {
        let _ = passes;
    }

    /// Stops after the tiles being traced; nothing is lost.
    pub fn pause(&self) {}

    /// Goes on.
    pub fn resume(&self) {}

    /// The newest snapshot not yet taken, if there is one. Never blocks.
    pub fn latest(&self) -> Option<Snapshot> {
        self.snapshots.try_recv().ok()
    }

    /// The channel itself, for waiting. It holds at most one snapshot, the newest.
    pub fn snapshots(&self) -> &Receiver<Snapshot> {
        &self.snapshots
    }
}
