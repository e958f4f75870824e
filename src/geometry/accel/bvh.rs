//! The tree and what is kept out of it.

use super::NO_SURFACE;
use super::analytic::AnalyticShapes;
use super::node::Node;
use super::quads::Quads;
use super::shaft::Shaft;
use super::top_boxes::TopBoxes;
use crate::geometry::aabb::{Aabb, PacketSlabs};
use crate::geometry::coincident::Coincident;
use crate::geometry::huge_pages::HugePages;
use crate::geometry::triangle::TrianglePack8;
use crate::math::Mask;
use crate::math::simd::{Simd8, SimdWide};

/// An eight-wide tree over all primitives of a [`Geometry`](crate::geometry::Geometry).
///
/// Nodes with their packs right behind them in one memory were tried: no faster at 10 million
/// triangles, slower by 2 % at a thousand.
#[derive(Debug)]
pub struct Bvh {
    pub(in crate::geometry) nodes: HugePages<Node>,
    pub(in crate::geometry) packs: HugePages<TrianglePack8>,
    pub(in crate::geometry) root: Option<u32>,
    /// Around all that is in the tree; of no meaning where there is nothing.
    pub(super) aabb: Aabb,
    /// Around parts of it.
    pub(super) top_boxes: TopBoxes,
    /// What is not in the tree: large faces, with their triangles for the exact test, and a few
    /// spheres and cylinders.
    pub(super) quads: Quads,
    pub(super) large: Vec<TrianglePack8>,
    pub(super) analytic: AnalyticShapes,
    /// What lies in front where surfaces coincide.
    pub(super) coincident: Coincident,
    pub(super) depth: usize,
}

impl Bvh {
    /// The primitives that are not in the tree.
    pub(in crate::geometry) fn outside_tree(&self) -> impl Iterator<Item = u32> {
        self.quads.triangles().chain(self.analytic.primitives())
    }

    /// Surfaces that coincide.
    pub(crate) fn coincident(&self) -> &Coincident {
        &self.coincident
    }

    /// The number by which rays name the surface that they leave or go to, if a quick test needs it to
    /// leave that out; else [`NO_SURFACE`].
    pub(crate) fn surface_id(&self, primitive: u32) -> u32 {
        let quad = self.quads.quad_of(primitive);
        quad.or_else(|| self.analytic.number_of(primitive)).unwrap_or(NO_SURFACE)
    }

    /// Levels of nodes.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Bytes held by nodes and triangle packs.
    pub fn bytes(&self) -> usize {
        let packs = self.packs.len() + self.large.len();
        self.nodes.len() * size_of::<Node>() + packs * size_of::<TrianglePack8>()
    }

    /// Whether there is anything but large quads.
    pub(super) fn has_others(&self) -> bool {
        self.root.is_some() || !self.analytic.is_empty()
    }

    /// Which of the rays may hit what is in the tree before `t_max`.
    #[inline(always)]
    pub(super) fn may_hit_tree<P: SimdWide>(&self, rays: &PacketSlabs<P>, t_max: P) -> P::Mask {
        if self.root.is_none() {
            return P::mask(0);
        }
        let all = rays.may_hit(&self.aabb, t_max);
        if all.any() { all & self.top_boxes.may_hit(rays, t_max) } else { all }
    }

    /// Which parts of the tree may reach into a shaft.
    #[inline(always)]
    pub(super) fn top_boxes_within<W: Simd8>(&self, shaft: &Shaft) -> u64 {
        self.top_boxes.within::<W>(shaft)
    }

    /// Which of the rays may hit these parts of the tree before `t_max`.
    #[inline(always)]
    pub(super) fn may_hit_top_boxes<P: SimdWide>(
        &self,
        which: u64,
        rays: &PacketSlabs<P>,
        t_max: P,
    ) -> P::Mask {
        self.top_boxes.may_hit_some(which, rays, t_max)
    }
}
