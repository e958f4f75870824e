//! One ray through the tree: the nearest hit, or whether there is any.

use super::bvh::{Bvh, Child, Node, child};
use super::extent::Passing;
use super::offset::ROUNDING;
use super::plates::Plates;
use super::quadrics::Quadrics;
use super::shaft::Shaft;
use super::stream::Streams;
use super::triangle::{self, Pack, Sheared};
use super::{Geometry, Hit, Kind};
use crate::math::lanes::{Kernel, Packet, Wide, dispatch};
use crate::math::{Mask, V3};

/// A ray `o + t d`; `d` need not be unit.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub o: V3,
    /// Direction.
    pub d: V3,
}

impl Ray {
    /// The point at distance `t`.
    #[inline(always)]
    pub fn at(&self, t: f32) -> V3 {
        self.o + self.d * t
    }
}

/// Subtrees still to be visited. Made once a worker by [`Bvh::stack`] and used for all its rays.
#[derive(Clone, Debug)]
pub struct Stack(pub(super) Box<[(f32, u32)]>, pub(super) Streams);

impl Bvh {
    /// A stack deep enough for this tree.
    pub fn stack(&self) -> Stack {
        Stack(vec![(0.0, 0); 7 * self.depth() + 9].into(), Streams::new(self.depth()))
    }

    /// The nearest hit at `0 < t <= t_max`; of equally near ones the lowest primitive. A ray with
    /// a NaN, or without a direction, hits nothing.
    pub fn closest(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        t_max: f32,
        stack: &mut Stack,
    ) -> Option<Hit> {
        struct Closest<'a>(&'a Bvh, &'a Geometry, &'a Ray, f32, &'a mut Stack);
        impl Kernel for Closest<'_> {
            type Output = Option<Hit>;
            #[inline(always)]
            fn run<W: Wide, P: Packet>(self) -> Option<Hit> {
                self.0.closest_with::<W>(self.1, self.2, self.3, self.4)
            }
        }
        dispatch(self.isa, Closest(self, geometry, ray, t_max, stack))
    }

    /// Whether anything is hit at `0 < t <= t_max`.
    pub fn occluded(&self, geometry: &Geometry, ray: &Ray, t_max: f32, stack: &mut Stack) -> bool {
        struct Occluded<'a>(&'a Bvh, &'a Geometry, &'a Ray, f32, &'a mut Stack);
        impl Kernel for Occluded<'_> {
            type Output = bool;
            #[inline(always)]
            fn run<W: Wide, P: Packet>(self) -> bool {
                self.0.occluded_with::<W>(self.1, self.2, self.3, self.4)
            }
        }
        dispatch(self.isa, Occluded(self, geometry, ray, t_max, stack))
    }
}

/// A ray prepared for box tests.
///
/// Boxes are met as if grown by a margin that covers every rounding of the box test, the product
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
        // Coordinates of the scene are within [-1, 1].
        let margin = 16.0 * ROUNDING * (ray.o.abs().max_component() + 1.0);
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
    fn planes<W: Wide>(&self, row: &[f32; 8], offset: f32, axis: usize) -> W {
        W::load(row).mul_add(W::splat(self.inverse[axis]), W::splat(offset))
    }

    #[inline(always)]
    fn near<W: Wide>(&self, node: &Node, axis: usize) -> W {
        self.planes(&node.bounds[axis][self.near[axis] & 1], self.near_offset[axis], axis)
    }

    #[inline(always)]
    fn far<W: Wide>(&self, node: &Node, axis: usize) -> W {
        self.planes(&node.bounds[axis][!self.near[axis] & 1], self.far_offset[axis], axis)
    }

    /// Entry distances, and lanes whose box is met before `t_max`.
    #[inline(always)]
    pub(super) fn test<W: Wide>(&self, node: &Node, t_max: f32) -> (W, W::Mask) {
        let enter = self.near::<W>(node, 0).max(self.near(node, 1)).max(self.near(node, 2));
        let leave = self.far::<W>(node, 0).min(self.far(node, 1)).min(self.far(node, 2));
        let enter = enter.max(W::splat(0.0));
        (enter, enter.le(leave.min(W::splat(t_max))))
    }
}

pub(super) fn is_traceable(ray: &Ray) -> bool {
    let fastest = ray.d.abs().max_component();
    let finite = |v: V3| v.x.is_finite() && v.y.is_finite() && v.z.is_finite();
    finite(ray.o) && finite(ray.d) && fastest > 1e-18 && fastest < 1e18
}

