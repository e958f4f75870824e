//! The few spheres and cylinders of a scene: tried by as many rays at a time as a register holds,
//! those that lie together only if a ray hits the box around them. A tree walks through its nodes
//! for each ray by itself to find the same few shapes.
//!
//! A quick test decides where it is sure: by more than all rounding errors of its own and of the exact
//! one. The exact test decides about the rest, so no hit depends on the quick one.

mod quick_test;
#[cfg(test)]
mod tests;

use crate::geometry::aabb::{Aabb, PacketSlabs};
use crate::geometry::accel::bounds::primitive_bounds;
use crate::geometry::accel::clusters::{self, Cluster};
use crate::geometry::accel::leaf::hit_analytic;
use crate::geometry::accel::node::Node;
use crate::geometry::accel::quads::MAX_QUADS;
use crate::geometry::accel::shaft::{Rays, Shaft};
use crate::geometry::{Geometry, Kind};
use crate::math::V3;
use crate::math::simd::{Bits, MAX_WIDTH, Mask, Simd8, SimdWide};
use quick_test::{QuickTest, Segment};

/// Most shapes: of more than these each ray of a register is tried against too many that it misses.
const MOST: usize = 32;
/// Where a scene has more than these, shapes with a box of at least this part of the surface of the
/// scene's.
const LARGE: f64 = 1.0 / 256.0;

/// Shapes that are not in the tree.
#[derive(Clone, Debug, Default)]
pub(super) struct AnalyticShapes {
    shapes: Vec<AnalyticShape>,
    /// Those that lie together, and the rest.
    clusters: Vec<Cluster>,
    lone: Vec<u32>,
    /// Their boxes.
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct AnalyticShape {
    primitive: u32,
    quick: QuickTest,
    /// A box around it, where that is the quicker test: around cylinders.
    aabb: Option<Aabb>,
}

impl AnalyticShape {
    /// Whether all of the rays certainly pass its box by.
    #[inline(always)]
    fn is_missed<P: SimdWide>(&self, slabs: &PacketSlabs<P>, t_max: P) -> bool {
        match &self.aabb {
            Some(aabb) => !slabs.may_hit(aabb, t_max).any(),
            None => false,
        }
    }
}

impl AnalyticShapes {
    /// Picks the shapes out of a scene: all where they are few, else the largest.
    pub(super) fn new(geometry: &Geometry) -> AnalyticShapes {
        let mut primitives: Vec<u32> =
            (geometry.faces().len() as u32..geometry.len() as u32).collect();
        if primitives.is_empty() {
            return AnalyticShapes::default();
        }
        let surface = |&i: &u32| clusters::surface(primitive_bounds(geometry, i));
        let corners = geometry.vertices().iter().map(|v| [V3::from(v.position); 2]);
        let scene = primitives
            .iter()
            .map(|&i| primitive_bounds(geometry, i))
            .chain(corners)
            .reduce(clusters::around)
            .unwrap_or_default();
        if primitives.len() > MOST {
            let least = LARGE * clusters::surface(scene);
            primitives.retain(|i| surface(i) >= least);
            primitives.sort_by(|a, b| surface(b).total_cmp(&surface(a)).then(a.cmp(b)));
            primitives.truncate(MOST);
            primitives.sort_unstable();
        }
        let shape = |&primitive: &u32| {
            let around = || Aabb::from_corners(primitive_bounds(geometry, primitive));
            let (quick, aabb) = match geometry.kind(primitive) {
                Kind::Sphere(i) => (QuickTest::sphere(&geometry.spheres[i]), None),
                Kind::Cylinder(i) => (QuickTest::cylinder(&geometry.cylinders[i]), Some(around())),
                Kind::Triangle(_) => return None,
            };
            Some(AnalyticShape { primitive, quick, aabb })
        };
        let shapes: Vec<AnalyticShape> = primitives.iter().filter_map(shape).collect();
        let bounds = |shape: &AnalyticShape| primitive_bounds(geometry, shape.primitive);
        let pieces: Vec<_> = (0..).zip(shapes.iter().map(bounds)).collect();
        let (clusters, lone) = clusters::gather(&pieces, scene);
        let nodes = Node::of_boxes(&shapes.iter().map(bounds).collect::<Vec<_>>());
        AnalyticShapes { shapes, clusters, lone, nodes }
    }

    /// Their primitives, in order.
    pub(super) fn primitives(&self) -> impl Iterator<Item = u32> {
        self.shapes.iter().map(|shape| shape.primitive)
    }

    /// True without any.
    pub(super) fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The number by which rays name the one that they leave from, if it is one of these: those of
    /// large quads come before.
    pub(super) fn number_of(&self, primitive: u32) -> Option<u32> {
        let at = self.shapes.binary_search_by_key(&primitive, |shape| shape.primitive).ok()?;
        Some(MAX_QUADS as u32 + at as u32)
    }

    /// The bit that [`AnalyticShapes::within`] has for the one of this number, if it is one.
    #[inline(always)]
    pub(super) fn bit_of(&self, number: u32) -> u64 {
        let at = number.wrapping_sub(MAX_QUADS as u32);
        if (at as usize) < self.shapes.len() { 1 << at } else { 0 }
    }

