//! From the builder's binary tree to one of eight children a node.

use super::bounds::primitive_bounds;
use super::bvh::Bvh;
use super::node::{ANALYTIC, Node, PACK};
use super::treelet::{self, BinaryNode, Content, Item};
use crate::geometry::huge_pages::HugePages;
use crate::geometry::triangle::TrianglePack8;
use crate::geometry::{Geometry, Kind};
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;

/// What the test of a pack costs, the visit of a node being 1.
const PACK_COST: f32 = 1.0;

/// A binary tree over packs and analytic shapes.
pub(super) struct BinaryTree {
    nodes: Vec<BinaryNode>,
    /// What the packs hold, one after the other.
    triangles: Vec<u32>,
}

impl BinaryTree {
    /// Of a binary tree with one primitive a leaf.
    pub(super) fn new(geometry: &Geometry, binary: &Bvh2) -> BinaryTree {
        let counts = counts(geometry, binary);
        // The upper part is kept; where few enough triangles are left, they are split anew.
        let mut nodes = Vec::new();
        let mut roots = Vec::new();
        let mut open = vec![(0usize, 0usize)];
        let empty = Content::Triangles([0, 0]);
        nodes.push(BinaryNode { bounds: *binary.nodes[0].aabb(), content: empty });
        while let Some((at, place)) = open.pop() {
            let node = &binary.nodes[at];
            let first = node.first_index as usize;
            if usize::from(counts[at]) <= treelet::MOST {
                roots.push((at, place));
            } else if node.is_leaf() {
                nodes[place].content = Content::Analytic(binary.primitive_indices[first]);
            } else {
                let pair = nodes.len();
                nodes[place].content = Content::Inner([pair as u32, pair as u32 + 1]);
                for child in [first, first + 1] {
                    nodes.push(BinaryNode { bounds: *binary.nodes[child].aabb(), content: empty });
                }
                open.push((first + 1, pair + 1));
                open.push((first, pair));
            }
        }
        let parts: Vec<(Vec<BinaryNode>, Vec<u32>)> = roots
            .par_iter()
            .map(|&(at, _)| {
                let mut items = below(geometry, binary, at);
                let nodes = treelet::split(&mut items);
                (nodes, items.iter().map(|item| item.id).collect())
            })
            .collect();
        let mut triangles = Vec::with_capacity(geometry.faces().len());
        for ((_, root), (part, ids)) in roots.iter().zip(parts) {
            // A part's own root takes the place kept for it.
            let (base, start) = (nodes.len() as u32, triangles.len() as u32);
            let mut moved = part.into_iter().map(|node| BinaryNode {
                content: match node.content {
                    Content::Inner(places) => Content::Inner(places.map(|i| i + base - 1)),
                    Content::Triangles(ends) => Content::Triangles(ends.map(|i| i + start)),
                    Content::Analytic(id) => Content::Analytic(id),
                },
                ..node
            });
            if let Some(first) = moved.next() {
                nodes[*root] = first;
            }
            nodes.extend(moved);
            triangles.extend(ids);
        }
        BinaryTree { nodes, triangles }
    }

    /// Fills a tree's nodes and packs.
    pub(super) fn collapse(&self, geometry: &Geometry, bvh: &mut Bvh) {
        let costs = self.costs();
        let (mut nodes, mut packs) = (Vec::new(), Vec::new());
        let mut leaf = |content: Content| match content {
            Content::Analytic(id) => ANALYTIC | id,
            Content::Triangles(ends) => {
                packs.push(ends);
                PACK | (packs.len() as u32 - 1)
            }
            Content::Inner(_) => 0,
        };
        if !matches!(self.nodes[0].content, Content::Inner(_)) {
            bvh.root = Some(leaf(self.nodes[0].content));
        } else {
            bvh.root = Some(0);
            nodes.push(Node::EMPTY);
            let mut open = vec![(0u32, 0usize, 1usize)];
            let mut children = Vec::with_capacity(8);
            while let Some((at, wide, depth)) = open.pop() {
                bvh.depth = bvh.depth.max(depth);
                children.clear();
                if let Content::Inner(pair) = self.nodes[at as usize].content {
                    self.cut(&costs, pair, 8, &mut children);
                }
                for (slot, &source) in children.iter().enumerate() {
                    let BinaryNode { bounds, content } = self.nodes[source as usize];
                    let word = if let Content::Inner(_) = content {
                        nodes.push(Node::EMPTY);
                        open.push((source, nodes.len() - 1, depth + 1));
                        nodes.len() as u32 - 1
                    } else {
                        leaf(content)
                    };
                    let node = &mut nodes[wide];
                    node.child[slot] = word;
                    for axis in 0..3 {
                        node.bounds[axis][0][slot] = bounds.min[axis];
                        node.bounds[axis][1][slot] = bounds.max[axis];
                    }
                }
            }
        }
        bvh.nodes = HugePages::zeroed(nodes.len());
        bvh.nodes.copy_from_slice(&nodes);
        bvh.packs = HugePages::zeroed(packs.len());
        bvh.packs.par_iter_mut().zip(packs).for_each(|(pack, [start, end])| {
            *pack = TrianglePack8::of(geometry, &self.triangles[start as usize..end as usize]);
        });
    }

