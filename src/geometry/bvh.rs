//! The tree: built by obvhs as a binary one, then widened to eight children a node.

use super::coincident::{self, Coincident};
use super::extent::Extent;
use super::pages::Pages;
use super::plates::Plates;
use super::treelets;
use super::triangle::Pack;
use super::widen::Twigs;
use super::{Geometry, Kind};
use crate::math::V3;
use crate::math::lanes::Isa;
use bytemuck::{Pod, Zeroable};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use rayon::prelude::*;
use std::time::Duration;

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
    /// What is not in the tree, with its triangles for the exact test.
    pub(super) plates: Plates,
    pub(super) large: Vec<Pack>,
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
        let mut bvh = Bvh {
            nodes: Pages::default(),
            packs: Pages::default(),
            root: None,
            extent: Extent::default(),
            large: large.chunks(8).map(|ids| Pack::of(geometry, ids)).collect(),
            plates,
            coincident: Coincident::default(),
            isa: Isa::detect(),
            depth: 0,
        };
        let is_large = |i: &u32| large.binary_search(i).is_ok();
        let rest: Vec<u32> = (0..geometry.len() as u32).filter(|i| !is_large(i)).collect();
        if rest.is_empty() {
            return bvh;
        }
        let boxes = |ids: &[u32]| -> Vec<Aabb> {
            ids.par_iter().map(|&i| treelets::aabb(primitive_bounds(geometry, i))).collect()
        };
        let mut order = rest;
        let mut bounds = boxes(&order);
        if is_crowded(&bounds) {
            order = without_order(order.len() as u32).map(|i| order[i as usize]).collect();
            bounds = boxes(&order);
        }
        let settings = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let mut build_time = Duration::ZERO; // wanted by obvhs; we measure from outside
        let mut binary = build_bvh2(&bounds, settings, &mut build_time);
        drop(bounds);
        let whole = binary.nodes[0].aabb();
        let corners = [whole.min, whole.max].map(|v| V3::new(v.x, v.y, v.z));
        bvh.extent = Extent::from_corners(corners);
        binary.primitive_indices.par_iter_mut().for_each(|i| *i = order[*i as usize]);
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

/// Whether many boxes may have one centre, or nearly.
fn is_crowded(bounds: &[Aabb]) -> bool {
    const PLACES: usize = 1 << 16;
    let mut crowd = vec![0u32; PLACES];
    for bounds in bounds {
        // To a millionth of the scene, into a place by chance.
        let cell = ((bounds.min + bounds.max) * (1 << 19) as f32).as_ivec3();
        let mixed = [cell.x, cell.y, cell.z].iter().fold(0u64, |mixed, &x| {
            (mixed ^ u64::from(x as u32)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
        });
        crowd[(mixed >> 48) as usize] += 1;
    }
    let fair = bounds.len() / PLACES;
    crowd.iter().any(|&n| n as usize > 64 + 4 * fair)
}

/// All numbers below `n`, without the order in which a file lists its shapes.
///
/// The builder pairs neighbours along a curve through the boxes' centres, and where the centres are
/// one point it takes them as they come. Shells that were listed from the innermost outwards would
/// then be paired one at a time: minutes for a hundred thousand, and a tree as deep as a list.
fn without_order(n: u32) -> impl IndexedParallelIterator<Item = u32> {
    // By steps of nearly the golden section of n that have no divisor in common with it.
    let divisor = |mut a: u32, mut b: u32| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = (f64::from(n) * 0.618_033_988_749_895) as u32;
    let step = (golden.max(1)..).find(|&step| divisor(n, step) == 1).unwrap_or(1);
    (0..n).into_par_iter().map(move |i| (u64::from(i) * u64::from(step) % u64::from(n)) as u32)
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
