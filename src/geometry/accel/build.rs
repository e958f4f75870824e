//! The tree: a binary one, [clustered](super::clustering) and put in order by obvhs, then
//! [collapsed](super::collapse) to eight children a node.

use super::NO_SURFACE;
use super::analytic::AnalyticShapes;
use super::clustering::{improve, pair_up};
use super::collapse::BinaryTree;
use super::node::Node;
use super::quads::Quads;
use super::top_boxes::TopBoxes;
use super::treelet;
use crate::geometry::aabb::Aabb;
use crate::geometry::coincident::{self, Coincident};
use crate::geometry::huge_pages::HugePages;
use crate::geometry::triangle::TrianglePack8;
use crate::geometry::{Geometry, Kind};
use crate::math::V3;
use crate::math::simd::Isa;
use rayon::prelude::*;

/// An eight-wide tree over all primitives of a [`Geometry`].
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
    pub(super) isa: Isa,
    pub(super) depth: usize,
}

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
            isa: Isa::detect(),
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

    /// The instruction set that rays are traced with.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Traces with another instruction set from now on. The hits are the same bits.
    pub fn set_isa(&mut self, isa: Isa) {
        self.isa = isa;
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
}

pub(in crate::geometry) fn primitive_bounds(geometry: &Geometry, primitive: u32) -> [V3; 2] {
    match geometry.kind(primitive) {
        Kind::Triangle(i) => {
            let [a, b, c] = geometry.corners(i);
            let low = |f: fn(V3) -> f32| f(a).min(f(b)).min(f(c));
            let high = |f: fn(V3) -> f32| f(a).max(f(b)).max(f(c));
            [
                V3::new(low(|v| v.x), low(|v| v.y), low(|v| v.z)),
                V3::new(high(|v| v.x), high(|v| v.y), high(|v| v.z)),
            ]
        }
        Kind::Sphere(i) => geometry.spheres[i].bounds(),
        Kind::Cylinder(i) => geometry.cylinders[i].bounds(),
    }
}
