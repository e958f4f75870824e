//! What happens at a surface, for as many paths at a time as a register holds.

use super::emitter_splitting::PrimaryPoints;
use super::reuse::OwnTerms;
use super::state::RayBatch;
use super::{FROM_LIGHT, PathBatch, REFLECTED, Tables};
use crate::brdf::Microfacet;
use crate::geometry::{offset_origin, surface_left};
use crate::math::simd::{Bits, Mask, Simd, SimdWide, first_lanes};
use crate::math::sobol::{Slot, Stream, pair, unit};
use crate::math::{Frame, Rgb, V3};
use crate::trace::lights::LightSampleContext;
use crate::trace::{THROUGHPUT_CAP, Tracer, power_heuristic, roulette};

impl Tracer {
    /// One scattering event of `count` paths: adds the light that they hit, prepares the rays
    /// towards lights and the rays that go on, and returns the number of those. Where it is the
    /// `last` event nothing is prepared, and the number is that of the paths that would have gone
    /// on. Where paths are shared, what happens at the first two points is taken down for that, and
    /// light from beyond the second is counted as it arrives there.
    #[inline(always)]
    pub(super) fn shade<P: SimdWide, M: Microfacet>(
        &self,
        batch: &mut PathBatch,
        count: usize,
        event: u32,
        last: bool,
    ) -> usize {
        let zero = P::splat(0.0);
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let Tables { materials } = &self.tables;
        let lights = &self.lights;
        let has_lights = lights.count() > 0;
        let light_count = batch.light_samples(event);
        let mut going = 0;
        batch.shadows.count = 0;
        for at in (0..count).step_by(P::WIDTH) {
            let live = P::mask(first_lanes(count - at));
            let surfaces = batch.hits.surfaces::<P>(at);
            let material = materials.get::<P>(batch.hits.material.load::<P>(at));
            let d = batch.paths.d.load::<P>(at);
            let beta = batch.paths.beta.load_rgb::<P>(at);
            let hit = live & surfaces.hit;
            let missed = live & !surfaces.hit;
            let lead = batch.paths.lead.load::<P>(at);
            let role = ReuseRole::<P>::of(batch.shares, lead, event, material.mirror);
            if missed.any() {
                self.add_environment::<P>(batch, at, missed, beta, event, &role);
            }
            let emits = hit & material.emits;
            if emits.any() {
                let cos = surfaces.point.ng.dot(d).abs();
                let light = beta * material.emission;
                self.add_emission::<P>(batch, at, emits, light, cos, event, &role);
            }
            // The geometric normal decides the sides: both normals are turned to the viewer's, and the
            // shading normal is bent until he sees it.
            // What is left outwards, or is a large quad, is not hit again.
            let from_outside = surfaces.point.ng.dot(d).lt(zero);
            let mut point = surfaces.point.turned_to(-d);
            let own = point.ns;
            let (bent, bends) = point.normal_for(-d);
            point.ns = bent;
            let frame = Frame::around(point.ns);
            let wo = frame.to_local(-d);
            let go = hit & material.reflects & wo.z.gt(zero);
            if last {
                going += (hit & material.reflects).bits().count_ones() as usize;
                continue;
            }
            let surface_id = batch.hits.found.surface.load::<P>(at);
            let surface_id = surface_left::<P>(surface_id, from_outside);
            let what = [batch.hits.material.load::<P>(at), surface_id];
            let slot = batch.paths.slot.load::<P>(at);
            let primary = role.first & go;
            if batch.shares && (event == 0 || primary.any()) {
                // Camera rays lie in the order of their places.
                let slots = (event > 0).then_some(slot);
                let [material, surface_id] = what;
                let what = [material, surface_id, role.lead];
                batch.primary.store(at, slots, primary, &point, -d, beta, what);
            }
            if !go.any() {
                continue;
            }
            let key = batch.paths.key.load::<P>(at);
            let stream = Stream::again(key, batch.paths.index.load::<P>(at));
            let brdf = material.params.at_wo::<M>(wo);
            let [lobe_choice, _] = stream.pair_bits(Slot::choice(event));

            let first = event == 0 && lights.choose_by_place();
            // A reuse vertex has several viewers, each with a frame of his own; they have to agree on
            // the densities of lights.
            let bends = bends & role.second;
            let agreed = if bends.any() { Frame::around(own) } else { frame };
            let context = LightSampleContext::new(point.p, agreed, first, &material.params, wo);
            let mut split = P::splat(1.0);
            if event == 0 {
                split = self.split_count(&batch.split_rays, &material.params);
                let sharp = go & split.gt(P::splat(1.0));
                if sharp.any() {
                    let (point, frame, brdf) = (&point, &frame, &brdf);
                    let (context, stream) = (&context, &stream);
                    let from =
                        PrimaryPoints { point, frame, brdf, context, surface_id, slot, stream };
                    let split_rays = &mut batch.split_rays;
                    self.split_at_points::<P, M>(split_rays, sharp, &from, beta);
                }
            }
            let mut towards_light = (wo, zero);
            let mut own_light = Rgb::splat(zero);
            let mut own_light_pdf = zero;
            let count = if has_lights { light_count } else { 0 };
            for which in 0..count {
                let stream = stream.one_of(count, which);
                let [_, light_choice] = stream.pair_bits(Slot::choice(event));
                let u = pair::<P>(&stream, Slot::light(event));
                let choice = unit::<P>(light_choice);
                let mut light = lights.sample::<P>(bvh, geometry, &context, choice, u);
                light.pdf = light.pdf * P::splat(count as f32);
                let wi = frame.to_local(light.wi);
                // What is below the one viewer's normal may be above the other's.
                let above = M::cosine(point.ng.dot(light.wi)).gt(zero)
                    & (M::cosine(wi.z).gt(zero) | role.second);
                let mut traced = go & light.found & above;
                if traced.any() {
                    let o = offset_origin(point.p, point.error, point.ng, light.wi);
                    let way = light.shadow_ray(o);
                    traced = traced & way.hits;
                    let e = brdf.eval::<M>(wi);
                    let weight = power_heuristic(light.pdf, e.pdf);
                    let reflected =
                        beta * light.radiance * e.f * (M::cosine(wi.z) / light.pdf * weight);
                    if role.second.any() {
                        let mut wi = wi;
                        if bends.any() {
                            wi = V3::select(bends, agreed.to_local(light.wi), wi);
                        }
                        towards_light = (wi, light.pdf.or_zero(traced));
                        // What the path itself makes of it, wherever a lobe is not shared.
                        own_light = e.f * M::cosine(frame.to_local(light.wi).z);
                        own_light_pdf = e.pdf;
                    }
                    traced = traced & (role.second | !is_black(reflected));
                    let found = select(role.second, light.radiance, reflected);
                    let shadows = &mut batch.shadows;
                    let end = shadows.count;
                    shadows.o.push::<P>(end, traced, o);
                    shadows.d.push::<P>(end, traced, way.d);
                    shadows.t_max.push::<P>(end, traced, way.t_max);
                    shadows.light.push_rgb::<P>(end, traced, found);
                    shadows.surface_ids[0].push::<P>(end, traced, surface_id);
                    shadows.surface_ids[1].push::<P>(end, traced, light.surface_id);
                    shadows.slot.push::<P>(end, traced, slot + role.light_sum);
                    shadows.count += traced.bits().count_ones() as usize;
                }
            }

            let u = pair::<P>(&stream, Slot::direction(event));
            let next = brdf.sample::<M>(unit::<P>(lobe_choice), u);
            let d = frame.to_world(next.wi);
            let cos = M::cosine(next.wi.z);
            let scattered = next.f * (cos / next.pdf);
            let leaves = next.pdf.gt(zero) & M::cosine(point.ng.dot(d)).gt(zero);
            let mut beta = select(role.second, scattered, beta * scattered);
            let mut goes = go & leaves & !is_black(beta);
            if batch.shares && (event == 0 || primary.any()) {
                let slots = (event > 0).then_some(slot);
                batch.primary.store_direction(at, slots, primary, [next.pdf, cos], scattered);
            }
            if event >= roulette::FROM {
                let survival = roulette::survival(event, beta.max_channel());
                let one = P::splat(1.0);
                // A primary vertex's direction has the density that others reckon with.
                let at_risk = goes & survival.lt(one) & !role.first;
                let mut made_up = one;
                if at_risk.any() {
                    let [u, _] = pair::<P>(&stream, Slot::roulette(event));
                    let ended = at_risk & u.ge(survival);
                    goes = goes & !ended;
                    made_up = P::select(at_risk, one / survival, one);
                    beta = beta * made_up;
                }
                if role.second.any() {
                    beta = select(role.second, Rgb::splat(made_up), beta);
                }
            }
            let escapes = goes & beta.max_channel().gt(P::splat(THROUGHPUT_CAP));
            if escapes.any() {
                batch.capped += u64::from(escapes.bits().count_ones());
                goes = goes & !escapes;
            }
            let own_cos = cos;
            let (mut wi, mut cos) = (next.wi, cos);
            if bends.any() {
                wi = V3::select(bends, agreed.to_local(d), wi);
                cos = P::select(bends, wi.z, cos);
                point.ns = own;
            }
            let reuse = role.second & go;
            if reuse.any() {
                let bsdf_dir = (wi, next.pdf.or_zero(goes));
                let ways = [towards_light, bsdf_dir];
                let own = OwnTerms {
                    light_dir: own_light,
                    light_pdf: own_light_pdf,
                    bsdf_dir: next.f * own_cos,
                };
                batch.reuse.push::<P>(reuse, slot, &point, what, ways, next.f, &own);
            }
            let o = offset_origin(point.p, point.error, point.ng, d);
            // At the last event only lights are of interest.
            if event + 1 == self.max_depth && goes.any() {
                goes = goes & lights.may_hit_emitter(o, d);
            }
            let (pdf, mis_fraction) = (next.pdf, P::splat(1.0) / split);
            let (context, stream) = (&context, &stream);
            let lead = role.lead;
            let way = RayBatch {
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
            going += batch.paths.push::<P>(going, goes, &way, lights, event);
        }
        going
    }

    /// What comes from beyond the scene, to the paths that hit nothing.
    #[inline(always)]
    fn add_environment<P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        at: usize,
        missed: P::Mask,
        beta: Rgb<P>,
        event: u32,
        role: &ReuseRole<P>,
    ) {
        let environment = self.lights.environment();
        if environment.is_black() {
            return;
        }
        let mut light = beta * environment.splat_lanes();
        if event > 0 {
            let from = batch.paths.from.load::<P>(at, &self.lights, event - 1);
            let other = self.lights.environment_pdf(&from, batch.paths.cos.load::<P>(at))
                * P::splat(batch.light_samples(event - 1) as f32);
            batch.keep_emitted::<P>(at, (missed & role.third).bits(), light, other);
            light = light * power_heuristic(batch.paths.pdf.load::<P>(at), other);
        }
        light = batch.mis_weighted(at, light, event);
        batch.add::<P>(at, missed, light, role);
    }