    /// Which of them may reach into a shaft: bit `i` for the `i`th.
    #[inline(always)]
    pub(super) fn within<W: Simd8>(&self, shaft: &Shaft) -> u64 {
        shaft.among::<W>(&self.nodes)
    }

    /// Calls `each` with the shapes that some of the rays may hit before `t_max`, and with those
    /// rays as bits. One that a ray leaves outwards, by its number in `from`, is none of them.
    #[inline(always)]
    pub(super) fn may_hit<P: SimdWide>(
        &self,
        (o, d, t_max): (V3<P>, V3<P>, P),
        slabs: &PacketSlabs<P>,
        from: P::Bits,
        live: P::Mask,
        each: &mut impl FnMut(u32, u32),
    ) {
        let segment = Segment::new(o, d, t_max);
        let mut found = [0; MOST];
        for &at in &self.lone {
            found[at as usize % MOST] = self.may_hit_one(at, &segment, slabs, from);
        }
        for cluster in &self.clusters {
            if (slabs.may_hit(&cluster.aabb, t_max) & live).any() {
                for &at in &cluster.members {
                    found[at as usize % MOST] = self.may_hit_one(at, &segment, slabs, from);
                }
            }
        }
        // SIMD code must not end up in a closure, which is compiled for no instruction set.
        let live = live.bits();
        for (shape, found) in self.shapes.iter().zip(found) {
            if found & live != 0 {
                each(shape.primitive, found & live);
            }
        }
    }

    #[inline(always)]
    fn may_hit_one<P: SimdWide>(
        &self,
        at: u32,
        segment: &Segment<P>,
        slabs: &PacketSlabs<P>,
        from: P::Bits,
    ) -> u32 {
        if self.shapes[at as usize].is_missed(slabs, segment.t_max) {
            return 0;
        }
        let own = P::equal_bits(from, P::Bits::splat(MAX_QUADS as u32 + at));
        (self.shapes[at as usize].quick.may_hit(segment) & !own).bits()
    }

    /// The rays that hit one of the shapes `which` at `0 < t <= t_max`, other than the ones that
    /// they leave from outwards or go to from outside.
    #[inline(always)]
    pub(super) fn occluded_by<P: SimdWide>(
        &self,
        geometry: &Geometry,
        mut which: u64,
        (o, d, t_max): (V3<P>, V3<P>, P),
        ends: [P::Bits; 2],
        live: P::Mask,
    ) -> P::Mask {
        let segment = Segment::new(o, d, t_max);
        let mut blocked = P::mask(0);
        while which != 0 && (live & !blocked).any() {
            let at = which.trailing_zeros();
            which &= which - 1;
            blocked = blocked | self.shade(geometry, at, &segment, ends, live & !blocked);
        }
        blocked
    }

    /// [`AnalyticShapes::occluded_by`] for all of them, by way of the boxes around those that lie together.
    #[inline(always)]
    pub(super) fn occluded<P: SimdWide>(
        &self,
        geometry: &Geometry,
        (o, d, t_max): (V3<P>, V3<P>, P),
        slabs: &PacketSlabs<P>,
        ends: [P::Bits; 2],
        live: P::Mask,
    ) -> P::Mask {
        let segment = Segment::new(o, d, t_max);
        let mut blocked = P::mask(0);
        for &at in &self.lone {
            if !self.shapes[at as usize].is_missed(slabs, t_max) {
                blocked = blocked | self.shade(geometry, at, &segment, ends, live & !blocked);
            }
        }
        for cluster in &self.clusters {
            let near = slabs.may_hit(&cluster.aabb, t_max) & live & !blocked;
            if !near.any() {
                continue;
            }
            for &at in &cluster.members {
                if !self.shapes[at as usize].is_missed(slabs, t_max) {
                    blocked = blocked | self.shade(geometry, at, &segment, ends, near & !blocked);
                }
            }
        }
        blocked
    }

    /// The rays that one shape is in the way of.
    #[inline(always)]
    fn shade<P: SimdWide>(
        &self,
        geometry: &Geometry,
        at: u32,
        segment: &Segment<P>,
        ends: [P::Bits; 2],
        live: P::Mask,
    ) -> P::Mask {
        let AnalyticShape { primitive, quick, .. } = &self.shapes[at as usize];
        let number = P::Bits::splat(MAX_QUADS as u32 + at);
        let own = P::equal_bits(ends[0], number) | P::equal_bits(ends[1], number);
        let [may, certainly] = quick.occludes(segment);
        let live = live & !own;
        let mut unsure = (may & !certainly & live).bits();
        let mut found = 0;
        if unsure != 0 {
            let (rays, mut t_max) = (Rays::new(segment.o, segment.d), [0.0; MAX_WIDTH]);
            segment.t_max.store(&mut t_max);
            while unsure != 0 {
                let lane = unsure.trailing_zeros() as usize;
                unsure &= unsure - 1;
                let hit =
                    hit_analytic(geometry, *primitive, &rays.get(lane), t_max[lane]).is_some();
                found |= u32::from(hit) << lane;
            }
        }
        (certainly & live) | P::mask(found)
    }
}
