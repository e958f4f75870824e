//! The tree: built by obvhs as a binary one, then widened to eight children a node.

use super::plates::Plates;
use super::triangle::Pack;
use super::{Geometry, Kind};
use crate::math::V3;
use crate::math::lanes::Isa;
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use std::time::Duration;

/// Bounds of eight children by component, and what they are.
#[derive(Clone, Debug)]
#[repr(align(32))]
pub(super) struct Node {
    /// Rows: low x, high x, low y, high y, low z, high z. An absent child has low above high.
    pub bounds: [[f32; 8]; 6],
    pub child: [u32; 8],
}

impl Node {
    const EMPTY: Node = {
        let (low, high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Node { bounds: [low, high, low, high, low, high], child: [0; 8] }
    };
}

/// What a child word names.
pub(super) enum Child {
    Node(usize),
    Pack(usize),
    /// A sphere or cylinder, by primitive index.
    Quadric(u32),
}

const PACK: u32 = 1 << 31;
const QUADRIC: u32 = 1 << 30;

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
#[derive(Debug)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    pub(super) packs: Vec<Pack>,
    pub(super) root: Option<u32>,
    /// Corners of the box around all that is in the tree.
    pub(super) bounds: [V3; 2],
    /// What is not in the tree, with its triangles for the exact test.
    pub(super) plates: Plates,
    pub(super) large: Vec<Pack>,
    pub(super) isa: Isa,
    depth: usize,
}

