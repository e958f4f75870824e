//! Nodes of the eight-wide tree, and what their children are.

use crate::math::V3;
use bytemuck::{Pod, Zeroable};

/// Bounds of eight children by component, and what they are.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(in crate::geometry) struct Node {
    /// By axis the low planes and the high ones. An absent child has low above high.
    pub(in crate::geometry) bounds: [[[f32; 8]; 2]; 3],
    pub(in crate::geometry) child: [u32; 8],
}

impl Node {
    pub(in crate::geometry) const EMPTY: Node = {
        let (low, high) = ([f32::INFINITY; 8], [f32::NEG_INFINITY; 8]);
        Node { bounds: [[low, high]; 3], child: [0; 8] }
    };

    /// Nodes of these boxes, eight each, which have no children.
    pub(in crate::geometry) fn of_boxes(boxes: &[[V3; 2]]) -> Vec<Node> {
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
pub(in crate::geometry) enum Child {
    Node(usize),
    Triangles(usize),
    /// A sphere or cylinder, by primitive index.
    Analytic(u32),
}

/// The two highest bits of a child word: none of them is set for a node, one for a pack of triangles or
/// an analytic shape, and both where there is nothing to visit, of which [`child`] knows nothing.
pub(in crate::geometry) const PACK: u32 = 1 << 31;
pub(in crate::geometry) const ANALYTIC: u32 = 1 << 30;
pub(in crate::geometry) const END: u32 = PACK | ANALYTIC;

#[inline(always)]
pub(in crate::geometry) fn child(word: u32) -> Child {
    let index = word & (ANALYTIC - 1);
    if word & PACK != 0 {
        Child::Triangles(index as usize)
    } else if word & ANALYTIC != 0 {
        Child::Analytic(index)
    } else {
        Child::Node(index as usize)
    }
}
