//! Measuring: how far a picture is off, what it cost, and whether the maths is right.
//!
//! [`error`] holds the measures with their formulas, [`interval`] what a spread says about a mean,
//! [`check`] the proofs of a BRDF and its sampler, [`exact`] scenes whose answer is known,
//! [`speed`] error against passes, seconds and rays.

pub mod check;
pub mod error;
pub mod exact;
pub mod interval;
pub mod speed;
