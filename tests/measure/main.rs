//! What is measured and proved: error measures and bars, proofs, errata, scenes with known answers or drawn at
//! random.

mod calibration;
mod check;
mod errata;
mod error;
mod exact;
mod random_scenes;
#[path = "../support/mod.rs"]
mod support;
