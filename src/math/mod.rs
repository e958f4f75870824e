//! Leaf maths: written once over a [lane type](lanes::Lane), of which `f32` is the first.
//!
//! Nothing here knows of scenes, BRDFs or threads; everything is a pure function of its arguments.

pub(crate) mod columns;
pub mod frame;
pub mod lanes;
#[cfg(test)]
pub(crate) mod numbers;
pub mod sequence;
pub mod special;
pub(crate) mod table;
pub mod vec;
pub mod warp;

pub use frame::Frame;
pub use lanes::{Lane, Mask};
pub use vec::{Rgb, V3};
