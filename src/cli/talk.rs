//! What is said on stderr: how much of it, and in which colours.
//!
//! Colours are for terminals alone and never where NO_COLOR is set; `anstream`, which clap uses for
//! its own messages, knows all the customs. What a progress bar draws is not coloured.

use anstyle::{AnsiColor, Style};
use burnish::plain;
use std::fmt::Display;
use std::io::Write;
use std::sync::atomic::{AtomicU8, Ordering};

/// How much is said. Errors always are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Volume {
    /// Nothing but errors.
    Quiet,
    /// What one ought to know.
    Normal,
    /// And what one may wonder about.
    Verbose,
}

static VOLUME: AtomicU8 = AtomicU8::new(Volume::Normal as u8);

/// How much is said from now on.
pub(super) fn set(volume: Volume) {
    VOLUME.store(volume as u8, Ordering::Relaxed);
}

/// Whether what belongs to this volume is said.
pub(super) fn loud(volume: Volume) -> bool {
    VOLUME.load(Ordering::Relaxed) >= volume as u8
}

const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default().bold();
const CYAN: Style = AnsiColor::Cyan.on_default().bold();

/// Why the program fails.
pub(super) fn error(text: impl Display) {
    coloured(RED, "burnish:", text);
}

/// Something that may make the result other than what was meant.
pub(super) fn warning(text: impl Display) {
    if loud(Volume::Normal) {
        coloured(YELLOW, "warning:", text);
    }
}

/// A fact worth knowing.
pub(super) fn note(text: impl Display) {
    if loud(Volume::Normal) {
        coloured(CYAN, "note:", text);
    }
}

/// A line about what goes on.
pub(super) fn say(text: impl Display) {
    if loud(Volume::Normal) {
        line(plain::lines(&text.to_string()));
    }
}

/// A line for those who asked for more.
pub(super) fn detail(text: impl Display) {
    if loud(Volume::Verbose) {
        line(plain::lines(&text.to_string()));
    }
}

fn coloured(style: Style, word: &str, text: impl Display) {
    let text = plain::lines(&text.to_string());
    line(format_args!("{style}{word}{style:#} {text}"));
}

/// That nobody listens is no reason to end.
fn line(text: impl Display) {
    let _ = writeln!(anstream::stderr().lock(), "{text}");
}
