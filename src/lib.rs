//! burnish: a progressive path tracer for microfacet BRDFs.
pub mod brdf;
pub mod film;
pub mod geometry;
pub mod math;
pub mod picture;
pub mod progressive;
pub mod scene;
pub mod trace;
