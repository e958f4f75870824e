//! Renders: passes, epochs, stops and parts, sums of samples, one pixel taken apart.

mod core;
mod experiment;
mod film;
mod probe;
#[path = "../support/mod.rs"]
mod support;
