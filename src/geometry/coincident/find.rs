//! The search for primitives that coincide.
//!
//! The tree is held against itself: two branches go on together while their boxes hit and what
//! they hold could matter, which it does not where all of it is of one material that does not emit.

use super::Coincident;
use super::overlap::coincide;
use crate::geometry::accel::{Bvh, Child, Node, child, primitive_bounds};
use crate::geometry::{Geometry, Kind};
use crate::math::V3;

/// Surfaces within this of each other may coincide: more than [`coincide`] has for any of a scene,
/// whose coordinates are within 1 or little more.
const MARGIN: f32 = 4e-6;
/// Steps a primitive, and in any case, before the search is given up.
const STEPS: usize = 16;
const LEAST: usize = 2_000_000;

/// Finds what coincides; `emits` tells of a material whether it does.
pub(crate) fn find(bvh: &Bvh, geometry: &Geometry, emits: &dyn Fn(u32) -> bool) -> Coincident {
    let steps = STEPS * geometry.len() + LEAST;
    let kinds = vec![Kinds::NONE; bvh.nodes.len()];
    let mut search = Search { bvh, geometry, emits, kinds, steps, found: Vec::new() };
    // What is not in the tree.
    let large: Vec<u32> = bvh.outside_tree().collect();
    for (i, &a) in large.iter().enumerate() {
        for &b in &large[i + 1..] {
            search.compare(a, b);
        }
    }
    if let Some(root) = bvh.root {
        search.learn(root);
        for &triangle in &large {
            search.one_with(triangle, grown(primitive_bounds(geometry, triangle)), root);
        }
        search.branch(root);
    }
    let given_up = search.steps == 0;
    let rank = |primitive: u32| (!emits(geometry.material(primitive)), primitive);
    let pairs = search.found.iter().map(|&[a, b]| if rank(a) < rank(b) { [a, b] } else { [b, a] });
    Coincident { given_up, ..Coincident::from_pairs(pairs.collect(), &rank) }
}

/// The materials below a node, as far as the search wants to know them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kinds {
    None,
    /// All of one that does not emit.
    One(u32),
    Several,
}

impl Kinds {
    const NONE: Kinds = Kinds::None;

    fn and(self, other: Kinds) -> Kinds {
        match (self, other) {
            (Kinds::None, kinds) | (kinds, Kinds::None) => kinds,
            (a, b) if a == b => a,
            _ => Kinds::Several,
        }
    }

    /// Whether pairs of the two are all of one material that does not emit.
    fn are_one(self, other: Kinds) -> bool {
        !matches!(self.and(other), Kinds::Several)
    }
}

struct Search<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    emits: &'a dyn Fn(u32) -> bool,
    /// By node.
    kinds: Vec<Kinds>,
    steps: usize,
    found: Vec<[u32; 2]>,
}

