//! Speed against error: error after passes, seconds and rays.
