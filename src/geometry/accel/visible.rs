//! Visibility between the points of a group and other points, asked for one of those at a time: what
//! lies between is looked up once for all of the group.

use super::NO_SURFACE;
use super::bvh::Bvh;
use super::ray::Query;
use super::shaft::{Rays, Shaft};
use super::stack::{PairRays, Stack};
use crate::geometry::aabb::PacketSlabs;
use crate::geometry::{Geometry, offset_origin};
use crate::math::V3;
use crate::math::simd::{Bits, MAX_WIDTH, Mask, Simd8, SimdWide, each_lane, first_lanes};
use crate::math::soa::{Soa, Soa3};
use std::ops::Range;

/// With this many rays of a register or more one shaft is looked up for all of them.
const SHAFT_RAYS: u32 = 7;

/// Rays that go through the tree together: enough to hide each other's waiting, and no more than the
/// nearest memory holds.
const PENDING_RAYS: usize = 1024;

/// Points on surfaces, one array a component.
pub(crate) struct PointSoa<'a> {
    pub(crate) p: &'a Soa3,
    /// Bound on the error of `p`, in each component.
    pub(crate) error: &'a Soa3,
    /// [`Bvh::surface_id`] of the surface that each is on.
    pub(crate) surface: &'a Soa<u32>,
    /// 0 where there is no point.
    pub(crate) there: &'a Soa<u32>,
}

/// What has been done, by kind.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VisibilityCounts {
    /// Rays between points.
    pub(crate) rays: u64,
    /// Shapes and boxes that these were tested against.
    pub(crate) tests: u64,
    /// Of these rays, the ones that went through the tree because it may be in their way.
    pub(crate) pair_rays: u64,
    /// The ones that went through it because the quick tests could not tell.
    pub(crate) tree_rays: u64,
}

/// A point that those of the group may see, and what may be in the way.
pub(crate) struct Target<P: SimdWide> {
    corner: V3,
    pub(crate) p: V3<P>,
    error: V3<P>,
    pub(crate) ng: V3<P>,
    surface: P::Bits,
    /// Large quads, analytic shapes and top boxes, by bit.
    quads: u64,
    analytic: u64,
    top_boxes: u64,
}

/// Visibility from a group of points to others.
pub(crate) struct GroupVisibility<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    points: PointSoa<'a>,
    /// Rays end at this part of the way.
    end: f32,
    stack: &'a mut Stack,
    rays: PairRays,
    first: usize,
    bounds: [V3; 2],
    /// The large quad, by bit, that all points of the group are on.
    floor: u64,
    has_others: bool,
    pub(crate) counts: VisibilityCounts,
}

impl PointSoa<'_> {
    /// Lowest and highest corner of the box around some points, and of those around each register's
    /// worth of them.
    #[inline(always)]
    fn bounds<P: SimdWide>(&self, places: Range<usize>, each: &mut Vec<[V3; 2]>) -> [V3; 2] {
        each.clear();
        let [infinite, nothing] = [f32::INFINITY, f32::NEG_INFINITY];
        for first in (0..places.len()).step_by(P::WIDTH) {
            let at = places.start + first;
            let there = !P::equal_bits(self.there.load::<P>(at), P::Bits::splat(0));
            let there = there & P::mask(first_lanes(places.len() - first));
            let p = self.p.load::<P>(at);
            let mut corners = [[0.0; 3]; 2];
            for (axis, x) in [p.x, p.y, p.z].into_iter().enumerate() {
                let mut lanes = [0.0; MAX_WIDTH];
                P::select(there, x, P::splat(infinite)).store(&mut lanes);
                corners[0][axis] = lanes[..P::WIDTH].iter().copied().fold(infinite, f32::min);
                P::select(there, x, P::splat(nothing)).store(&mut lanes);
                corners[1][axis] = lanes[..P::WIDTH].iter().copied().fold(nothing, f32::max);
            }
            each.push(corners.map(V3::from));
        }
        let none = [V3::splat(infinite), V3::splat(nothing)];
        each.iter().fold(none, |[a, b], [c, d]| [a.min(*c), b.max(*d)])
    }

    /// The surface that all of some points are on; [`NO_SURFACE`] if there is none.
    #[inline(always)]
    fn common_surface(&self, places: Range<usize>) -> u32 {
        let there = places.filter(|&at| self.there.0[at] != 0);
        let surfaces = there.map(|at| self.surface.0[at]);
        surfaces.reduce(|a, b| if a == b { a } else { NO_SURFACE }).unwrap_or(NO_SURFACE)
    }
}

impl Bvh {
    /// Visibility from some of these points at a time, by rays that end at the part `end` of the way.
    #[inline(always)]
    pub(crate) fn visible<'a>(
        &'a self,
        geometry: &'a Geometry,
        points: PointSoa<'a>,
        end: f32,
        stack: &'a mut Stack,
    ) -> GroupVisibility<'a> {
        let rays = std::mem::take(&mut stack.pair_rays);
        GroupVisibility {
            bvh: self,
            geometry,
            points,
            end,
            stack,
            rays,
            first: 0,
            bounds: [V3::default(); 2],
            floor: 0,
            has_others: self.has_others(),
            counts: VisibilityCounts::default(),
        }
    }
}

