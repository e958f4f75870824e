//! The points where paths scatter, as many at a time as a register holds.

use super::hits::Materials;
use super::light_sums::ReuseRole;
use super::{PathBatch, Tables};
use crate::brdf::{Brdf, BrdfParams, Microfacet};
use crate::geometry::{SurfacePoint, surface_left};
use crate::math::simd::{Mask, Simd, SimdWide, first_lanes};
use crate::math::sobol::{Slot, Stream};
use crate::math::{Frame, Rgb, V3};
use crate::trace::Tracer;
use crate::trace::lights::LightSampleContext;

/// What the rays of the paths from place `at` on have arrived at.
pub(super) struct Arrival<P: SimdWide> {
    pub(super) at: usize,
    /// Number of scattering events before.
    pub(super) event: u32,
    /// Directions of the rays.
    pub(super) d: V3<P>,
    /// Throughputs of the paths so far.
    pub(super) beta: Rgb<P>,
    /// Paths that have hit something, and paths that have not.
    pub(super) hit: P::Mask,
    pub(super) missed: P::Mask,
    /// Surfaces that they hit, with normals on either side.
    pub(super) point: SurfacePoint<P>,
    pub(super) material: Materials<P>,
    pub(super) role: ReuseRole<P>,
}

impl<P: SimdWide> Arrival<P> {
    /// Those of the first `count` paths.
    #[inline(always)]
    pub(super) fn load(
        batch: &PathBatch,
        Tables { materials }: &Tables,
        at: usize,
        count: usize,
        event: u32,
    ) -> Arrival<P> {
        let live = P::mask(first_lanes(count - at));
        let surfaces = batch.hits.surfaces::<P>(at);
        let material = materials.get::<P>(batch.hits.material.load::<P>(at));
        let lead = batch.paths.lead.load::<P>(at);
        Arrival {
            at,
            event,
            d: batch.paths.d.load::<P>(at),
            beta: batch.paths.beta.load_rgb::<P>(at),
            hit: live & surfaces.hit,
            missed: live & !surfaces.hit,
            point: surfaces.point,
            role: ReuseRole::of(batch.shares, lead, event, material.mirror),
            material,
        }
    }

    /// Paths that would be scattered here.
    #[inline(always)]
    pub(super) fn reflecting(&self) -> P::Mask {
        self.hit & self.material.reflects
    }
}

/// Surface points turned to their viewers.
pub(super) struct ScatteringVertex<P: SimdWide> {
    pub(super) at: usize,
    pub(super) event: u32,
    /// Paths that are scattered here.
    pub(super) go: P::Mask,
    /// Both normals are on the viewer's side, and the shading normal is bent until he sees it.
    pub(super) point: SurfacePoint<P>,
    /// The surface's own shading normal, and where the other one differs from it.
    pub(super) own_ns: V3<P>,
    bends: P::Mask,
    /// Around the shading normal.
    pub(super) frame: Frame<P>,
    /// Towards the viewer, in the frame.
    pub(super) wo: V3<P>,
    pub(super) beta: Rgb<P>,
    pub(super) params: BrdfParams<P>,
    pub(super) material: P::Bits,
    /// The surface, as a ray sees it that leaves here.
    pub(super) surface_id: P::Bits,
    /// Places of the paths in the batch.
    pub(super) slot: P::Bits,
    pub(super) role: ReuseRole<P>,
}

impl<P: SimdWide> ScatteringVertex<P> {
    #[inline(always)]
    pub(super) fn facing(batch: &PathBatch, arrival: Arrival<P>) -> ScatteringVertex<P> {
        let Arrival { at, event, d, beta, point, .. } = arrival;
        let zero = P::splat(0.0);
        // What is left outwards, or is a large quad, is not hit again.
        let from_outside = point.ng.dot(d).lt(zero);
        let reflecting = arrival.reflecting();
        let mut point = point.turned_to(-d);
        let own_ns = point.ns;
        let (bent, bends) = point.normal_for(-d);
        point.ns = bent;
        let frame = Frame::around(point.ns);
        let wo = frame.to_local(-d);
        let surface_id = batch.hits.found.surface.load::<P>(at);
        ScatteringVertex {
            at,
            event,
            go: reflecting & wo.z.gt(zero),
            point,
            own_ns,
            bends,
            frame,
            wo,
            beta,
            params: arrival.material.params,
            material: batch.hits.material.load::<P>(at),
            surface_id: surface_left::<P>(surface_id, from_outside),
            slot: batch.paths.slot.load::<P>(at),
            role: arrival.role,
        }
    }

    /// Paths whose primary vertex this is.
    #[inline(always)]
    pub(super) fn primary(&self) -> P::Mask {
        self.role.primary & self.go
    }

    /// Where the primary vertices of these paths are kept: camera rays lie in the order of their places.
    #[inline(always)]
    pub(super) fn primary_slots(&self) -> Option<P::Bits> {
        (self.event > 0).then_some(self.slot)
    }
}

/// What directions are drawn with at the points.
pub(super) struct Scattering<P: SimdWide> {
    pub(super) brdf: Brdf<P>,
    /// Random numbers of the paths.
    pub(super) stream: Stream<P::Bits>,
    /// The number that chooses a lobe.
    pub(super) lobe_choice: P::Bits,
    /// Points as the lights see them.
    pub(super) context: LightSampleContext<P>,
    /// A reuse vertex has several viewers, each with a frame of his own; they have to agree on the
    /// densities of lights. So there this is around the surface's own normal, where that is bent.
    pub(super) agreed: Frame<P>,
    pub(super) bends: P::Mask,
}

impl Tracer {
    #[inline(always)]
    pub(super) fn scattering<P: SimdWide, M: Microfacet>(
        &self,
        batch: &PathBatch,
        vertex: &ScatteringVertex<P>,
    ) -> Scattering<P> {
        let ScatteringVertex { at, event, .. } = *vertex;
        let key = batch.paths.key.load::<P>(at);
        let stream = Stream::again(key, batch.paths.index.load::<P>(at));
        let brdf = vertex.params.at_wo::<M>(vertex.wo);
        let [lobe_choice, _] = stream.pair_bits(Slot::choice(event));
        let by_place = event == 0 && self.lights.choose_by_place();
        let bends = vertex.bends & vertex.role.reuse;
        let agreed = if bends.any() { Frame::around(vertex.own_ns) } else { vertex.frame };
        let (p, params, wo) = (vertex.point.p, &vertex.params, vertex.wo);
        let context = LightSampleContext::new(p, agreed, by_place, params, wo);
        Scattering { brdf, stream, lobe_choice, context, agreed, bends }
    }
}

/// The one colour or the other.
#[inline(always)]
pub(super) fn select<P: Simd>(mask: P::Mask, a: Rgb<P>, b: Rgb<P>) -> Rgb<P> {
    Rgb::new(P::select(mask, a.r, b.r), P::select(mask, a.g, b.g), P::select(mask, a.b, b.b))
}

/// Where nothing is left of a colour.
#[inline(always)]
pub(super) fn is_black<P: Simd>(c: Rgb<P>) -> P::Mask {
    let zero = P::splat(0.0);
    c.r.equal(zero) & c.g.equal(zero) & c.b.equal(zero)
}
