//! Emitter splitting: more rays where they may hit an emitter, which end there.
//!
//! At the edge of an emitter, seen or mirrored, one ray a pixel is mostly chance, and nothing that comes
//! later in the path makes up for it. So the camera's ray has company where an emitter may be in the
//! pixel, and the ray from a primary vertex with a sharp lobe has where it may hit one. What they find is
//! averaged, and weighed against light sampling as one of them would be: so the variance of what is found by
//! light sampling stays, and that of what is hit falls. The path goes on by its own ray alone.

use super::PathBatch;
use super::emission::AddEmission;
use super::rays::TraceRays;
use super::state::{RayBatch, RayQueue};
use super::vertex::{Scattering, ScatteringVertex, is_black};
use crate::brdf::{BrdfParams, Microfacet};
use crate::geometry::{Aabb, NO_SURFACE, PacketSlabs, Stack, offset_origin};
use crate::math::V3;
use crate::math::simd::{Bits, Mask, SimdWide, dispatch};
use crate::math::sobol::{Slot, Stream, pair, unit};
use crate::trace::{RayCounts, Stage, Tracer, Watch};
use std::mem::{swap, take};

/// Number of rays, the path's own among them: a power of 2, so that as many equal parts are the
/// whole to the last digit. Eight were 1.05 times as efficient in the plates and 0.92 times in scenes
/// with more to see than emitters.
const SPLIT: usize = 4;
/// How many of them are split rays.
const EXTRA: usize = SPLIT - 1;

/// Roughness alpha from which on light sampling does as well.
const SHARP: f32 = 0.15;

/// The split rays of a batch, in rounds of at most one a path.
#[derive(Clone, Debug, Default)]
pub(super) struct SplitRays {
    /// Whether any are wanted.
    pub(super) wanted: bool,
    rounds: [Box<RayQueue>; EXTRA],
    counts: [usize; EXTRA],
}

impl Tracer {
    /// Where emitters may be in pixels `block` times the picture's.
    pub(super) fn emitter_boxes(&self, block: u32) -> Vec<Aabb> {
        let radius = self.camera.pixel_radius() * block as f32;
        let eye = self.camera.eye();
        let grown = |aabb: &Aabb| {
            let reach = (aabb.centre - eye).length() + aabb.half.length();
            let half = aabb.half + V3::splat(reach * radius);
            Aabb { half, ..*aabb }
        };
        // One that is all around would be in every pixel.
        let apart = |aabb: &Aabb| {
            let (away, half) = ((aabb.centre - eye).abs(), aabb.half);
            away.x > half.x || away.y > half.y || away.z > half.z
        };
        self.lights.emitter_boxes().iter().map(grown).filter(apart).collect()
    }

    /// Adds the camera's split rays for the pixels in columns `x` and rows `y`, `side` times the
    /// picture's, whose paths have these slots. Returns the part that counts of the light that a ray
    /// hits there.
    #[inline(always)]
    pub(super) fn split_camera_rays<P: SimdWide>(
        &self,
        split_rays: &mut SplitRays,
        emitter_boxes: &[Aabb],
        live: P::Mask,
        [x, y]: [P; 2],
        side: P,
        (slot, stream): (P::Bits, &Stream<P::Bits>),
    ) -> P {
        let one = P::splat(1.0);
        let (eye, half) = (self.camera.eye().splat_lanes::<P>(), P::splat(0.5));
        let middle = self.camera.direction((x + half) * side, (y + half) * side);
        let slabs = PacketSlabs::new(eye, middle);
        let mut near = P::mask(0);
        for emitter_box in emitter_boxes {
            near = near | slabs.may_hit(emitter_box, P::splat(f32::INFINITY));
        }
        let near = near & live;
        if !near.any() {
            return one;
        }
        let mis_fraction = P::select(near, P::splat(1.0 / SPLIT as f32), one);
        for which in 0..EXTRA {
            let stream = stream.one_of(EXTRA as u32, which as u32);
            let [dx, dy] = pair::<P>(&stream, Slot::SPLIT_CAMERA);
            let d = self.camera.direction((x + dx) * side, (y + dy) * side);
            let (rays, end) = (&mut split_rays.rounds[which], split_rays.counts[which]);
            rays.o.push::<P>(end, near, eye);
            rays.d.push::<P>(end, near, d);
            rays.beta.push::<P>(end, near, V3::splat(one));
            rays.mis_fraction.push::<P>(end, near, mis_fraction);
            rays.surface_id.push::<P>(end, near, P::Bits::splat(NO_SURFACE));
            rays.slot.push::<P>(end, near, slot);
            rays.lead.push::<P>(end, near, P::Bits::splat(0));
            split_rays.counts[which] += near.bits().count_ones() as usize;
        }
        mis_fraction
    }