impl GroupVisibility<'_> {
    /// The points in these places are the group from now on.
    #[inline(always)]
    pub(crate) fn enter<P: SimdWide>(&mut self, places: Range<usize>) {
        self.first = places.start;
        self.bounds = self.points.bounds::<P>(places.clone(), &mut self.rays.boxes);
        self.floor = self.bvh.quads.bit_of(self.points.common_surface(places));
    }

    /// A point with the bound on its error, its geometric normal, and the surface that it is on.
    #[inline(always)]
    pub(crate) fn target<W: Simd8, P: SimdWide>(
        &self,
        [p, error, ng]: [V3; 3],
        surface: u32,
    ) -> Target<P> {
        let bvh = self.bvh;
        let mut quads = bvh.quads.between::<P>(p, self.bounds);
        // What the point is on is in nobody's way, nor is what all of the others are on.
        quads &= !(bvh.quads.bit_of(surface) | self.floor);
        // What may be between the point and any of the others.
        let (mut analytic, mut top_boxes) = (0, 0);
        if self.has_others {
            let shaft = Shaft::new(self.bounds, p);
            analytic = bvh.analytic.within::<W>(&shaft);
            analytic &= !bvh.analytic.bit_of(surface);
            top_boxes = bvh.top_boxes_within::<W>(&shaft);
        }
        Target {
            corner: p,
            p: p.splat_lanes(),
            error: error.splat_lanes(),
            ng: ng.splat_lanes(),
            surface: P::Bits::splat(surface),
            quads,
            analytic,
            top_boxes,
        }
    }

    /// Which of the `live` points of a register see the target: those from place `at` on, whose
    /// position and normal are given, with the way from there. What the tree has to decide is left to
    /// [`GroupVisibility::decide`], under this number.
    #[inline(always)]
    pub(crate) fn sees<W: Simd8, P: SimdWide>(
        &mut self,
        target: &Target<P>,
        number: u32,
        at: usize,
        [p1, ng1, way]: [V3<P>; 3],
        live: P::Mask,
    ) -> u32 {
        let (bvh, geometry) = (self.bvh, self.geometry);
        let traced = u64::from(live.bits().count_ones());
        let Target { quads, analytic, top_boxes, .. } = *target;
        self.counts.rays += traced;
        self.counts.tests += traced * u64::from(analytic.count_ones() + top_boxes.count_ones());
        let o = offset_origin(p1, self.points.error.load::<P>(at), ng1, way);
        let d = offset_origin(target.p, target.error, target.ng, -way) - o;
        let ends = [self.points.surface.load::<P>(at), target.surface];
        let t_max = P::splat(self.end);
        let [blocked, open] = bvh.quads.occluded_by::<P>(quads, o, d, t_max, ends, live);
        let mut clear = live & !blocked;
        if analytic != 0 {
            let (ray, live) = ((o, d, t_max), clear & !open);
            clear = clear & !bvh.analytic.occluded_by(geometry, analytic, ray, ends, live);
        }
        let clear = clear.bits();
        let open = open.bits() & clear;
        let slabs = PacketSlabs::new(o, d);
        let through_tree = match top_boxes {
            0 => 0,
            _ => bvh.may_hit_top_boxes(top_boxes, &slabs, t_max).bits() & clear & !open,
        };
        let mut free = clear & !(open | through_tree);
        if open | through_tree != 0 {
            self.counts.tree_rays += u64::from(open.count_ones());
            self.counts.pair_rays += u64::from(through_tree.count_ones());
            let rays = Rays::new(o, d);
            for lane in each_lane(open) {
                let ray = rays.get(lane);
                let blocked = bvh.occluded_with::<W>(geometry, &ray, self.end, self.stack);
                free |= u32::from(!blocked) << lane;
            }
            let first = at - self.first;
            let PairRays { boxes, leaves, .. } = &mut self.rays;
            let together = through_tree.count_ones() >= SHAFT_RAYS && {
                let shaft = Shaft::new(boxes[first / P::WIDTH], target.corner);
                bvh.look_up::<W>(&shaft, self.stack, leaves)
            };
            if together {
                let rays = (&rays, &slabs);
                free |= through_tree
                    & !bvh.occluded_by::<W, P>(geometry, rays, self.end, through_tree, leaves);
            } else {
                for lane in each_lane(through_tree) {
                    let query = Query { ray: rays.get(lane), t_max: self.end };
                    self.rays.pairs.push((number, (first + lane) as u32));
                    self.rays.queries.push(query);
                }
            }
        }
        free
    }

    /// Sets the bits of those that see: by the number of the target, and in the word by place in the
    /// group. Unless it is the `last` call only when there are enough to be traced together.
    #[inline(always)]
    pub(crate) fn decide<W: Simd8>(&mut self, seen: &mut [u128], last: bool) {
        let PairRays { pairs, queries, occluded, .. } = &mut self.rays;
        if pairs.len() < PENDING_RAYS && !last {
            return;
        }
        self.bvh.occluded_each_in_tree::<W>(self.geometry, queries, self.stack, occluded);
        for (&(number, place), &occluded) in pairs.iter().zip(&*occluded) {
            seen[number as usize] |= u128::from(!occluded) << place;
        }
        pairs.clear();
        queries.clear();
    }

    /// What has been done. Gives the memory back.
    pub(crate) fn end(self) -> VisibilityCounts {
        self.stack.pair_rays = self.rays;
        self.counts
    }
}
