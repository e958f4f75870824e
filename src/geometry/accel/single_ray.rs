//! One ray through the tree: the nearest hit, or whether there is any.

use super::build::Bvh;
use super::node::{Child, child};
use super::packet::TreeRays;
use super::ray_stream::Streams;
use super::shaft::Shaft;
use super::slabs::Slabs;
use super::visible::PairRays;
use crate::geometry::aabb::PacketSlabs;
use crate::geometry::triangle::{self, ShearedRay, TrianglePack8};
use crate::geometry::{Geometry, Hit, Kind};
use crate::math::simd::{Kernel, Simd8, SimdWide, dispatch};
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

/// Memory for traversal. Made once a worker by [`Bvh::stack`] and used for all its rays.
#[derive(Clone, Debug)]
pub struct Stack {
    /// Subtrees of a single ray that are still to be visited.
    pub(super) subtrees: Box<[(f32, u32)]>,
    pub(super) streams: Streams,
    pub(super) tree_rays: TreeRays,
    pub(super) pair_rays: PairRays,
}

impl Bvh {
    /// A stack deep enough for this tree.
    pub fn stack(&self) -> Stack {
        Stack {
            subtrees: vec![(0.0, 0); 7 * self.depth() + 9].into(),
            streams: Streams::new(self.depth()),
            tree_rays: TreeRays::default(),
            pair_rays: PairRays::default(),
        }
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
            fn run<W: Simd8, P: SimdWide>(self) -> Option<Hit> {
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
            fn run<W: Simd8, P: SimdWide>(self) -> bool {
                self.0.occluded_with::<W>(self.1, self.2, self.3, self.4)
            }
        }
        dispatch(self.isa, Occluded(self, geometry, ray, t_max, stack))
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
    pub(super) fn closest_with<W: Simd8>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        t_max: f32,
        stack: &mut Stack,
    ) -> Option<Hit> {
        if !is_traceable(ray) {
            return None;
        }
        let sheared = ShearedRay::new(ray.o, ray.d);
        let mut best = Hit { t: t_max, primitive: u32::MAX, b: [0.0; 2] };
        self.take_outside::<W>(geometry, ray, &sheared, &mut best);
        let hit = self.closest_in_tree::<W>(geometry, ray, &sheared, best, stack);
        self.in_front(geometry, ray, hit)
    }

