//! What stands over the picture or above it for a while: the help, messages, the line for a path, the banner
//! of a mistake on purpose. These are no panels: they are there without a document, too, or change nothing.

pub(crate) mod banner;
pub(crate) mod help;
pub(crate) mod notice;
pub(crate) mod open;