impl Bvh {
    /// [`Bvh::closest`] for callers that run under an instruction set already.
    #[inline(always)]
    pub(crate) fn closest_with<W: Wide>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        t_max: f32,
        stack: &mut Stack,
    ) -> Option<Hit> {
        if !is_traceable(ray) {
            return None;
        }
        let sheared = Sheared::new(ray.o, ray.d);
        let mut best = Hit { t: t_max, primitive: u32::MAX, b: [0.0; 2] };
        self.take_outside::<W>(geometry, ray, &sheared, &mut best);
        let hit = self.closest_in_tree::<W>(geometry, ray, &sheared, best, stack);
        self.in_front(geometry, ray, hit)
    }

    /// Takes the nearer of the best hit so far and what is not in the tree.
    #[inline(always)]
    pub(super) fn take_outside<W: Wide>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sheared: &Sheared,
        best: &mut Hit,
    ) {
        for pack in &self.large {
            take_nearest::<W>(best, pack, sheared);
        }
        for primitive in self.quadrics.primitives() {
            if let Some(t) = quadric(geometry, primitive, ray, best.t) {
                take_nearer(best, t, primitive, [0.0; 2]);
            }
        }
    }

    /// The hit, or what coincides with it and lies in front.
    #[inline(always)]
    pub(crate) fn in_front(&self, geometry: &Geometry, ray: &Ray, hit: Option<Hit>) -> Option<Hit> {
        match hit {
            Some(hit) if self.coincident.may_be_behind(hit.primitive) => {
                Some(self.coincident.foremost(geometry, ray, hit))
            }
            hit => hit,
        }
    }

    /// The nearer of the best hit so far and what the tree holds.
    #[inline(always)]
    pub(super) fn closest_in_tree<W: Wide>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sheared: &Sheared,
        mut best: Hit,
        stack: &mut Stack,
    ) -> Option<Hit> {
        let Some(mut word) = self.root else {
            return (best.primitive != u32::MAX).then_some(best);
        };
        let (nodes, packs) = (&self.nodes[..], &self.packs[..]);
        let slabs = Slabs::new(ray);
        let stack = &mut stack.0;
        let mut top = 0;
        loop {
            match child(word) {
                Child::Node(index) => {
                    let node = &nodes[index];
                    let (enter, mask) = slabs.test::<W>(node, best.t);
                    let mut mask = mask.bits();
                    if mask != 0 {
                        let first = mask.trailing_zeros() as usize;
                        mask &= mask - 1;
                        if mask == 0 {
                            word = node.child[first];
                            continue;
                        }
                        let enter = enter.store();
                        // The nearest goes on, the others wait, the farthest lowest.
                        let base = top;
                        let mut nearest = (enter[first], node.child[first]);
                        while mask != 0 {
                            let i = mask.trailing_zeros() as usize;
                            mask &= mask - 1;
                            let mut entry = (enter[i], node.child[i]);
                            if entry.0 < nearest.0 {
                                std::mem::swap(&mut entry, &mut nearest);
                            }
                            let mut place = top;
                            while place > base && stack[place - 1].0 < entry.0 {
                                stack[place] = stack[place - 1];
                                place -= 1;
                            }
                            stack[place] = entry;
                            top += 1;
                        }
                        word = nearest.1;
                        continue;
                    }
                }
                Child::Pack(index) => {
                    let pack = &packs[index];
                    take_nearest::<W>(&mut best, pack, sheared);
                }
                Child::Quadric(primitive) => {
                    if let Some(t) = quadric(geometry, primitive, ray, best.t) {
                        take_nearer(&mut best, t, primitive, [0.0; 2]);
                    }
                }
            }
            // What was put aside may lie beyond the best hit by now.
            loop {
                if top == 0 {
                    return (best.primitive != u32::MAX).then_some(best);
                }
                top -= 1;
                if stack[top].0 <= best.t {
                    word = stack[top].1;
                    break;
                }
            }
        }
    }
}

#[inline(always)]
pub(super) fn take_nearest<W: Wide>(best: &mut Hit, pack: &Pack, ray: &Sheared) {
    let Some(hits) = triangle::intersect::<W>(pack, ray, best.t) else { return };
    let (mut mask, t, b) = (hits.mask, hits.t.store(), hits.b.map(W::store));
    while mask != 0 {
        let i = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        take_nearer(best, t[i], pack.id[i], [b[0][i], b[1][i]]);
    }
}

