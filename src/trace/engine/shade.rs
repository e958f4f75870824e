//! What happens at a surface, for as many paths at a time as a register holds.

use super::further::FirstPoints;
use super::paths::Leaving;
use super::{Bundle, Sums, Tables, lowest};
use crate::brdf::Microfacet;
use crate::geometry::offset_origin;
use crate::math::lanes::{Lane, Mask, Packet};
use crate::math::sequence::{Slot, Stream, pair, unit};
use crate::math::{Frame, Rgb, V3};
use crate::trace::lights::Receiver;
use crate::trace::{THROUGHPUT_CAP, Tracer, power_heuristic, roulette};

impl Tracer {
    /// One scattering event of `count` paths: adds the light that they met, prepares the rays
    /// towards lights and the rays that go on, and returns the number of those. Where it is the
    /// `last` event nothing is prepared, and the number is that of the paths that would have gone
    /// on. Where paths are shared, what happens at the first two points is taken down for that, and
    /// light from beyond the second is counted as it arrives there.
    #[inline(always)]
    pub(super) fn shade<P: Packet, M: Microfacet>(
        &self,
        bundle: &mut Bundle,
        count: usize,
        event: u32,
        pass: u64,
        last: bool,
    ) -> usize {
        let zero = P::splat(0.0);
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let Tables { materials } = &self.tables;
        let lights = &self.lights;
        let asks = lights.count() > 0;
        let (is_first, is_second) = (bundle.shares && event == 0, bundle.shares && event == 1);
        let asked_lights = bundle.lights_asked(event);
        let mut going = 0;
        bundle.shadows.count = 0;
        for at in (0..count).step_by(P::WIDTH) {
            let live = P::mask(lowest(count - at));
            let met = bundle.met.surfaces::<P>(at);
            let material = materials.get::<P>(bundle.met.material.load::<P>(at));
            let d = bundle.paths.d.load::<P>(at);
            let beta = bundle.paths.beta.load_rgb::<P>(at);
            let hit = live & met.hit;
            let missed = live & !met.hit;
            if missed.any() {
                self.add_environment::<P>(bundle, at, missed, beta, event);
            }
            let emits = hit & material.emits;
            if emits.any() {
                let cos = met.point.ng.dot(d).abs();
                self.add_emission::<P>(bundle, at, emits, beta * material.emission, cos, event);
            }
            // The geometric normal decides the sides: both normals are turned to the viewer's, and the
            // shading normal is bent until he sees it.
            let mut point = met.point.turned_to(-d);
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
            let plate = bundle.met.plate.load::<P>(at);
            let what = [bundle.met.material.load::<P>(at), plate];
            if is_first {
                bundle.firsts.store(at, go, &point, -d, what);
            }
            if !go.any() {
                continue;
            }
            let slot = bundle.paths.slot.load::<P>(at);
            let key = bundle.paths.key.load::<P>(at);
            let stream = Stream::again(key, pass);
            let view = material.lobes.seen_from::<M>(wo);
            let [lobe_choice, _] = stream.pair_bits(Slot::choice(event));

            let first = event == 0 && lights.choose_by_place();
            // A second point has several viewers, each with a frame of his own; they have to agree on
            // the densities of lights.
            let bends = bends & P::mask(if is_second { u32::MAX } else { 0 });
            let agreed = if bends.any() { Frame::around(own) } else { frame };
            let receiver = Receiver::new(point.p, agreed, first, &material.lobes, wo);
            let mut looks = P::splat(1.0);
            if event == 0 {
                looks = self.lookers(&bundle.further, &material.lobes);
                let sharp = go & looks.gt(P::splat(1.0));
                if sharp.any() {
                    let (point, frame, view) = (&point, &frame, &view);
                    let receiver = &receiver;
                    let from = FirstPoints { point, frame, view, receiver, plate, slot, key };
                    let further = &mut bundle.further;
                    self.look_from_points::<P, M>(further, sharp, &from, beta, pass);
                }
            }
            let mut towards_light = (wo, zero);
            let count = if asks { asked_lights } else { 0 };
            for which in 0..count {
                let stream = stream.one_of(count, which, pass);
                let [_, light_choice] = stream.pair_bits(Slot::choice(event));
                let u = pair::<P>(&stream, Slot::light(event));
                let choice = unit::<P>(light_choice);
                let mut light = lights.sample::<P>(bvh, geometry, &receiver, choice, u);
                light.pdf = light.pdf * P::splat(count as f32);
                let wi = frame.to_local(light.wi);
                let mut above = M::cosine(point.ng.dot(light.wi)).gt(zero);
                // What is below the one viewer's normal may be above the other's.
                if !is_second {
                    above = above & M::cosine(wi.z).gt(zero);
                }
                let mut asked = go & light.found & above;
                if asked.any() {
                    let mut found = light.radiance;
                    let o = offset_origin(point.p, point.error, point.ng, light.wi);
                    let way = light.way_from(o);
                    asked = asked & way.meets;
                    if is_second {
                        let mut wi = wi;
                        if bends.any() {
                            wi = V3::select(bends, agreed.to_local(light.wi), wi);
                        }
                        towards_light = (wi, light.pdf.or_zero(asked));
                    } else {
                        let e = view.eval::<M>(wi);
                        let weight = power_heuristic(light.pdf, e.pdf);
                        found = beta * found * e.f * (M::cosine(wi.z) / light.pdf * weight);
                        asked = asked & !is_black(found);
                    }
                    let shadows = &mut bundle.shadows;
                    let end = shadows.count;
                    shadows.o.push::<P>(end, asked, o);
                    shadows.d.push::<P>(end, asked, way.d);
                    shadows.t_max.push::<P>(end, asked, way.t_max);
                    shadows.light.push_rgb::<P>(end, asked, found);
                    shadows.plates[0].push::<P>(end, asked, plate);
                    shadows.plates[1].push::<P>(end, asked, light.plate);
                    shadows.slot.push::<P>(end, asked, slot);
                    shadows.count += asked.bits().count_ones() as usize;
                }
            }

            let u = pair::<P>(&stream, Slot::direction(event));
            let next = view.sample::<M>(unit::<P>(lobe_choice), u);
            let d = frame.to_world(next.wi);
            let cos = M::cosine(next.wi.z);
            let scattered = next.f * (cos / next.pdf);
            let leaves = next.pdf.gt(zero) & M::cosine(point.ng.dot(d)).gt(zero);
            let mut beta = if is_second { scattered } else { beta * scattered };
            let mut goes = go & leaves & !is_black(beta);
            if is_first {
                bundle.firsts.store_direction(at, next.pdf, scattered);
            }
            if event >= roulette::FROM {
                let survival = roulette::survival(event, beta.max_channel());
                let one = P::splat(1.0);
                let at_risk = goes & survival.lt(one);
                if at_risk.any() {
                    let [u, _] = pair::<P>(&stream, Slot::roulette(event));
                    let ended = at_risk & u.ge(survival);
                    goes = goes & !ended;
                    let made_up = P::select(at_risk, one / survival, one);
                    beta = if is_second { Rgb::splat(made_up) } else { beta * made_up };
                } else if is_second {
                    beta = Rgb::splat(one);
                }
            }
            let escapes = goes & beta.max_channel().gt(P::splat(THROUGHPUT_CAP));
            if escapes.any() {
                bundle.capped += u64::from(escapes.bits().count_ones());
                goes = goes & !escapes;
            }
            let (mut wi, mut cos) = (next.wi, cos);
            if bends.any() {
                wi = V3::select(bends, agreed.to_local(d), wi);
                cos = P::select(bends, wi.z, cos);
                point.ns = own;
            }
            if is_second {
                let sampled = (wi, next.pdf.or_zero(goes));
                let ways = [towards_light, sampled];
                bundle.seconds.push::<P>(go, slot, &point, what, ways, next.f);
            }
            let o = offset_origin(point.p, point.error, point.ng, d);
            // At the last event only lights are of interest.
            if event + 1 == self.max_depth && goes.any() {
                goes = goes & lights.may_be_met(o, d);
            }
            let (pdf, part) = (next.pdf, P::splat(1.0) / looks);
            let way = Leaving { o, d, beta, pdf, part, cos, receiver: &receiver, plate, slot, key };
            going += bundle.paths.push::<P>(going, goes, &way, lights, event);
        }
        going
    }