    /// Takes the nearer of the best hit so far and what is not in the tree.
    #[inline(always)]
    pub(super) fn take_outside<W: Simd8>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sheared: &ShearedRay,
        best: &mut Hit,
    ) {
        for pack in &self.large {
            take_nearest::<W>(best, pack, sheared);
        }
        for primitive in self.analytic.primitives() {
            if let Some(t) = hit_analytic(geometry, primitive, ray, best.t) {
                take_nearer(best, t, primitive, [0.0; 2]);
            }
        }
    }

    /// The hit, or what coincides with it and lies in front.
    #[inline(always)]
    pub(super) fn in_front(&self, geometry: &Geometry, ray: &Ray, hit: Option<Hit>) -> Option<Hit> {
        match hit {
            Some(hit) if self.coincident.may_be_behind(hit.primitive) => {
                Some(self.coincident.foremost(geometry, ray, hit))
            }
            hit => hit,
        }
    }

    /// The nearer of the best hit so far and what the tree holds.
    #[inline(always)]
    pub(super) fn closest_in_tree<W: Simd8>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sheared: &ShearedRay,
        mut best: Hit,
        stack: &mut Stack,
    ) -> Option<Hit> {
        let Some(mut word) = self.root else {
            return (best.primitive != u32::MAX).then_some(best);
        };
        let (nodes, packs) = (&self.nodes[..], &self.packs[..]);
        let slabs = Slabs::new(ray);
        let stack = &mut stack.subtrees;
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
                Child::Triangles(index) => {
                    let pack = &packs[index];
                    take_nearest::<W>(&mut best, pack, sheared);
                }
                Child::Analytic(primitive) => {
                    if let Some(t) = hit_analytic(geometry, primitive, ray, best.t) {
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
pub(super) fn take_nearest<W: Simd8>(best: &mut Hit, pack: &TrianglePack8, ray: &ShearedRay) {
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
pub(super) fn hit_analytic(
    geometry: &Geometry,
    primitive: u32,
    ray: &Ray,
    t_max: f32,
) -> Option<f32> {
    match geometry.kind(primitive) {
        Kind::Sphere(i) => geometry.spheres[i].intersect(ray.o, ray.d, t_max),
        Kind::Cylinder(i) => geometry.cylinders[i].intersect(ray.o, ray.d, t_max),
        Kind::Triangle(_) => None,
    }
}

impl Bvh {
    /// [`Bvh::occluded`] for callers that run under an instruction set already.
    #[inline(always)]
    pub(super) fn occluded_with<W: Simd8>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        t_max: f32,
        stack: &mut Stack,
    ) -> bool {
        if !is_traceable(ray) {
            return false;
        }
        let sheared = ShearedRay::new(ray.o, ray.d);
        for pack in &self.large {
            if triangle::intersect::<W>(pack, &sheared, t_max).is_some() {
                return true;
            }
        }
        for primitive in self.analytic.primitives() {
            if hit_analytic(geometry, primitive, ray, t_max).is_some() {
                return true;
            }
        }
        self.occluded_in_tree::<W>(geometry, ray, &sheared, t_max, stack)
    }

    /// Whether what the tree holds is hit at `0 < t <= t_max`.
    #[inline(always)]
    pub(super) fn occluded_in_tree<W: Simd8>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        sheared: &ShearedRay,
        t_max: f32,
        stack: &mut Stack,
    ) -> bool {
        let Some(root) = self.root else { return false };
        let (nodes, packs) = (&self.nodes[..], &self.packs[..]);
        let slabs = Slabs::new(ray);
        let stack = &mut stack.subtrees;
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
                Child::Triangles(index) => {
                    let pack = &packs[index];
                    if triangle::intersect::<W>(pack, sheared, t_max).is_some() {
                        return true;
                    }
                }
                Child::Analytic(primitive) => {
                    if hit_analytic(geometry, primitive, ray, t_max).is_some() {
                        return true;
                    }
                }
            }
        }
        false
    }
}

impl Bvh {
    /// Whether there is anything but large quads.
    pub(super) fn has_others(&self) -> bool {
        self.root.is_some() || !self.analytic.is_empty()
    }

    /// The distance at which a ray hits a sphere or cylinder, in (0, t_max].
    #[inline(always)]
    pub(super) fn hit_analytic(
        &self,
        geometry: &Geometry,
        primitive: u32,
        ray: &Ray,
        t_max: f32,
    ) -> Option<f32> {
        if is_traceable(ray) { hit_analytic(geometry, primitive, ray, t_max) } else { None }
    }

    /// Which of the rays may hit what is in the tree before `t_max`.
    #[inline(always)]
    pub(super) fn may_hit_tree<P: SimdWide>(&self, rays: &PacketSlabs<P>, t_max: P) -> P::Mask {
        if self.root.is_none() {
            return P::mask(0);
        }
        let all = rays.may_hit(&self.aabb, t_max);
        if all.any() { all & self.top_boxes.may_hit(rays, t_max) } else { all }
    }

    /// Which parts of the tree may reach into a shaft.
    #[inline(always)]
    pub(super) fn top_boxes_within<W: Simd8>(&self, shaft: &Shaft) -> u64 {
        self.top_boxes.within::<W>(shaft)
    }

    /// Which of the rays may hit these parts of the tree before `t_max`.
    #[inline(always)]
    pub(super) fn may_hit_top_boxes<P: SimdWide>(
        &self,
        which: u64,
        rays: &PacketSlabs<P>,
        t_max: P,
    ) -> P::Mask {
        self.top_boxes.may_hit_some(which, rays, t_max)
    }
}
