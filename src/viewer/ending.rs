//! The report of a window that was closed.

use std::sync::{Arc, Mutex};

/// Report of a window to its caller when it is closed.
#[derive(Default)]
pub(super) struct Ending {
    /// Why there is no screenshot.
    pub(super) failure: Option<String>,
    /// Times of its frames, in words, if they were measured.
    pub(super) work: Option<String>,
}

/// An ending that the window, its smoke test and its caller share.
pub(super) type SharedEnding = Arc<Mutex<Ending>>;