    /// What comes from beyond the scene, to the paths that met nothing.
    #[inline(always)]
    fn add_environment<P: Packet>(
        &self,
        bundle: &mut Bundle,
        at: usize,
        missed: P::Mask,
        beta: Rgb<P>,
        event: u32,
    ) {
        let environment = self.lights.environment();
        if environment.is_black() {
            return;
        }
        let mut light = beta * environment.splat_lanes();
        if event > 0 {
            let from = bundle.paths.from.load::<P>(at, &self.lights, event - 1);
            let other = self.lights.environment_pdf(&from, bundle.paths.cos.load::<P>(at))
                * P::splat(bundle.lights_asked(event - 1) as f32);
            if bundle.shares && event == 2 {
                return bundle.keep_emitted::<P>(at, missed.bits(), light, other);
            }
            light = light * power_heuristic(bundle.paths.pdf.load::<P>(at), other);
        }
        light = bundle.part_of(at, light, event);
        let sums = bundle.met_at(event);
        bundle.add::<P>(at, missed.bits(), light, sums);
    }

    /// What the surfaces met give off themselves, at this cosine to the rays.
    #[inline(always)]
    fn add_emission<P: Packet>(
        &self,
        bundle: &mut Bundle,
        at: usize,
        emits: P::Mask,
        mut light: Rgb<P>,
        cos: P,
        event: u32,
    ) {
        let lanes = emits.bits();
        if event > 0 {
            let (mut other, mut cosine) = ([0.0; 16], [0.0; 16]);
            cos.store(&mut cosine);
            for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
                let from = bundle.paths.from.get(at + lane, &self.lights, event - 1);
                let (primitive, t) = (bundle.met.primitive.0[at + lane], bundle.met.t.0[at + lane]);
                other[lane] = self.lights.pdf(&from, primitive, t, cosine[lane]);
            }
            let other = P::load(&other) * P::splat(bundle.lights_asked(event - 1) as f32);
            if bundle.shares && event == 2 {
                return bundle.keep_emitted::<P>(at, lanes, light, other);
            }
            light = light * power_heuristic(bundle.paths.pdf.load::<P>(at), other);
        }
        light = bundle.part_of(at, light, event);
        let sums = bundle.met_at(event);
        bundle.add::<P>(at, lanes, light, sums);
    }
}

