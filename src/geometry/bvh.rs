//! The tree: a binary one, [paired](super::pairing) and put in order by obvhs, then widened to eight
//! children a node.

use super::coincident::{self, Coincident};
use super::extent::Extent;
use super::pages::Pages;
use super::pairing::{improve, pair_up};
use super::parts::Parts;
use super::plates::{NO_PLATE, Plates};
use super::quadrics::Quadrics;
use super::treelets;
use super::triangle::Pack;
use super::widen::Twigs;
use super::{Geometry, Kind};
use crate::math::V3;
use crate::math::lanes::Isa;
use bytemuck::{Pod, Zeroable};
use obvhs::aabb::Aabb;
use rayon::prelude::*;

/// Bounds of eight children by component, and what they are.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Node {
    /// By axis the low planes and the high ones. An absent child has low above high.
    pub bounds: [[[f32; 8]; 2]; 3],
    pub child: [u32; 8],
}

impl Node {
    pub(super) const EMPTY: Node = {
        let (low, high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Node { bounds: [[low, high]; 3], child: [0; 8] }
    };

    /// Nodes of these boxes, eight each, which have no children.
    pub(super) fn of_boxes(boxes: &[[V3; 2]]) -> Vec<Node> {
        let node = |some: &[[V3; 2]]| {
            let mut node = Node::EMPTY;
            for (slot, corners) in some.iter().enumerate() {
                for (side, corner) in corners.iter().enumerate() {
                    for (axis, x) in <[f32; 3]>::from(*corner).into_iter().enumerate() {
                        node.bounds[axis][side][slot] = x;
                    }
                }
            }
            node
        };
        boxes.chunks(8).map(node).collect()
    }
}

/// What a child word names.
pub(super) enum Child {
    Node(usize),
    Pack(usize),
    /// A sphere or cylinder, by primitive index.
    Quadric(u32),
}

pub(super) const PACK: u32 = 1 << 31;
pub(super) const QUADRIC: u32 = 1 << 30;

#[inline(always)]
pub(super) fn child(word: u32) -> Child {
    let index = word & (QUADRIC - 1);
    if word & PACK != 0 {
        Child::Pack(index as usize)
    } else if word & QUADRIC != 0 {
        Child::Quadric(index)
    } else {
        Child::Node(index as usize)
    }
}

/// An eight-wide tree over all primitives of a [`Geometry`].
///
/// Nodes with their packs right behind them in one memory were tried: no faster at 10 million
/// triangles, slower by 2 % at a thousand.
#[derive(Debug)]
pub struct Bvh {
    pub(super) nodes: Pages<Node>,
    pub(super) packs: Pages<Pack>,
    pub(super) root: Option<u32>,
    /// Around all that is in the tree; of no meaning where there is nothing.
    pub(super) extent: Extent,
    /// Around parts of it.
    pub(super) parts: Parts,
    /// What is not in the tree: large faces, with their triangles for the exact test, and a few
    /// spheres and cylinders.
    pub(super) plates: Plates,
    pub(super) large: Vec<Pack>,
    pub(super) quadrics: Quadrics,
    /// What lies in front where surfaces coincide.
    pub(super) coincident: Coincident,
    pub(super) isa: Isa,
    pub(super) depth: usize,
}

impl Bvh {
    /// Builds the tree for the best instruction set of this machine.
    pub fn build(geometry: &Geometry) -> Bvh {
        let plates = Plates::new(geometry);
        let large: Vec<u32> = plates.triangles().collect();
        let quadrics = Quadrics::new(geometry);
        let outside: Vec<u32> = large.iter().copied().chain(quadrics.primitives()).collect();
        let mut bvh = Bvh {
            nodes: Pages::default(),
            packs: Pages::default(),
            root: None,
            extent: Extent::default(),
            parts: Parts::default(),
            large: large.chunks(8).map(|ids| Pack::of(geometry, ids)).collect(),
            plates,
            quadrics,
            coincident: Coincident::default(),
            isa: Isa::detect(),
            depth: 0,
        };
        let is_outside = |i: &u32| outside.binary_search(i).is_ok();
        let rest: Vec<u32> = (0..geometry.len() as u32).filter(|i| !is_outside(i)).collect();
        if rest.is_empty() {
            return bvh;
        }
        let bounds: Vec<Aabb> =
            rest.par_iter().map(|&i| treelets::aabb(primitive_bounds(geometry, i))).collect();
        let mut binary = pair_up(&bounds);
        drop(bounds);
        improve(&mut binary);
        let whole = binary.nodes[0].aabb();
        let corners = [whole.min, whole.max].map(|v| V3::new(v.x, v.y, v.z));
        bvh.extent = Extent::from_corners(corners);
        bvh.parts = Parts::new(&binary);
        binary.primitive_indices.par_iter_mut().for_each(|i| *i = rest[*i as usize]);
        let twigs = Twigs::new(geometry, &binary);
        drop(binary);
        twigs.widen(geometry, &mut bvh);
        bvh
    }

    /// Looks for surfaces that coincide and has rays meet those in front from now on;
    /// `emits` tells of a material's index whether it does.
    pub fn settle_coincident(&mut self, geometry: &mut Geometry, emits: &dyn Fn(u32) -> bool) {
        self.coincident = coincident::find(self, geometry, emits);
        geometry.least_error = self.coincident.least_error(geometry);
    }

    /// Surfaces that coincide.
    pub(crate) fn coincident(&self) -> &Coincident {
        &self.coincident
    }

    /// The number by which rays name the surface that they leave from: of the plate or of the quadric
    /// that a primitive is, if it is not in the tree; else [`NO_PLATE`].
    pub(crate) fn number_of(&self, primitive: u32) -> u32 {
        let plate = self.plates.plate_of(primitive);
        plate.or_else(|| self.quadrics.number_of(primitive)).unwrap_or(NO_PLATE)
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
        self.nodes.len() * size_of::<Node>() + packs * size_of::<Pack>()
    }
}

pub(super) fn primitive_bounds(geometry: &Geometry, primitive: u32) -> [V3; 2] {
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
