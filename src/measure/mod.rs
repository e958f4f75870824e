//! Measuring: how far a picture is off, what it cost, and whether the maths is right.
//!
//! [`error`] holds the measures with their formulas, [`flip`] the difference that a person sees,
//! [`difference`] a picture of it, [`interval`] what a spread says about a mean,
//! [`check`] the proofs of a BRDF and its sampler, [`exact`] scenes whose answer is known,
//! [`speed`] error against passes, seconds and rays, [`plot`] the curves of that.

pub mod check;
pub mod difference;
pub mod error;
pub mod exact;
pub mod flip;
pub mod interval;
pub mod plot;
pub mod speed;
