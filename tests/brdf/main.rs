//! The BRDF: its formulas, samplers and sums, and the functions below them.

mod energy;
mod formulas;
mod samplers;
mod special;
#[path = "../support/mod.rs"]
mod support;
