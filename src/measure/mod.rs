//! Measuring: how far a picture is off, what it cost, and whether the maths is right.
//!
//! [`error`] holds the measures with their formulas, [`check`] the proofs of a BRDF and its sampler,
//! [`exact`] scenes whose answer is known, [`calibrate`] whether the error bar keeps its word,
//! [`speed`] error against passes, seconds and rays.

pub mod calibrate;
pub mod check;
pub mod error;
pub mod exact;
pub mod speed;
