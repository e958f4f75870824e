//! Direct light: lights sampled at the points of paths, and which of the samples are visible.

use super::PathBatch;
use super::light_sums::LightSum;
use super::vertex::{Scattering, ScatteringVertex, is_black, select};
use crate::brdf::Microfacet;
use crate::geometry::{SegmentSoa, Stack, offset_origin};
use crate::math::V3;
use crate::math::simd::{Kernel, Mask, Simd8, SimdWide, each_lane};
use crate::math::sobol::{Slot, pair, unit};
use crate::trace::{Tracer, power_heuristic};

/// What a reuse vertex keeps of the light sampled there.
pub(super) struct SampledLight<P: SimdWide> {
    /// Direction in the frame that its viewers agree on, with its density in 1/sr; 0 for none.
    pub(super) wi: V3<P>,
    pub(super) pdf: P,
    /// Density in 1/sr with which the path itself samples it from the BRDF.
    pub(super) bsdf_pdf: P,
}

impl Tracer {
    /// Adds the rays towards lights sampled at the points, each with the light that is reflected if
    /// nothing is in its way, or that arrives at a reuse vertex.
    #[inline(always)]
    pub(super) fn sample_lights<P: SimdWide, M: Microfacet>(
        &self,
        batch: &mut PathBatch,
        vertex: &ScatteringVertex<P>,
        scattering: &Scattering<P>,
    ) -> SampledLight<P> {
        let &ScatteringVertex { event, go, ref point, ref frame, ref role, beta, .. } = vertex;
        let Scattering { brdf, context, agreed, bends, .. } = scattering;
        let (bvh, geometry, lights) = (self.scene.bvh(), self.scene.geometry(), &self.lights);
        let zero = P::splat(0.0);
        let tagged_slot = vertex.slot + role.sampled_light_tag();
        let mut kept = SampledLight { wi: vertex.wo, pdf: zero, bsdf_pdf: zero };
        let count = if lights.count() > 0 { batch.light_samples(event) } else { 0 };
        for which in 0..count {
            let stream = scattering.stream.one_of(count, which);
            let [_, light_choice] = stream.pair_bits(Slot::choice(event));
            let u = pair::<P>(&stream, Slot::light(event));
            let choice = unit::<P>(light_choice);
            let mut light = lights.sample::<P>(bvh, geometry, context, choice, u);
            light.pdf = light.pdf * P::splat(count as f32);
            let wi = frame.to_local(light.wi);
            // What is below the one viewer's normal may be above the other's.
            let above = point.ng.dot(light.wi).gt(zero) & (wi.z.gt(zero) | role.reuse);
            let mut traced = go & light.found & above;
            if !traced.any() {
                continue;
            }
            let o = offset_origin(point.p, point.error, point.ng, light.wi);
            let way = light.shadow_ray(o);
            traced = traced & way.hits;
            let e = brdf.eval::<M>(wi);
            let weight = power_heuristic(light.pdf, e.pdf);
            let reflected = beta * light.radiance * e.f * (wi.z / light.pdf * weight);
            if role.reuse.any() {
                kept.wi = wi;
                if bends.any() {
                    kept.wi = V3::select(*bends, agreed.to_local(light.wi), wi);
                }
                kept.pdf = light.pdf.or_zero(traced);
                kept.bsdf_pdf = e.pdf;
            }
            traced = traced & (role.reuse | !is_black(reflected));
            let found = select(role.reuse, light.radiance, reflected);
            let shadows = &mut batch.shadows;
            let end = shadows.count;
            shadows.o.push::<P>(end, traced, o);
            shadows.d.push::<P>(end, traced, way.d);
            shadows.t_max.push::<P>(end, traced, way.t_max);
            shadows.light.push_rgb::<P>(end, traced, found);
            shadows.surface_ids[0].push::<P>(end, traced, vertex.surface_id);
            shadows.surface_ids[1].push::<P>(end, traced, light.surface_id);
            shadows.tagged_slot.push::<P>(end, traced, tagged_slot);
            shadows.count += traced.bits().count_ones() as usize;
        }
        kept
    }
}

/// Adds the light of those shadow rays that nothing is in the way of.
pub(super) struct TraceShadowRays<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) batch: &'a mut PathBatch,
    pub(super) stack: &'a mut Stack,
}

impl Kernel for TraceShadowRays<'_> {
    /// How many have gone through the tree.
    type Output = u64;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> u64 {
        let TraceShadowRays { tracer, batch, stack } = self;
        let PathBatch { shadows, visible, .. } = &mut *batch;
        let [from, to] = &shadows.surface_ids;
        let segments = SegmentSoa {
            count: shadows.count,
            o: &shadows.o,
            d: &shadows.d,
            t_max: &shadows.t_max,
            ends: [from, to],
        };
        let (bvh, geometry) = (tracer.scene.bvh(), tracer.scene.geometry());
        let tree_count = bvh.occluded_packet::<W, P>(geometry, &segments, visible, stack);
        for (register, at) in (0..batch.shadows.count).step_by(P::WIDTH).enumerate() {
            for lane in each_lane(batch.visible[register]) {
                let light = batch.shadows.light.get(at + lane);
                let (sum, slot) = LightSum::of(batch.shadows.tagged_slot.0[at + lane]);
                batch.add_to(sum, slot, light);
            }
        }
        tree_count
    }
}
