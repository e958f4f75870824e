//! The tree: a binary one, [clustered](super::clustering) and put in order by obvhs, then
//! [collapsed](super::collapse) to eight children a node.

use super::analytic::AnalyticShapes;
use super::bounds::primitive_bounds;
use super::bvh::Bvh;
use super::clustering::{improve, pair_up};
use super::collapse::BinaryTree;
use super::quads::Quads;
use super::top_boxes::TopBoxes;
use super::treelet;
use crate::geometry::Geometry;
use crate::geometry::aabb::Aabb;
use crate::geometry::coincident::{self, Coincident};
use crate::geometry::huge_pages::HugePages;
use crate::geometry::triangle::TrianglePack8;
use crate::math::V3;
use rayon::prelude::*;

impl Bvh {
    /// Builds the tree for the best instruction set of this machine.
    pub fn build(geometry: &Geometry) -> Bvh {
        let quads = Quads::new(geometry);
        let large: Vec<u32> = quads.triangles().collect();
        let analytic = AnalyticShapes::new(geometry);
        let outside: Vec<u32> = large.iter().copied().chain(analytic.primitives()).collect();
        let mut bvh = Bvh {
            nodes: HugePages::default(),
            packs: HugePages::default(),
            root: None,
            aabb: Aabb::default(),
            top_boxes: TopBoxes::default(),
            large: large.chunks(8).map(|ids| TrianglePack8::of(geometry, ids)).collect(),
            quads,
            analytic,
            coincident: Coincident::default(),
            depth: 0,
        };
        let is_outside = |i: &u32| outside.binary_search(i).is_ok();
        let rest: Vec<u32> = (0..geometry.len() as u32).filter(|i| !is_outside(i)).collect();
        if rest.is_empty() {
            return bvh;
        }
        let bounds: Vec<obvhs::aabb::Aabb> =
            rest.par_iter().map(|&i| treelet::aabb(primitive_bounds(geometry, i))).collect();
        let mut binary = pair_up(&bounds);
        drop(bounds);
        improve(&mut binary);
        let whole = binary.nodes[0].aabb();
        let corners = [whole.min, whole.max].map(|v| V3::new(v.x, v.y, v.z));
        bvh.aabb = Aabb::from_corners(corners);
        bvh.top_boxes = TopBoxes::new(&binary);
        binary.primitive_indices.par_iter_mut().for_each(|i| *i = rest[*i as usize]);
        let nodes = BinaryTree::new(geometry, &binary);
        drop(binary);
        nodes.collapse(geometry, &mut bvh);
        bvh
    }

    /// Looks for surfaces that coincide and has rays hit those in front from now on;
    /// `emits` tells of a material's index whether it does.
    pub fn settle_coincident(&mut self, geometry: &mut Geometry, emits: &dyn Fn(u32) -> bool) {
        self.coincident = coincident::find(self, geometry, emits);
        geometry.least_error = self.coincident.least_error(geometry);
    }
}