    /// For each binary node the least that its parts cost a ray that hits the whole, by the surface area
    /// heuristic, if it may be cut into up to 1, 2, ... 8 of them.
    fn costs(&self) -> Vec<[f32; 8]> {
        let mut costs = vec![[0.0; 8]; self.nodes.len()];
        // Places of the children are always higher.
        for (at, node) in self.nodes.iter().enumerate().rev() {
            let area = node.bounds.half_area();
            costs[at] = match node.content {
                Content::Inner([a, b]) => {
                    let (a, b) = (&costs[a as usize], &costs[b as usize]);
                    let mut least = [f32::INFINITY; 8];
                    for parts in 2..=8 {
                        least[parts - 1] = least[parts - 2].min(cheapest(a, b, parts).0);
                    }
                    let whole = area + least[7];
                    least.map(|cost| cost.min(whole))
                }
                _ => [PACK_COST * area; 8],
            };
        }
        costs
    }

    /// Up to `most` subtrees of a pair of siblings, at least the two.
    fn cut(&self, costs: &[[f32; 8]], [a, b]: [u32; 2], most: usize, cut: &mut Vec<u32>) {
        let (_, of_a) = cheapest(&costs[a as usize], &costs[b as usize], most);
        for (node, parts) in [(a, of_a), (b, most - of_a)] {
            let cost = &costs[node as usize];
            match self.nodes[node as usize].content {
                Content::Inner(pair) if parts > 1 && cost[parts - 1] < cost[0] => {
                    self.cut(costs, pair, parts, cut);
                }
                _ => cut.push(node),
            }
        }
    }
}

/// The least cost of `parts` parts of a pair in all, and how many of them are the first one's.
fn cheapest(a: &[f32; 8], b: &[f32; 8], parts: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for of_a in 1..parts {
        let cost = a[of_a - 1] + b[parts - of_a - 1];
        if cost < best.0 {
            best = (cost, of_a);
        }
    }
    best
}

/// How many triangles each binary subtree holds; more than any number where there is anything else.
fn counts(geometry: &Geometry, binary: &Bvh2) -> Vec<u16> {
    let mut counts = vec![0u16; binary.nodes.len()];
    // Children before parents, without recursion: trees of coincident shapes can be deep.
    let mut order = vec![0u32];
    let mut next = 0;
    while next < order.len() {
        let node = &binary.nodes[order[next] as usize];
        if !node.is_leaf() {
            order.extend([node.first_index, node.first_index + 1]);
        }
        next += 1;
    }
    for &i in order.iter().rev() {
        let node = &binary.nodes[i as usize];
        let first = node.first_index as usize;
        counts[i as usize] = if node.is_leaf() {
            match geometry.kind(binary.primitive_indices[first]) {
                Kind::Triangle(_) => 1,
                _ => u16::MAX,
            }
        } else {
            counts[first].saturating_add(counts[first + 1])
        };
    }
    counts
}

/// The triangles of a binary subtree.
fn below(geometry: &Geometry, binary: &Bvh2, at: usize) -> Vec<Item> {
    let mut items = Vec::with_capacity(treelet::MOST);
    let mut open = vec![at];
    while let Some(i) = open.pop() {
        let node = &binary.nodes[i];
        let first = node.first_index as usize;
        if node.is_leaf() {
            let id = binary.primitive_indices[first];
            items.push(Item { id, bounds: treelet::aabb(primitive_bounds(geometry, id)) });
        } else {
            open.extend([first, first + 1]);
        }
    }
    items
}