    /// Number of rays that leave primary vertices: more than one where they have a sharp lobe and emitters are all
    /// that shines.
    #[inline(always)]
    fn split_count<P: SimdWide>(&self, split_rays: &SplitRays, params: &BrdfParams<P>) -> P {
        let one = P::splat(1.0);
        if !split_rays.wanted
            || !self.lights.has_no_environment()
            || self.lights.emitter_boxes().is_empty()
        {
            return one;
        }
        let sharp = params.roughness.alpha.lt(P::splat(SHARP)) & !is_black(params.ks);
        P::select(sharp, P::splat(SPLIT as f32), one)
    }

    /// Adds the split rays that leave the points that camera rays hit. Returns the number of rays that
    /// leave each, the path's own among them.
    #[inline(always)]
    pub(super) fn split_at_points<P: SimdWide, M: Microfacet>(
        &self,
        batch: &mut PathBatch,
        vertex: &ScatteringVertex<P>,
        scattering: &Scattering<P>,
    ) -> P {
        let one = P::splat(1.0);
        if vertex.event > 0 {
            return one;
        }
        let split_rays = &mut batch.split_rays;
        let split = self.split_count(split_rays, &vertex.params);
        let sharp = vertex.go & split.gt(one);
        if !sharp.any() {
            return split;
        }
        let &ScatteringVertex { ref point, surface_id, slot, .. } = vertex;
        let Scattering { brdf, context, stream, .. } = scattering;
        let mis_fraction = P::splat(1.0 / SPLIT as f32);
        for which in 0..EXTRA {
            let split_stream = stream.one_of(EXTRA as u32, which as u32);
            let [lobe_choice, _] = split_stream.pair_bits(Slot::SPLIT_CHOICE);
            let u = pair::<P>(&split_stream, Slot::SPLIT_DIRECTION);
            let next = brdf.sample::<M>(unit::<P>(lobe_choice), u);
            let d = vertex.frame.to_world(next.wi);
            let cos = next.wi.z;
            let beta = vertex.beta * next.f * (cos / next.pdf);
            let zero = P::splat(0.0);
            let leaves = next.pdf.gt(zero) & point.ng.dot(d).gt(zero);
            let goes = sharp & leaves & !is_black(beta);
            let o = offset_origin(point.p, point.error, point.ng, d);
            let goes = goes & self.lights.may_hit_emitter(o, d);
            let pdf = next.pdf;
            let lead = P::Bits::splat(0);
            let ray = RayBatch {
                o,
                d,
                beta,
                pdf,
                mis_fraction,
                cos,
                context,
                surface_id,
                slot,
                lead,
                stream,
            };
            let (rays, end) = (&mut split_rays.rounds[which], split_rays.counts[which]);
            split_rays.counts[which] += rays.push::<P>(end, goes, &ray, &self.lights, 0);
        }
        split
    }
}

impl SplitRays {
    /// Forgets all rays.
    pub(super) fn begin(&mut self, wanted: bool) {
        self.wanted = wanted;
        self.counts = [0; EXTRA];
    }
}

/// Sends the split rays on, to the emitters that they hit.
pub(super) struct TraceSplitRays<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) batch: &'a mut PathBatch,
    /// What they arrive at.
    pub(super) event: u32,
    pub(super) stack: &'a mut Stack,
}

impl TraceSplitRays<'_> {
    pub(super) fn run(self, rays: &mut u64, counts: &mut RayCounts, watch: Watch) {
        let TraceSplitRays { tracer, batch, event, stack } = self;
        let isa = tracer.scene.isa();
        for round in 0..EXTRA {
            let count = take(&mut batch.split_rays.counts[round]);
            if count == 0 {
                continue;
            }
            swap(&mut batch.paths, &mut batch.split_rays.rounds[round]);
            counts.tree_rays +=
                dispatch(isa, TraceRays { tracer, batch, count, known: false, stack });
            *rays += count as u64;
            counts.nearest += count as u64;
            watch(Stage::Trace, count);
            dispatch(isa, AddEmission { tracer, batch, count, event });
            watch(Stage::Shade, count);
            swap(&mut batch.paths, &mut batch.split_rays.rounds[round]);
        }
    }
}
