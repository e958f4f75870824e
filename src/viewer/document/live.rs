//! The state of the render and of the window, for panels to read.

use crate::viewer::document::goal::Outlook;
use crate::viewer::document::recent::Recent;
use crate::viewer::picture::canvas::Hover;
use crate::viewer::settings::Switching;
use burnish::progressive::{KeptPictures, Snapshot};
use std::sync::Arc;
use std::time::Duration;

/// One frame's view of all that does not belong to the document. The app writes it before the panels are
/// drawn, and nothing else does: a panel that wants any of it changed returns an action.
#[derive(Clone, Default)]
pub(crate) struct Live {
    /// The newest picture, which may be of parameters before the present ones.
    pub(crate) newest: Option<Arc<Snapshot>>,
    /// Whether it is of the present parameters.
    pub(crate) is_current: bool,
    /// Whether the goal has been reached.
    pub(crate) is_done: bool,
    /// Time from the last change to its first pixels.
    pub(crate) latency: Option<Duration>,
    /// Expected way to the goal.
    pub(crate) outlook: Outlook,
    /// Pictures kept of other parameters.
    pub(crate) kept: KeptPictures,
    /// The pixel under the pointer.
    pub(crate) hover: Option<Hover>,
    /// Width and height of the picture, in pixels of the screen, that the window has room for.
    pub(crate) room: [u32; 2],
    /// The scene being read, by name.
    pub(crate) loading: Option<String>,
    /// Progress of a contact sheet in the making: the number of the picture that is traced, from 1, and of how many.
    pub(crate) sheet: Option<[usize; 2]>,
    /// Worker threads; 0 for one a core.
    pub(crate) threads: usize,
    /// The scenes opened last.
    pub(crate) recent: Recent,
    /// Whether changed files are read again.
    pub(crate) watch: bool,
    /// Settings for pictures that are left for others.
    pub(crate) switching: Switching,
}

impl Live {
    /// The newest picture, if it is of the present parameters.
    pub(crate) fn current(&self) -> Option<&Arc<Snapshot>> {
        self.newest.as_ref().filter(|_| self.is_current)
    }
}
