//! Scattering: the directions in which paths go on, or where they end.

use super::PathBatch;
use super::direct_light::SampledLight;
use super::state::RayBatch;
use super::vertex::{Scattering, ScatteringVertex, is_black, select};
use crate::brdf::{Brdf, LobeSample, Microfacet};
use crate::geometry::offset_origin;
use crate::math::simd::{Mask, SimdWide};
use crate::math::sobol::{Slot, pair, unit};
use crate::math::{Rgb, V3};
use crate::trace::highlights::{self, Image};
use crate::trace::lights::ALMOST_ONE;
use crate::trace::roulette::{self, survival};
use crate::trace::{THROUGHPUT_CAP, Tracer};

impl Tracer {
    /// Draws the directions in which the paths leave their points; the light that their rays hit counts
    /// `1 / split`. Paths that go on are put at the members of the batch from `going` on; returns their number.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(super) fn scatter<P: SimdWide, M: Microfacet>(
        &self,
        batch: &mut PathBatch,
        vertex: &ScatteringVertex<P>,
        scattering: &Scattering<P>,
        light: &SampledLight<P>,
        split: P,
        going: usize,
        images: &mut Vec<Image<P>>,
    ) -> usize {
        let &ScatteringVertex { at, event, go, ref point, ref role, surface_id, slot, .. } = vertex;
        let Scattering { brdf, stream, context, .. } = scattering;
        let u = pair::<P>(stream, Slot::direction(event));
        let primary = vertex.primary();
        let mut chance = P::splat(0.0);
        images.clear();
        if batch.shares {
            chance = self.highlights.seen_from(point.p, point.ns, primary, images);
        }
        let lobe_choice = unit::<P>(scattering.lobe_choice);
        let (next, d, pdf) = if images.is_empty() {
            let next = brdf.sample::<M>(lobe_choice, u);
            (next, vertex.frame.to_world(next.wi), next.pdf)
        } else {
            aim::<P, M>(vertex, brdf, (images, chance), lobe_choice, u)
        };
        let cos = next.wi.z;
        let scattered = next.f * (cos / pdf);
        let leaves = next.pdf.gt(P::splat(0.0)) & point.ng.dot(d).gt(P::splat(0.0));
        let beta = select(role.reuse, scattered, vertex.beta * scattered);
        let goes = go & leaves & !is_black(beta);
        if batch.shares && (event == 0 || primary.any()) {
            let slots = vertex.primary_slots();
            batch.primary.store_direction(at, slots, primary, pdf, scattered);
        }
        let (beta, goes) = play_roulette(vertex, scattering, beta, goes);
        let escapes = goes & beta.max_channel().gt(P::splat(THROUGHPUT_CAP));
        let mut goes = goes & !escapes;
        if escapes.any() {
            batch.capped += u64::from(escapes.bits().count_ones());
        }
        let cos = batch.keep_reuse_vertices(vertex, scattering, light, &next, (d, cos), goes);
        let o = offset_origin(point.p, point.error, point.ng, d);
        // At the last event only lights are of interest.
        if event + 1 == self.max_depth && goes.any() {
            goes = goes & self.lights.may_hit_emitter(o, d);
        }
        let ray = RayBatch {
            o,
            d,
            beta,
            pdf: next.pdf,
            mis_fraction: P::splat(1.0) / split,
            cos,
            context,
            surface_id,
            slot,
            lead: role.lead,
            stream,
        };
        batch.paths.push::<P>(going, goes, &ray, &self.lights, event)
    }
}

/// Draws directions from the BRDF or around highlights. Returns them in both frames, with the density of the BRDF,
/// which light sampling is weighed against, and that of both together.
#[inline(always)]
fn aim<P: SimdWide, M: Microfacet>(
    vertex: &ScatteringVertex<P>,
    brdf: &Brdf<P>,
    (images, chance): (&[Image<P>], P),
    choice: P,
    u: [P; 2],
) -> (LobeSample<P>, V3<P>, P) {
    let (zero, one) = (P::splat(0.0), P::splat(1.0));
    let aims = choice.lt(chance);
    let rest = (choice - chance) / (one - chance);
    let mut next = brdf.sample::<M>(rest.max(zero).min(P::splat(ALMOST_ONE)), u);
    let mut d = vertex.frame.to_world(next.wi);
    if aims.any() {
        d = V3::select(aims, highlights::sample(images, choice, u), d);
        next.wi = V3::select(aims, vertex.frame.to_local(d), next.wi);
        let e = brdf.eval::<M>(next.wi);
        next.f = select(aims, e.f, next.f);
        next.pdf = P::select(aims, e.pdf, next.pdf);
    }
    (next, d, (one - chance) * next.pdf + highlights::pdf(images, d))
}

/// Ends some of the paths that go on, and makes up for them in the throughputs of the others. Behind a
/// reuse vertex throughputs begin again.
#[inline(always)]
fn play_roulette<P: SimdWide>(
    vertex: &ScatteringVertex<P>,
    scattering: &Scattering<P>,
    mut beta: Rgb<P>,
    mut goes: P::Mask,
) -> (Rgb<P>, P::Mask) {
    let &ScatteringVertex { event, ref role, .. } = vertex;
    if event < roulette::FROM {
        return (beta, goes);
    }
    let one = P::splat(1.0);
    let survival = survival(event, beta.max_channel());
    // A primary vertex's direction has the density that others reckon with.
    let at_risk = goes & survival.lt(one) & !role.primary;
    let mut made_up = one;
    if at_risk.any() {
        let [u, _] = pair::<P>(&scattering.stream, Slot::roulette(event));
        let ended = at_risk & u.ge(survival);
        goes = goes & !ended;
        made_up = P::select(at_risk, one / survival, one);
        beta = beta * made_up;
    }
    if role.reuse.any() {
        beta = select(role.reuse, Rgb::splat(made_up), beta);
    }
    (beta, goes)
}

impl PathBatch {
    /// Keeps those of the points that are reuse vertices, with the light sampled there and the
    /// direction `d` at this cosine in which the paths that go on do so. Returns the cosine to the
    /// normal that the viewers of a point agree on.
    #[inline(always)]
    fn keep_reuse_vertices<P: SimdWide>(
        &mut self,
        vertex: &ScatteringVertex<P>,
        scattering: &Scattering<P>,
        light: &SampledLight<P>,
        next: &LobeSample<P>,
        (d, cos): (V3<P>, P),
        goes: P::Mask,
    ) -> P {
        let reuse = vertex.role.reuse & vertex.go;
        if !reuse.any() {
            return cos;
        }
        let Scattering { agreed, bends, .. } = scattering;
        let (mut wi, mut cos_agreed, mut point) = (next.wi, cos, vertex.point);
        if bends.any() {
            wi = V3::select(*bends, agreed.to_local(d), wi);
            cos_agreed = P::select(*bends, wi.z, cos);
            point.ns = vertex.own_ns;
        }
        let fs = [next.f, next.f * cos];
        let what = [vertex.material, vertex.surface_id];
        let directions = [(light.wi, light.pdf), (wi, next.pdf.or_zero(goes))];
        self.reuse.push::<P>(reuse, vertex.slot, &point, what, directions, fs, light.bsdf_pdf);
        cos_agreed
    }
}
