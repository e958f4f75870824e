//! What rays hit: the door to all that finds it.
//!
//! Large quads and a few spheres and cylinders are tried by as many rays at a time as a register
//! holds; all else is in a tree of eight children a node.

mod analytic;
mod bounds;
mod build;
mod bvh;
mod clustering;
mod clusters;
mod collapse;
mod in_flight;
mod leaf;
mod node;
mod packet;
mod quads;
mod ray;
mod ray_stream;
mod shaft;
mod shaft_leaves;
mod single_ray;
mod slabs;
mod stack;
mod top_boxes;
mod treelet;
mod visible;

pub(super) use bounds::primitive_bounds;
pub use bvh::Bvh;
pub(super) use node::{Child, Node, child};
pub(crate) use packet::{HitSoa, RaySoa, SegmentSoa};
pub use ray::{Query, Ray};
pub use stack::Stack;
pub(crate) use visible::PointSoa;

use crate::math::simd::{Bits, SimdWide};
use quads::MAX_QUADS;

/// No surface that rays have to name: it is in the tree.
pub(crate) const NO_SURFACE: u32 = quads::NO_QUAD;

/// The surfaces that rays name as the ones they leave, from those that they are on: a solid is one
/// for rays that leave it outwards alone.
#[inline(always)]
pub(crate) fn surface_left<P: SimdWide>(surface: P::Bits, from_outside: P::Mask) -> P::Bits {
    let known = from_outside | P::less_bits(surface, P::Bits::splat(MAX_QUADS as u32));
    P::select_bits(known, surface, P::Bits::splat(NO_SURFACE))
}
