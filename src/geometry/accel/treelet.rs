//! The lower end of the tree: triangles in packs of eight, as full as can be.
//!
//! A pack costs the same with one triangle as with eight, which the builder of the binary tree does
//! not know. So its subtrees of some dozens of triangles are split anew, by the surface area
//! heuristic with whole packs as the unit.

use crate::math::V3;
use glam::Vec3A;
use obvhs::aabb::Aabb;

/// Most triangles of a subtree that is split anew.
pub(super) const MOST: usize = 128;
/// Triangles of a pack.
pub(super) const PACK: usize = 8;

/// A node of a binary tree whose leaves are what the wide tree's are.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    pub bounds: Aabb,
    pub content: Content,
}

/// What a [`BinaryNode`] holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    /// Two others, the places of both.
    Inner([u32; 2]),
    /// Triangles of one pack: where their numbers begin and end.
    Triangles([u32; 2]),
    /// One sphere or cylinder.
    Analytic(u32),
}

/// A triangle to be split from others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub id: u32,
    pub bounds: Aabb,
}

impl Item {
    /// Twice the centre, as an integer of the same order.
    fn centre(&self, axis: usize) -> u32 {
        let bits = (self.bounds.min[axis] + self.bounds.max[axis]).to_bits();
        if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
    }
}

/// Splits triangles, at least one, into packs: the binary nodes, of which the first is the root, by places
/// counted from its own; the order in which packs name their triangles is that of `items`
/// afterwards.
pub(super) fn split(items: &mut [Item]) -> Vec<BinaryNode> {
    let mut nodes = Vec::with_capacity(items.len() / 2 + 1);
    let mut sweep =
        Sweep { keys: Default::default(), after: vec![0.0; items.len()], sorted: Vec::new() };
    let whole = |items: &[Item]| {
        items.iter().fold(Aabb::empty(), |bounds, item| bounds.union(&item.bounds))
    };
    let empty = Content::Triangles([0, 0]);
    nodes.push(BinaryNode { bounds: whole(items), content: empty });
    let mut open = vec![(0usize, 0usize, items.len())];
    while let Some((at, start, end)) = open.pop() {
        let part = &mut items[start..end];
        if part.len() <= PACK {
            nodes[at].content = Content::Triangles([start as u32, end as u32]);
            continue;
        }
        let middle = start + sweep.halve(part);
        let first = nodes.len() as u32;
        nodes[at].content = Content::Inner([first, first + 1]);
        nodes.push(BinaryNode { bounds: whole(&items[start..middle]), content: empty });
        nodes.push(BinaryNode { bounds: whole(&items[middle..end]), content: empty });
        open.push((first as usize + 1, middle, end));
        open.push((first as usize, start, middle));
    }
    nodes
}

/// Memory for one split.
struct Sweep {
    /// By axis, centres in their order, and in the lower half whose they are.
    keys: [Vec<u64>; 3],
    /// What the items from each on would cost as one part.
    after: Vec<f32>,
    sorted: Vec<Item>,
}

impl Sweep {
    /// Sorts along the axis of the best split and returns where that is.
    fn halve(&mut self, items: &mut [Item]) -> usize {
        let packs = |n: usize| n.div_ceil(PACK) as f32;
        let n = items.len();
        let (mut least, mut best) = (f32::INFINITY, (0, n / 2));
        for (axis, keys) in self.keys.iter_mut().enumerate() {
            keys.clear();
            let key = |(i, item): (usize, &Item)| u64::from(item.centre(axis)) << 32 | i as u64;
            keys.extend(items.iter().enumerate().map(key));
            keys.sort_unstable();
            let bounds_of = |i: usize| &items[keys[i] as u32 as usize].bounds;
            let mut bounds = Aabb::empty();
            for i in (1..n).rev() {
                bounds = bounds.union(bounds_of(i));
                self.after[i] = bounds.half_area() * packs(n - i);
            }
            let mut bounds = Aabb::empty();
            for i in 1..n {
                bounds = bounds.union(bounds_of(i - 1));
                let cost = bounds.half_area() * packs(i) + self.after[i];
                if cost < least {
                    (least, best) = (cost, (axis, i));
                }
            }
        }
        self.sorted.clear();
        self.sorted.extend(self.keys[best.0].iter().map(|&key| items[key as u32 as usize]));
        items.copy_from_slice(&self.sorted);
        best.1
    }
}

/// As the builder wants it.
pub(super) fn aabb([low, high]: [V3; 2]) -> Aabb {
    let corner = |v: V3| Vec3A::new(v.x, v.y, v.z);
    Aabb::new(corner(low), corner(high))
}
