//! What may lie between a point and a small box: rays from the box to the point go through the
//! tree as one.
//!
//! The shaft is the convex hull of box and point (Haines and Wallace, "Shaft culling for efficient
//! ray-traced radiosity", 1991). A box of the tree is passed over if it is off the shaft's own box
//! or beyond one of the planes along an axis that touch the box and go through the point. What is
//! left at the end is a handful of leaves, and each ray is tested against those as it would be in
//! the tree: so what is found is the same.

use super::node::Node;
use super::ray::Ray;
use crate::geometry::aabb::Aabb;
use crate::geometry::ray_origin::UNIT_ROUNDOFF;
use crate::math::V3;
use crate::math::simd::{MAX_WIDTH, Mask, Simd8, SimdWide};

/// Rays begin and end this near the points that the shaft is between: off the surfaces by their
/// errors, some 60 unit roundoffs at most. Hits are within their boxes but for 16 more. In units of the
/// scene, whose coordinates are within 1.
const MARGIN: f32 = 128.0 * UNIT_ROUNDOFF;
/// Roundings of a plane's test.
const PLANE_MARGIN: f32 = 16.0 * UNIT_ROUNDOFF;

/// The hull of a box and a point.
pub(super) struct Shaft {
    low: [f32; 3],
    high: [f32; 3],
    planes: [Plane; 6],
    count: usize,
}

/// A plane along an axis: points with `normal · (x[axes[0]], x[axes[1]]) > most` are off the shaft.
#[derive(Clone, Copy, Default)]
struct Plane {
    axes: [usize; 2],
    normal: [f32; 2],
    most: f32,
    /// Of a box's low and high planes those whose corner is farthest inwards.
    rows: [usize; 2],
}

/// Corners of a rectangle (0 low, 1 high) that the lines from a point touch: the one that is to the
/// left as seen from there, and the one to the right. By where the rectangle lies along both axes:
/// below the point, around it, above it.
const TOUCHED: [[[[usize; 2]; 2]; 3]; 3] = [
    [[[1, 0], [0, 1]], [[1, 0], [1, 1]], [[0, 0], [1, 1]]],
    [[[1, 1], [0, 1]], [[0, 0], [0, 0]], [[0, 0], [1, 0]]],
    [[[1, 1], [0, 0]], [[0, 1], [0, 0]], [[0, 1], [1, 0]]],
];

impl Shaft {
    /// Between the points of a box, given by its lowest and highest corner, and another point, all
    /// of the scene.
    #[inline(always)]
    pub(super) fn new([low, high]: [V3; 2], p: V3) -> Shaft {
        let (p, margin) = ([p.x, p.y, p.z], V3::splat(MARGIN));
        let (low, high) = (low - margin, high + margin);
        let (low, high) = ([low.x, low.y, low.z], [high.x, high.y, high.z]);
        let side =
            |axis: usize| 1 + (low[axis] > p[axis]) as usize - (high[axis] < p[axis]) as usize;
        let mut planes = [Plane::default(); 6];
        let mut count = 0;
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let sides = [side(i), side(j)];
            if sides == [1, 1] {
                continue;
            }
            // Beyond a line is where the cross product with its direction is positive on the left
            // one, negative on the right one.
            for (corner, sign) in TOUCHED[sides[0]][sides[1]].into_iter().zip([1.0, -1.0]) {
                let vi = sign * ([low[i], high[i]][corner[0]] - p[i]);
                let vj = sign * ([low[j], high[j]][corner[1]] - p[j]);
                let slack = MARGIN * (vi.abs() + vj.abs()) + PLANE_MARGIN;
                planes[count] = Plane {
                    axes: [i, j],
                    normal: [-vj, vi],
                    most: vi * p[j] - vj * p[i] + slack,
                    rows: [(-vj < 0.0) as usize, (vi < 0.0) as usize],
                };
                count += 1;
            }
        }
        let from = |axis: usize| low[axis].min(p[axis] - MARGIN);
        let to = |axis: usize| high[axis].max(p[axis] + MARGIN);
        Shaft { low: [0, 1, 2].map(from), high: [0, 1, 2].map(to), planes, count }
    }

    /// The children that are off the shaft's own box along an axis.
    #[inline(always)]
    fn apart<W: Simd8>(&self, node: &Node, axis: usize) -> W::Mask {
        let [low, high] = &node.bounds[axis];
        W::load(low).gt(W::splat(self.high[axis])) | W::load(high).lt(W::splat(self.low[axis]))
    }

    /// The children that may reach into the shaft.
    #[inline(always)]
    pub(super) fn test<W: Simd8>(&self, node: &Node) -> u32 {
        let mut off =
            self.apart::<W>(node, 0) | self.apart::<W>(node, 1) | self.apart::<W>(node, 2);
        for plane in &self.planes[..self.count] {
            let Plane { axes: [i, j], normal, most, rows } = *plane;
            let x = W::load(&node.bounds[i % 3][rows[0] & 1]) * W::splat(normal[0]);
            let y = W::load(&node.bounds[j % 3][rows[1] & 1]).mul_add(W::splat(normal[1]), x);
            off = off | y.gt(W::splat(most));
        }
        (!off).bits()
    }
}

impl Shaft {
    /// Which of these nodes' boxes may reach into it: bit `8 n + i` for the `i`th of the `n`th node.
    #[inline(always)]
    pub(super) fn among<W: Simd8>(&self, nodes: &[Node]) -> u64 {
        let mut found = 0;
        for (at, node) in nodes.iter().enumerate() {
            found |= u64::from(self.test::<W>(node) & 0xff) << (8 * at);
        }
        found
    }
}

/// Leaves of a tree, with their boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct ShaftLeaves(pub(super) Vec<(u32, Aabb)>);

/// A register's worth of rays, taken out one by one.
pub(super) struct Rays([[f32; MAX_WIDTH]; 6]);

impl Rays {
    #[inline(always)]
    pub(super) fn new<P: SimdWide>(o: V3<P>, d: V3<P>) -> Rays {
        let mut parts = [[0.0; MAX_WIDTH]; 6];
        for (x, part) in [o.x, o.y, o.z, d.x, d.y, d.z].into_iter().zip(&mut parts) {
            x.store(part);
        }
        Rays(parts)
    }

    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Ray {
        let part = |i: usize| V3::new(self.0[i][lane], self.0[i + 1][lane], self.0[i + 2][lane]);
        Ray { o: part(0), d: part(3) }
    }
}
