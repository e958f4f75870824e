//! Work beside the window: threads that read, write and watch files, so that the window never waits.

pub(crate) mod background;
pub(crate) mod browse;
pub(crate) mod load;
pub(crate) mod reading;
pub(crate) mod reference;
pub(crate) mod resume;
pub(crate) mod save;
pub(crate) mod sheet;
pub(crate) mod watch;