    /// What the surfaces hit give off themselves, at this cosine to the rays.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn add_emission<P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        at: usize,
        emits: P::Mask,
        mut light: Rgb<P>,
        cos: P,
        event: u32,
        role: &ReuseRole<P>,
    ) {
        let lanes = emits.bits();
        if event > 0 {
            let (mut other, mut cosine) = ([0.0; 16], [0.0; 16]);
            cos.store(&mut cosine);
            for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
                let from = batch.paths.from.get(at + lane, &self.lights, event - 1);
                let (primitive, t) =
                    (batch.hits.found.primitive.0[at + lane], batch.hits.found.t.0[at + lane]);
                other[lane] = self.lights.pdf(&from, primitive, t, cosine[lane]);
            }
            let other = P::load(&other) * P::splat(batch.light_samples(event - 1) as f32);
            batch.keep_emitted::<P>(at, (emits & role.third).bits(), light, other);
            light = light * power_heuristic(batch.paths.pdf.load::<P>(at), other);
        }
        light = batch.mis_weighted(at, light, event);
        batch.add::<P>(at, emits, light, role);
    }
}

/// What the present point is to each path, where paths share.
struct ReuseRole<P: SimdWide> {
    /// The first that is shared, the second, the third, or one after that.
    first: P::Mask,
    second: P::Mask,
    third: P::Mask,
    later: P::Mask,
    /// Mirrors before the primary vertex, this one included.
    lead: P::Bits,
    /// The sum that light belongs to that is sampled here, shifted as in the array of slots.
    light_sum: P::Bits,
}

