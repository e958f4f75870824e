//! Boxes around parts of the tree: a ray that hits none of them need not enter it.
//!
//! The one box around all that a tree holds is hit by nearly every ray of a room as soon as the tree
//! has the outsides of its walls, or a few things that stand apart.

use super::node::Node;
use super::shaft::Shaft;
use crate::geometry::aabb::{Aabb, PacketSlabs};
use crate::math::V3;
use crate::math::simd::{Mask, Simd8, SimdWide};
use obvhs::bvh2::Bvh2;

/// Most boxes, fewer than it costs to enter the tree: 48 and 64 lost 2 % in the built-in scene.
const MOST: usize = 32;
/// A box of less than this part of the whole one's surface is not split.
const SMALL: f32 = 1.0 / 1024.0;

/// Boxes that together hold all that the tree does.
#[derive(Clone, Debug, Default)]
pub(super) struct TopBoxes {
    aabbs: Vec<Aabb>,
    nodes: Vec<Node>,
}

impl TopBoxes {
    /// Of a binary tree: again and again the largest box is split into its two halves.
    pub(super) fn new(binary: &Bvh2) -> TopBoxes {
        let area = |at: usize| binary.nodes[at].aabb().half_area();
        let least = area(0) * SMALL;
        let mut parts = vec![0usize];
        while parts.len() < MOST {
            let open =
                |&(_, &at): &(usize, &usize)| !binary.nodes[at].is_leaf() && area(at) > least;
            let largest = parts.iter().enumerate().filter(open);
            let largest = largest.max_by(|a, b| area(*a.1).total_cmp(&area(*b.1)));
            let Some((place, &at)) = largest else { break };
            let first = binary.nodes[at].first_index as usize;
            parts[place] = first;
            parts.push(first + 1);
        }
        let corners = |&at: &usize| {
            let bounds = binary.nodes[at].aabb();
            [bounds.min, bounds.max].map(|v| V3::new(v.x, v.y, v.z))
        };
        let boxes: Vec<[V3; 2]> = parts.iter().map(corners).collect();
        let aabbs = boxes.iter().map(|&corners| Aabb::from_corners(corners)).collect();
        TopBoxes { aabbs, nodes: Node::of_boxes(&boxes) }
    }

    /// The rays that may hit any of them before `t_max`.
    #[inline(always)]
    pub(super) fn may_hit<P: SimdWide>(&self, rays: &PacketSlabs<P>, t_max: P) -> P::Mask {
        let mut met = P::mask(0);
        for aabb in &self.aabbs {
            met = met | rays.may_hit(aabb, t_max);
        }
        met
    }

    /// Which of them may reach into a shaft: bit `i` for the `i`th.
    #[inline(always)]
    pub(super) fn within<W: Simd8>(&self, shaft: &Shaft) -> u64 {
        shaft.among::<W>(&self.nodes)
    }

    /// The rays that may hit any of these before `t_max`.
    #[inline(always)]
    pub(super) fn may_hit_some<P: SimdWide>(
        &self,
        mut which: u64,
        rays: &PacketSlabs<P>,
        t_max: P,
    ) -> P::Mask {
        let mut met = P::mask(0);
        while which != 0 && !met.all() {
            met = met | rays.may_hit(&self.aabbs[which.trailing_zeros() as usize], t_max);
            which &= which - 1;
        }
        met
    }
}
