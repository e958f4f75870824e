//! One ray through the tree: the nearest hit, or whether there is any.

use super::bvh::Bvh;
use super::leaf::{hit_analytic, take_nearer, take_nearest};
use super::node::{Child, child};
use super::ray::{Ray, is_traceable};
use super::slabs::Slabs;
use super::stack::Stack;
use crate::geometry::triangle::{self, ShearedRay};
use crate::geometry::{Geometry, Hit};
use crate::math::Mask;
use crate::math::simd::{Kernel, Simd8, SimdWide, dispatch};

impl Bvh {
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
        dispatch(stack.isa, Closest(self, geometry, ray, t_max, stack))
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
        dispatch(stack.isa, Occluded(self, geometry, ray, t_max, stack))
    }
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
}