#[inline(always)]
pub(super) fn take_nearer(best: &mut Hit, t: f32, primitive: u32, b: [f32; 2]) {
    if t < best.t || (t == best.t && primitive < best.primitive) {
        *best = Hit { t, primitive, b };
    }
}

#[inline(always)]
pub(super) fn quadric(geometry: &Geometry, primitive: u32, ray: &Ray, t_max: f32) -> Option<f32> {
    match geometry.kind(primitive) {
        Kind::Sphere(i) => geometry.spheres[i].intersect(ray.o, ray.d, t_max),
        Kind::Cylinder(i) => geometry.cylinders[i].intersect(ray.o, ray.d, t_max),
        Kind::Triangle(_) => None,
    }
}

impl Bvh {
    /// [`Bvh::occluded`] for callers that run under an instruction set already.
    #[inline(always)]
    pub(crate) fn occluded_with<W: Wide>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        t_max: f32,
        stack: &mut Stack,
    ) -> bool {
        if !is_traceable(ray) {
            return false;
        }
        let sheared = Sheared::new(ray.o, ray.d);
        for pack in &self.large {
            if triangle::intersect::<W>(pack, &sheared, t_max).is_some() {
                return true;
            }
        }
        for primitive in self.quadrics.primitives() {
            if quadric(geometry, primitive, ray, t_max).is_some() {
                return true;
            }
        }
        self.occluded_in_tree::<W>(geometry, ray, &sheared, t_max, stack)
    }

    /// Whether what the tree holds is hit at `0 < t <= t_max`.
    #[inline(always)]
    pub(super) fn occluded_in_tree<W: Wide>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sheared: &Sheared,
        t_max: f32,
        stack: &mut Stack,
    ) -> bool {
        let Some(root) = self.root else { return false };
        let (nodes, packs) = (&self.nodes[..], &self.packs[..]);
        let slabs = Slabs::new(ray);
        let stack = &mut stack.0;
        stack[0].1 = root;
        let mut top = 1;
        while top > 0 {
            top -= 1;
            match child(stack[top].1) {
                Child::Node(index) => {
                    let node = &nodes[index];
                    let (_, mask) = slabs.test::<W>(node, t_max);
                    let mut mask = mask.bits();
                    while mask != 0 {
                        let i = mask.trailing_zeros() as usize;
                        mask &= mask - 1;
                        stack[top].1 = node.child[i];
                        top += 1;
                    }
                }
                Child::Pack(index) => {
                    let pack = &packs[index];
                    if triangle::intersect::<W>(pack, sheared, t_max).is_some() {
                        return true;
                    }
                }
                Child::Quadric(primitive) => {
                    if quadric(geometry, primitive, ray, t_max).is_some() {
                        return true;
                    }
                }
            }
        }
        false
    }
}

impl Bvh {
    /// The large flat faces, which are not in the tree.
    pub(crate) fn plates(&self) -> &Plates {
        &self.plates
    }

    /// The few spheres and cylinders that are not in the tree.
    pub(crate) fn quadrics(&self) -> &Quadrics {
        &self.quadrics
    }

    /// Whether there is anything but plates.
    pub(crate) fn has_others(&self) -> bool {
        self.root.is_some() || !self.quadrics.is_empty()
    }

    /// The distance at which a ray meets a sphere or cylinder, in (0, t_max].
    #[inline(always)]
    pub(crate) fn quadric(
        &self,
        geometry: &Geometry,
        primitive: u32,
        ray: &Ray,
        t_max: f32,
    ) -> Option<f32> {
        if is_traceable(ray) { quadric(geometry, primitive, ray, t_max) } else { None }
    }

    /// Which of the rays may meet what is in the tree before `t_max`.
    #[inline(always)]
    pub(crate) fn meets_tree<P: Packet>(&self, rays: &Passing<P>, t_max: P) -> P::Mask {
        if self.root.is_none() {
            return P::mask(0);
        }
        let all = rays.meet(&self.extent, t_max);
        if all.any() { all & self.parts.meet(rays, t_max) } else { all }
    }

    /// Which parts of the tree may reach into a shaft.
    #[inline(always)]
    pub(crate) fn parts_within<W: Wide>(&self, shaft: &Shaft) -> u64 {
        self.parts.within::<W>(shaft)
    }

    /// Which of the rays may meet these parts of the tree before `t_max`.
    #[inline(always)]
    pub(crate) fn meets_parts<P: Packet>(
        &self,
        which: u64,
        rays: &Passing<P>,
        t_max: P,
    ) -> P::Mask {
        self.parts.meet_some(which, rays, t_max)
    }
}