/// Most mirrors that a path goes through before the point that is its first.
const MOST_MIRRORS: u32 = 2;

impl<P: SimdWide> ReuseRole<P> {
    #[inline(always)]
    fn of(shares: bool, lead: P::Bits, event: u32, mirror: P::Mask) -> ReuseRole<P> {
        let (none, zero) = (P::mask(0), P::Bits::splat(0));
        if !shares {
            return ReuseRole {
                first: none,
                second: none,
                third: none,
                later: none,
                lead,
                light_sum: zero,
            };
        }
        let at_front = P::equal_bits(lead, P::Bits::splat(event));
        let passes = at_front & mirror & P::mask(if event < MOST_MIRRORS { u32::MAX } else { 0 });
        // No path has a lead of all ones, which these are where there is no such event.
        let second = P::equal_bits(lead, P::Bits::splat(event.wrapping_sub(1)));
        let third = P::equal_bits(lead, P::Bits::splat(event.wrapping_sub(2)));
        let later = !(at_front | second | third);
        let one = P::Bits::splat(1);
        let (from_light, reflected) =
            (P::Bits::splat(FROM_LIGHT << 16), P::Bits::splat(REFLECTED << 16));
        let after = P::select_bits(third | later, reflected, zero);
        ReuseRole {
            first: at_front & !passes,
            second,
            third,
            later,
            lead: P::select_bits(passes, lead + one, lead),
            light_sum: P::select_bits(second, from_light, after),
        }
    }
}

