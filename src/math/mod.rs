//! Leaf maths: written once over a [SIMD type](simd::Simd), of which `f32` is the first.
//!
//! Nothing here knows of scenes, BRDFs or threads; everything is a pure function of its arguments.

pub mod frame;
pub(crate) mod gather_table;
#[cfg(test)]
pub(crate) mod numbers;
pub(crate) mod record;
pub mod simd;
pub(crate) mod soa;
pub mod sobol;
pub mod special;
pub mod vec;
pub mod warp;

pub use frame::Frame;
pub use simd::{Mask, Simd};
pub use vec::{Rgb, V3};
