//! One ray against the boxes of a node.

use super::node::Node;
use super::ray::Ray;
use crate::geometry::aabb::box_margin;
use crate::math::simd::Simd8;

/// A ray prepared for box tests.
///
/// Boxes are hit as if grown by [a margin](box_margin) that covers every rounding of the box test, the product
/// of origin and inverse included, and of the triangle test's shear, so that no box is missed whose
/// triangle would be hit. So the test may be fused or not: hits do not depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slabs {
    /// Of each axis: 0 if the near planes are the low ones, else 1.
    near: [usize; 3],
    inverse: [f32; 3],
    /// `-origin * inverse`, with the margin, for near and far planes.
    near_offset: [f32; 3],
    far_offset: [f32; 3],
}

impl Slabs {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Slabs {
        let (o, d) = ([ray.o.x, ray.o.y, ray.o.z], [ray.d.x, ray.d.y, ray.d.z]);
        let margin = box_margin(ray.o);
        let fastest = ray.d.abs().max_component();
        let mut slabs = Slabs::default();
        for axis in 0..3 {
            // A component too small to matter over the length of the scene still gives a finite
            // inverse, so that no 0 * infinity arises.
            let least = fastest * 1e-18;
            let along = if d[axis].abs() < least { least.copysign(d[axis]) } else { d[axis] };
            let outwards = margin.copysign(along);
            slabs.near[axis] = (along < 0.0) as usize;
            let inverse = 1.0 / along;
            slabs.inverse[axis] = inverse;
            slabs.near_offset[axis] = -(o[axis] + outwards) * inverse;
            slabs.far_offset[axis] = -(o[axis] - outwards) * inverse;
        }
        slabs
    }

    /// Distances to a row of planes.
    #[inline(always)]
    fn planes<W: Simd8>(&self, row: &[f32; 8], offset: f32, axis: usize) -> W {
        W::load(row).mul_add(W::splat(self.inverse[axis]), W::splat(offset))
    }

    #[inline(always)]
    fn near<W: Simd8>(&self, node: &Node, axis: usize) -> W {
        self.planes(&node.bounds[axis][self.near[axis] & 1], self.near_offset[axis], axis)
    }

    #[inline(always)]
    fn far<W: Simd8>(&self, node: &Node, axis: usize) -> W {
        self.planes(&node.bounds[axis][!self.near[axis] & 1], self.far_offset[axis], axis)
    }

    /// Entry distances, and lanes whose box is hit before `t_max`.
    #[inline(always)]
    pub(super) fn test<W: Simd8>(&self, node: &Node, t_max: f32) -> (W, W::Mask) {
        let enter = self.near::<W>(node, 0).max(self.near(node, 1)).max(self.near(node, 2));
        let leave = self.far::<W>(node, 0).min(self.far(node, 1)).min(self.far(node, 2));
        let enter = enter.max(W::splat(0.0));
        (enter, enter.le(leave.min(W::splat(t_max))))
    }
}