impl PathBatch {
    /// Adds light that was hit to the paths in these lanes from place `at` on, but for light that is
    /// kept.
    #[inline(always)]
    fn add<P: SimdWide>(&mut self, at: usize, lanes: P::Mask, light: Rgb<P>, role: &ReuseRole<P>) {
        let (lanes, late) = ((lanes & !role.third).bits(), role.later.bits());
        let slots = self.paths.slot.0[at..at + P::WIDTH].iter().enumerate();
        let channels = store(light);
        for (lane, slot) in slots.filter(|(lane, _)| lanes >> lane & 1 != 0) {
            let reflected = late >> lane & 1 != 0;
            let sums = if reflected { &mut self.reuse.reflected } else { &mut self.radiance };
            for (sum, channel) in sums[*slot as usize].iter_mut().zip(&channels) {
                *sum += channel[lane];
            }
        }
    }

    /// What rays have of light that they hit, where split rays have looked as well.
    #[inline(always)]
    fn mis_weighted<P: SimdWide>(&self, at: usize, light: Rgb<P>, event: u32) -> Rgb<P> {
        if event > 1 { light } else { light * self.paths.mis_fraction.load::<P>(at) }
    }

    /// Keeps light that was hit from reuse vertices, with the density that light sampling has for it.
    #[inline(always)]
    fn keep_emitted<P: SimdWide>(&mut self, at: usize, lanes: u32, light: Rgb<P>, pdf: P) {
        let (channels, mut pdfs) = (store(light), [0.0; 16]);
        pdf.store(&mut pdfs);
        for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
            let slot = self.paths.slot.0[at + lane] as usize;
            self.reuse.emitted[slot] = channels.map(|channel| channel[lane]);
            self.reuse.emitted_pdf[slot] = pdfs[lane];
        }
    }
}

#[inline(always)]
fn store<P: SimdWide>(light: Rgb<P>) -> [[f32; 16]; 3] {
    let mut channels = [[0.0; 16]; 3];
    light.r.store(&mut channels[0]);
    light.g.store(&mut channels[1]);
    light.b.store(&mut channels[2]);
    channels
}

#[inline(always)]
fn select<P: Simd>(mask: P::Mask, a: Rgb<P>, b: Rgb<P>) -> Rgb<P> {
    Rgb::new(P::select(mask, a.r, b.r), P::select(mask, a.g, b.g), P::select(mask, a.b, b.b))
}

#[inline(always)]
pub(super) fn is_black<P: Simd>(c: Rgb<P>) -> P::Mask {
    let zero = P::splat(0.0);
    c.r.equal(zero) & c.g.equal(zero) & c.b.equal(zero)
}
