//! A worker's memory for traversal.

use super::bvh::Bvh;
use super::in_flight::Streams;
use super::ray::Query;
use super::shaft::ShaftLeaves;
use crate::geometry::Hit;
use crate::math::V3;
use crate::math::simd::Isa;

/// Memory for traversal, and the instruction set of it. Made once a worker by
/// [`Scene::stack`](crate::scene::Scene::stack) and used for all its rays.
#[derive(Clone, Debug)]
pub struct Stack {
    pub(super) isa: Isa,
    /// Subtrees of a single ray that are still to be visited.
    pub(super) subtrees: Box<[(f32, u32)]>,
    pub(super) streams: Streams,
    pub(super) tree_rays: TreeRays,
    pub(super) pair_rays: PairRays,
}

/// Rays that the tree is asked about, those of a batch together, and its answers.
#[derive(Clone, Debug, Default)]
pub(super) struct TreeRays {
    /// Places in the batch.
    pub(super) at: Vec<u32>,
    pub(super) queries: Vec<Query>,
    /// A hit nearer than this lies before all large quads.
    pub(super) clear: Vec<f32>,
    /// The nearest analytic shape.
    pub(super) analytic: Vec<Option<Hit>>,
    pub(super) hits: Vec<Option<Hit>>,
    pub(super) occluded: Vec<bool>,
}

impl TreeRays {
    pub(super) fn clear(&mut self) {
        self.at.clear();
        self.queries.clear();
        self.clear.clear();
        self.analytic.clear();
    }
    #[inline(always)]
    pub(super) fn push(&mut self, at: usize, query: Query, clear: f32, nearest_shape: Option<Hit>) {
        self.analytic.push(nearest_shape);
        self.at.push(at as u32);
        self.queries.push(query);
        self.clear.push(clear);
    }
    pub(super) fn rays(&self) -> impl Iterator<Item = (usize, &Query)> {
        self.at.iter().map(|&at| at as usize).zip(&self.queries)
    }
}

/// Rays that the tree is to be asked about, and memory that is used again.
#[derive(Clone, Debug, Default)]
pub(super) struct PairRays {
    /// Number of the other point, and place in the group.
    pub(super) pairs: Vec<(u32, u32)>,
    pub(super) queries: Vec<Query>,
    pub(super) occluded: Vec<bool>,
    /// Around the points of the group, a register's worth each.
    pub(super) boxes: Vec<[V3; 2]>,
    /// What lies between those and the other point.
    pub(super) leaves: ShaftLeaves,
}

impl Bvh {
    /// A stack deep enough for this tree. The instruction set is that of rays one at a time or many
    /// together; packets and pairs run under the one of their callers. The hits are the same bits.
    pub fn stack(&self, isa: Isa) -> Stack {
        Stack {
            isa,
            subtrees: vec![(0.0, 0); 7 * self.depth() + 9].into(),
            streams: Streams::new(self.depth()),
            tree_rays: TreeRays::default(),
            pair_rays: PairRays::default(),
        }
    }
}
