//! Boxes around parts of the tree: a ray that meets none of them need not enter it.
//!
//! The one box around all that a tree holds is met by nearly every ray of a room as soon as the tree
//! has the outsides of its walls, or a few things that stand apart.

use super::bvh::Node;
use super::extent::{Extent, Passing};
use super::shaft::Shaft;
use crate::math::V3;
use crate::math::lanes::{Mask, Packet, Wide};
use obvhs::bvh2::Bvh2;

/// Most boxes: as many as a word has bits, though fewer than it costs to enter the tree.
const MOST: usize = 32;
/// A box of less than this part of the whole one's surface is not split.
const SMALL: f32 = 1.0 / 1024.0;

/// Boxes that together hold all that the tree does.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    extents: Vec<Extent>,
    nodes: Vec<Node>,
}

impl Parts {
    /// Of a binary tree: again and again the largest box is split into its two halves.
    pub(super) fn new(binary: &Bvh2) -> Parts {
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
        let extents = boxes.iter().map(|&corners| Extent::from_corners(corners)).collect();
        Parts { extents, nodes: Node::of_boxes(&boxes) }
    }

    /// The rays that may meet any of them before `t_max`.
    #[inline(always)]
    pub(super) fn meet<P: Packet>(&self, rays: &Passing<P>, t_max: P) -> P::Mask {
        let mut met = P::mask(0);
        for extent in &self.extents {
            met = met | rays.meet(extent, t_max);
        }
        met
    }

    /// Which of them may reach into a shaft: bit `i` for the `i`th.
    #[inline(always)]
    pub(super) fn within<W: Wide>(&self, shaft: &Shaft) -> u64 {
        shaft.among::<W>(&self.nodes)
    }

    /// The rays that may meet any of these before `t_max`.
    #[inline(always)]
    pub(super) fn meet_some<P: Packet>(
        &self,
        mut which: u64,
        rays: &Passing<P>,
        t_max: P,
    ) -> P::Mask {
        let mut met = P::mask(0);
        while which != 0 && !met.all() {
            met = met | rays.meet(&self.extents[which.trailing_zeros() as usize], t_max);
            which &= which - 1;
        }
        met
    }
}