impl Bvh {
    /// Builds the tree for the best instruction set of this machine.
    pub fn build(geometry: &Geometry) -> Bvh {
        let plates = Plates::new(geometry);
        let large: Vec<u32> = plates.triangles().collect();
        let mut bvh = Bvh {
            nodes: Vec::new(),
            packs: Vec::new(),
            root: None,
            bounds: [V3::splat(f32::INFINITY), V3::splat(f32::NEG_INFINITY)],
            large: large.chunks(8).map(|ids| Pack::of(geometry, ids)).collect(),
            plates,
            isa: Isa::detect(),
            depth: 0,
        };
        let is_large = |i: &u32| large.binary_search(i).is_ok();
        let rest: Vec<u32> = (0..geometry.len() as u32).filter(|i| !is_large(i)).collect();
        if rest.is_empty() {
            return bvh;
        }
        let order: Vec<u32> =
            without_order(rest.len() as u32).into_iter().map(|i| rest[i as usize]).collect();
        let bounds: Vec<Aabb> = order
            .iter()
            .map(|&i| {
                let [low, high] = primitive_bounds(geometry, i);
                let corner = |v: V3| Vec3A::new(v.x, v.y, v.z);
                Aabb::new(corner(low), corner(high))
            })
            .collect();
        let settings = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let mut build_time = Duration::ZERO; // wanted by obvhs; we measure from outside
        let mut binary = build_bvh2(&bounds, settings, &mut build_time);
        drop(bounds);
        let whole = binary.nodes[0].aabb();
        bvh.bounds = [whole.min, whole.max].map(|v| V3::new(v.x, v.y, v.z));
        binary.primitive_indices.iter_mut().for_each(|i| *i = order[*i as usize]);
        Widener::new(geometry, &binary).widen(&mut bvh);
        bvh
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

/// All numbers below `n`, without the order in which a file lists its shapes.
///
/// The builder pairs neighbours along a curve through the boxes' centres, and where the centres are
/// one point it takes them as they come. Shells that were listed from the innermost outwards would
/// then be paired one at a time: minutes for a hundred thousand, and a tree as deep as a list.
fn without_order(n: u32) -> Vec<u32> {
    // By steps of nearly the golden section of n that have no divisor in common with it.
    let divisor = |mut a: u32, mut b: u32| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let golden = (f64::from(n) * 0.618_033_988_749_895) as u32;
    let step = (golden.max(1)..).find(|&step| divisor(n, step) == 1).unwrap_or(1);
    (0..u64::from(n)).map(|i| (i * u64::from(step) % u64::from(n)) as u32).collect()
}

fn primitive_bounds(geometry: &Geometry, primitive: u32) -> [V3; 2] {
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

/// How many primitives a binary subtree holds, up to 9, and whether all are triangles.
#[derive(Clone, Copy)]
struct Content {
    count: u8,
    triangles_only: bool,
}

impl Content {
    fn fits_a_pack(self) -> bool {
        self.triangles_only && self.count <= 8
    }
}

struct Widener<'a> {
    geometry: &'a Geometry,
    binary: &'a Bvh2,
    content: Vec<Content>,
}

impl<'a> Widener<'a> {
    fn new(geometry: &'a Geometry, binary: &'a Bvh2) -> Widener<'a> {
        let mut content = vec![Content { count: 0, triangles_only: true }; binary.nodes.len()];
        // Children before parents, without recursion: trees of coincident shapes can be deep.
        let mut order = vec![0usize];
        let mut next = 0;
        while next < order.len() {
            let node = &binary.nodes[order[next]];
            if !node.is_leaf() {
                let first = node.first_index as usize;
                order.extend([first, first + 1]);
            }
            next += 1;
        }
        for &i in order.iter().rev() {
            let node = &binary.nodes[i];
            content[i] = if node.is_leaf() {
                let kind = geometry.kind(binary.primitive_indices[node.first_index as usize]);
                Content { count: 1, triangles_only: matches!(kind, Kind::Triangle(_)) }
            } else {
                let (a, b) =
                    (content[node.first_index as usize], content[node.first_index as usize + 1]);
                Content {
                    count: (a.count + b.count).min(9),
                    triangles_only: a.triangles_only && b.triangles_only,
                }
            };
        }
        Widener { geometry, binary, content }
    }

    fn widen(&self, bvh: &mut Bvh) {
        if self.is_closed(0) {
            bvh.root = Some(self.leaf(0, bvh));
            return;
        }
        bvh.root = Some(0);
        bvh.nodes.push(Node::EMPTY);
        let mut open = vec![(0usize, 0usize, 1usize)];
        while let Some((at, wide, depth)) = open.pop() {
            bvh.depth = bvh.depth.max(depth);
            for (slot, &source) in self.children(at).iter().enumerate() {
                let word = if self.is_closed(source) {
                    self.leaf(source, bvh)
                } else {
                    bvh.nodes.push(Node::EMPTY);
                    open.push((source, bvh.nodes.len() - 1, depth + 1));
                    bvh.nodes.len() as u32 - 1
                };
                let bounds = self.binary.nodes[source].aabb();
                let node = &mut bvh.nodes[wide];
                node.child[slot] = word;
                for axis in 0..3 {
                    node.bounds[2 * axis][slot] = bounds.min[axis];
                    node.bounds[2 * axis + 1][slot] = bounds.max[axis];
                }
            }
        }
    }

    /// Becomes a leaf of the wide tree.
    fn is_closed(&self, at: usize) -> bool {
        self.binary.nodes[at].is_leaf() || self.content[at].fits_a_pack()
    }

    /// Up to eight binary subtrees under `at`: the largest is opened again and again.
    fn children(&self, at: usize) -> Vec<usize> {
        let first = self.binary.nodes[at].first_index as usize;
        let mut children = vec![first, first + 1];
        while children.len() < 8 {
            let area = |&i: &usize| self.binary.nodes[i].aabb().half_area();
            let largest = (0..children.len())
                .filter(|&c| !self.is_closed(children[c]))
                .max_by(|&a, &b| area(&children[a]).total_cmp(&area(&children[b])));
            let Some(largest) = largest else { break };
            let first = self.binary.nodes[children[largest]].first_index as usize;
            children[largest] = first;
            children.push(first + 1);
        }
        children
    }

    fn leaf(&self, at: usize, bvh: &mut Bvh) -> u32 {
        if !self.content[at].triangles_only {
            let node = &self.binary.nodes[at];
            return QUADRIC | self.binary.primitive_indices[node.first_index as usize];
        }
        let mut ids = Vec::with_capacity(8);
        let mut open = vec![at];
        while let Some(i) = open.pop() {
            let node = &self.binary.nodes[i];
            let first = node.first_index as usize;
            if node.is_leaf() {
                ids.push(self.binary.primitive_indices[first]);
            } else {
                open.extend([first, first + 1]);
            }
        }
        bvh.packs.push(Pack::of(self.geometry, &ids));
        PACK | (bvh.packs.len() as u32 - 1)
    }
}