impl Bundle {
    /// Adds light to the paths in these lanes from place `at` on.
    #[inline(always)]
    fn add<P: Packet>(&mut self, at: usize, lanes: u32, light: Rgb<P>, sums: Sums) {
        let slots = self.paths.slot.0[at..at + P::WIDTH].iter().enumerate();
        let sums = match sums {
            Sums::Radiance => &mut self.radiance,
            Sums::Asked => &mut self.seconds.light,
            Sums::Reflected => &mut self.seconds.reflected,
        };
        let channels = store(light);
        for (lane, slot) in slots.filter(|(lane, _)| lanes >> lane & 1 != 0) {
            for (sum, channel) in sums[*slot as usize].iter_mut().zip(&channels) {
                *sum += channel[lane];
            }
        }
    }

    /// What rays have of light that they met, where further ones have looked as well.
    #[inline(always)]
    fn part_of<P: Packet>(&self, at: usize, light: Rgb<P>, event: u32) -> Rgb<P> {
        if event > 1 { light } else { light * self.paths.part.load::<P>(at) }
    }

    /// Keeps light that was met from second points, with the density that asking has for it.
    #[inline(always)]
    fn keep_emitted<P: Packet>(&mut self, at: usize, lanes: u32, light: Rgb<P>, pdf: P) {
        let (channels, mut pdfs) = (store(light), [0.0; 16]);
        pdf.store(&mut pdfs);
        for lane in (0..P::WIDTH).filter(|lane| lanes >> lane & 1 != 0) {
            let slot = self.paths.slot.0[at + lane] as usize;
            self.seconds.emitted[slot] = channels.map(|channel| channel[lane]);
            self.seconds.emitted_pdf[slot] = pdfs[lane];
        }
    }
}

#[inline(always)]
fn store<P: Packet>(light: Rgb<P>) -> [[f32; 16]; 3] {
    let mut channels = [[0.0; 16]; 3];
    light.r.store(&mut channels[0]);
    light.g.store(&mut channels[1]);
    light.b.store(&mut channels[2]);
    channels
}

#[inline(always)]
pub(super) fn is_black<P: Lane>(c: Rgb<P>) -> P::Mask {
    let zero = P::splat(0.0);
    c.r.equal(zero) & c.g.equal(zero) & c.b.equal(zero)
}
