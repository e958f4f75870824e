//! Measuring: how far a picture is off, what it cost, and whether the maths is right.
//!
//! [`error`] holds the measures with their formulas, [`flip`] the difference that a person sees,
//! [`difference`] a picture of it, [`errata`] what a mistake does to it,
//! [`energy`] what a model gains and loses, [`lobe`] its curves over angle, [`check`] the proofs of a
//! BRDF and its sampler, [`exact`] scenes whose answer is known, [`random`] scenes drawn at random
//! and rendered by both tracers, [`calibrate`] whether the error bar keeps its word, [`speed`] error
//! against passes, seconds and rays, [`plot`] its curves, [`rays`] what rays cost, [`scaling`] how the time of a path grows with what is rendered.
//!
//! What was measured with them is on pages beside these sources: `accuracy.md`, `speed.md` and
//! [`errata`].

pub mod calibrate;
pub mod check;
pub mod difference;
mod draw;
pub mod energy;
pub mod errata;
pub mod error;
pub mod exact;
pub mod flip;
pub mod lobe;
pub mod match_roughness;
pub mod plot;
pub mod profile;
pub mod random;
pub mod rays;
pub mod scaling;
pub mod significance;
mod site;
pub mod speed;