impl Search<'_> {
    fn kind_of(&self, primitive: u32) -> Kinds {
        let material = self.geometry.material(primitive);
        if (self.emits)(material) { Kinds::Several } else { Kinds::One(material) }
    }

    /// The primitives of a leaf.
    fn leaf(&self, word: u32) -> ([u32; 8], usize) {
        match child(word) {
            Child::Triangles(index) => {
                let ids = self.bvh.packs[index].id;
                (ids, ids.iter().take_while(|&&id| id != u32::MAX).count())
            }
            Child::Analytic(primitive) => ([primitive; 8], 1),
            Child::Node(_) => ([u32::MAX; 8], 0),
        }
    }

    fn kinds(&self, word: u32) -> Kinds {
        match child(word) {
            Child::Node(index) => self.kinds[index],
            _ => {
                let (ids, count) = self.leaf(word);
                ids[..count].iter().fold(Kinds::None, |kinds, &id| kinds.and(self.kind_of(id)))
            }
        }
    }

    /// Fills in what is below each node.
    fn learn(&mut self, word: u32) -> Kinds {
        let Child::Node(index) = child(word) else { return self.kinds(word) };
        let node = &self.bvh.nodes[index];
        let below =
            children(node).fold(Kinds::None, |kinds, i| kinds.and(self.learn(node.child[i])));
        self.kinds[index] = below;
        below
    }

    fn step(&mut self) -> bool {
        self.steps = self.steps.saturating_sub(1);
        self.steps > 0
    }

    /// All pairs below one branch.
    fn branch(&mut self, word: u32) {
        if self.kinds(word).are_one(Kinds::None) || !self.step() {
            return;
        }
        let Child::Node(index) = child(word) else {
            let (ids, count) = self.leaf(word);
            for (i, &a) in ids[..count].iter().enumerate() {
                for &b in &ids[i + 1..count] {
                    self.compare(a, b);
                }
            }
            return;
        };
        let node = &self.bvh.nodes[index];
        let all: Vec<usize> = children(node).collect();
        for (at, &i) in all.iter().enumerate() {
            self.branch(node.child[i]);
            for &j in &all[at + 1..] {
                let boxes = [bounds(node, i), bounds(node, j)];
                self.branches([node.child[i], node.child[j]], boxes);
            }
        }
    }

    /// All pairs of one in each of two branches, which have these boxes.
    fn branches(&mut self, [a, b]: [u32; 2], [box_a, box_b]: [[V3; 2]; 2]) {
        let apart = !may_hit(grown(box_a), box_b);
        if apart || self.kinds(a).are_one(self.kinds(b)) || !self.step() {
            return;
        }
        match (child(a), child(b)) {
            (Child::Node(index), _) => {
                let node = &self.bvh.nodes[index];
                for i in children(node) {
                    self.branches([b, node.child[i]], [box_b, bounds(node, i)]);
                }
            }
            (_, Child::Node(_)) => self.branches([b, a], [box_b, box_a]),
            _ => {
                let (ids, count) = self.leaf(a);
                for &id in &ids[..count] {
                    let bounds = grown(primitive_bounds(self.geometry, id));
                    if may_hit(bounds, box_b) {
                        self.one_with(id, bounds, b);
                    }
                }
            }
        }
    }

    /// All pairs of one primitive, which has this box, and what is below a branch.
    fn one_with(&mut self, primitive: u32, reach: [V3; 2], word: u32) {
        if self.kinds(word).are_one(self.kind_of(primitive)) || !self.step() {
            return;
        }
        if let Child::Node(index) = child(word) {
            let node = &self.bvh.nodes[index];
            for i in children(node).filter(|&i| may_hit(reach, bounds(node, i))) {
                self.one_with(primitive, reach, node.child[i]);
            }
            return;
        }
        let (ids, count) = self.leaf(word);
        for &other in &ids[..count] {
            if may_hit(reach, primitive_bounds(self.geometry, other)) {
                self.compare(primitive, other);
            }
        }
    }

    fn compare(&mut self, a: u32, b: u32) {
        let matters = !self.kind_of(a).are_one(self.kind_of(b));
        // Of spheres and triangles none shares an area with the other kind.
        let mixed = matches!(
            (self.geometry.kind(a), self.geometry.kind(b)),
            (Kind::Sphere(_), Kind::Triangle(_)) | (Kind::Triangle(_), Kind::Sphere(_))
        );
        if matters && !mixed && self.step() && coincide(self.geometry, a, b) {
            self.found.push([a, b]);
        }
    }
}

/// The children that are there.
fn children(node: &Node) -> impl Iterator<Item = usize> + use<'_> {
    (0..8).filter(|&i| node.bounds[0][0][i] <= node.bounds[0][1][i])
}

fn bounds(node: &Node, i: usize) -> [V3; 2] {
    let corner = |side: usize| V3::from([0, 1, 2].map(|axis| node.bounds[axis][side][i]));
    [corner(0), corner(1)]
}

fn grown([low, high]: [V3; 2]) -> [V3; 2] {
    let margin = V3::splat(MARGIN);
    [low - margin, high + margin]
}

fn may_hit([a, b]: [V3; 2], [c, d]: [V3; 2]) -> bool {
    a.x <= d.x && a.y <= d.y && a.z <= d.z && c.x <= b.x && c.y <= b.y && c.z <= b.z
}
