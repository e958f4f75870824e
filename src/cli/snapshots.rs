//! Waiting for the workers.

use super::Failure;
use burnish::progressive::{Session, Snapshot, State};
use std::time::Duration;

/// The next snapshot, if one comes in time.
pub(super) fn next(session: &Session, wait: Duration) -> Result<Option<Snapshot>, Failure> {
    match session.snapshots().recv_timeout(wait) {
        Ok(Snapshot { state: State::Failed(why), .. }) => Err(Failure::new(why)),
        Ok(snapshot) => Ok(Some(snapshot)),
        Err(e) if e.is_timeout() => Ok(None),
        Err(_) => Err(Failure::new("the worker threads ended without a word")),
    }
}
