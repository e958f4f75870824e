//! What rays hit: the door to all that finds it.
//!
//! Large quads and a few spheres and cylinders are tried by as many rays at a time as a register
//! holds; all else is in a tree of eight children a node.

mod analytic;
mod build;
mod clustering;
mod clusters;
mod collapse;
mod node;
mod quads;
mod ray_stream;
mod shaft;
mod single_ray;
mod slabs;
mod top_boxes;
mod treelet;

pub use build::Bvh;
pub(super) use build::primitive_bounds;
pub(super) use node::{Child, Node, child};
pub(crate) use quads::{MAX_QUADS, NO_QUAD, QuadHits};
pub use ray_stream::Query;
pub(crate) use shaft::{Rays, Shaft, ShaftLeaves};
pub use single_ray::{Ray, Stack};
