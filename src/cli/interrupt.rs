//! Ctrl-C: the first one asks for an early end, the second quits.

use super::Failure;
use std::sync::atomic::{AtomicBool, Ordering};

static CAME: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C is noted instead of ending the program.
pub(super) fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if CAME.swap(true, Ordering::Relaxed) {
            // What a shell reports for a program that SIGINT ended.
            std::process::exit(130);
        }
    })
    .map_err(|e| Failure::new(format_args!("cannot listen for Ctrl-C: {e}")))
}

/// Whether Ctrl-C was pressed since.
pub(super) fn came() -> bool {
    CAME.load(Ordering::Relaxed)
}
