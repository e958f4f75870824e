//! What happens at a surface: light that is hit, lights that are sampled, and a direction to go on in.

use super::PathBatch;
use super::vertex::{Arrival, ScatteringVertex};
use crate::brdf::Microfacet;
use crate::math::V3;
use crate::math::simd::{Kernel, Mask, Simd8, SimdWide};
use crate::trace::Tracer;
use std::marker::PhantomData;

/// One scattering event of the first `count` paths: adds the light that they hit, prepares the rays
/// towards lights and the rays that go on. Where paths are shared, what happens at the primary vertex
/// and the reuse vertex is kept for that, and light from beyond is counted as it arrives there.
pub(super) struct ShadeHits<'a, M> {
    pub(super) tracer: &'a Tracer,
    pub(super) batch: &'a mut PathBatch,
    pub(super) count: usize,
    pub(super) event: u32,
    pub(super) model: PhantomData<M>,
}

impl<M: Microfacet> Kernel for ShadeHits<'_, M> {
    /// Number of paths that go on.
    type Output = usize;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> usize {
        let ShadeHits { tracer, batch, count, event, .. } = self;
        let (mut going, mut images) = (0, Vec::new());
        batch.shadows.count = 0;
        for at in (0..count).step_by(P::WIDTH) {
            let arrival = Arrival::<P>::load(batch, &tracer.tables, at, count, event);
            tracer.add_emission(batch, &arrival);
            let view = arrival.d;
            let vertex = ScatteringVertex::facing(batch, arrival);
            batch.keep_primary_vertices(&vertex, -view);
            if !vertex.go.any() {
                continue;
            }
            let scattering = tracer.scattering::<P, M>(batch, &vertex);
            let split = tracer.split_at_points::<P, M>(batch, &vertex, &scattering);
            let light = tracer.sample_lights::<P, M>(batch, &vertex, &scattering);
            going += tracer.scatter::<P, M>(
                batch,
                &vertex,
                &scattering,
                &light,
                split,
                going,
                &mut images,
            );
        }
        going
    }
}

impl PathBatch {
    /// Keeps those of the points that are primary vertices, seen in direction `wo` of the world.
    #[inline(always)]
    fn keep_primary_vertices<P: SimdWide>(&mut self, vertex: &ScatteringVertex<P>, wo: V3<P>) {
        let primary = vertex.primary();
        if self.shares && (vertex.event == 0 || primary.any()) {
            let what = [vertex.material, vertex.surface_id, vertex.role.lead];
            let (slots, point) = (vertex.primary_slots(), &vertex.point);
            self.primary.store(vertex.at, slots, primary, point, wo, vertex.beta, what);
        }
    }
}
