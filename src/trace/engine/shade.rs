//! What happens at a surface, for as many paths at a time as a register holds.

use super::further::FirstPoints;
use super::paths::Leaving;
use super::reuse::Own;
use super::{ASKED, Bundle, REFLECTED, Tables, lowest};
use crate::brdf::Microfacet;
use crate::geometry::{MOST_PLATES, NO_PLATE, offset_origin};
use crate::math::lanes::{Bits, Lane, Mask, Packet};
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
        last: bool,
    ) -> usize {
        let zero = P::splat(0.0);
        let (bvh, geometry) = (self.scene.bvh(), self.scene.geometry());
        let Tables { materials } = &self.tables;
        let lights = &self.lights;
        let asks = lights.count() > 0;
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
            let lead = bundle.paths.lead.load::<P>(at);
            let role = Role::<P>::of(bundle.shares, lead, event, material.mirror);
            if missed.any() {
                self.add_environment::<P>(bundle, at, missed, beta, event, &role);
            }
            let emits = hit & material.emits;
            if emits.any() {
                let cos = met.point.ng.dot(d).abs();
                let light = beta * material.emission;
                self.add_emission::<P>(bundle, at, emits, light, cos, event, &role);
            }
            // The geometric normal decides the sides: both normals are turned to the viewer's, and the
            // shading normal is bent until he sees it.
            // What is left outwards, or is a plate, is not met again.
            let from_outside = met.point.ng.dot(d).lt(zero);
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
            let known = from_outside | P::less_bits(plate, P::Bits::splat(MOST_PLATES as u32));
            let plate = P::select_bits(known, plate, P::Bits::splat(NO_PLATE));
            let what = [bundle.met.material.load::<P>(at), plate];
            let slot = bundle.paths.slot.load::<P>(at);
            let firsts = role.first & go;
            if bundle.shares && (event == 0 || firsts.any()) {
                // Camera rays lie in the order of their places.
                let slots = (event > 0).then_some(slot);
                let [material, plate] = what;
                let what = [material, plate, role.lead];
                bundle.firsts.store(at, slots, firsts, &point, -d, beta, what);
            }
            if !go.any() {
                continue;
            }
            let key = bundle.paths.key.load::<P>(at);
            let stream = Stream::again(key, bundle.paths.index.load::<P>(at));
            let view = material.lobes.seen_from::<M>(wo);
            let [lobe_choice, _] = stream.pair_bits(Slot::choice(event));

            let first = event == 0 && lights.choose_by_place();
            // A second point has several viewers, each with a frame of his own; they have to agree on
            // the densities of lights.
            let bends = bends & role.second;
            let agreed = if bends.any() { Frame::around(own) } else { frame };
            let receiver = Receiver::new(point.p, agreed, first, &material.lobes, wo);
            let mut looks = P::splat(1.0);
            if event == 0 {
                looks = self.lookers(&bundle.further, &material.lobes);
                let sharp = go & looks.gt(P::splat(1.0));
                if sharp.any() {
                    let (point, frame, view) = (&point, &frame, &view);
                    let (receiver, stream) = (&receiver, &stream);
                    let from = FirstPoints { point, frame, view, receiver, plate, slot, stream };
                    let further = &mut bundle.further;
                    self.look_from_points::<P, M>(further, sharp, &from, beta);
                }
            }
            let mut towards_light = (wo, zero);
            let mut as_seen = Rgb::splat(zero);
            let mut seen_pdf = zero;
            let count = if asks { asked_lights } else { 0 };
            for which in 0..count {
                let stream = stream.one_of(count, which);
                let [_, light_choice] = stream.pair_bits(Slot::choice(event));
                let u = pair::<P>(&stream, Slot::light(event));
                let choice = unit::<P>(light_choice);
                let mut light = lights.sample::<P>(bvh, geometry, &receiver, choice, u);
                light.pdf = light.pdf * P::splat(count as f32);
                let wi = frame.to_local(light.wi);
                // What is below the one viewer's normal may be above the other's.
                let above = M::cosine(point.ng.dot(light.wi)).gt(zero)
                    & (M::cosine(wi.z).gt(zero) | role.second);
                let mut asked = go & light.found & above;
                if asked.any() {
                    let o = offset_origin(point.p, point.error, point.ng, light.wi);
                    let way = light.way_from(o);
                    asked = asked & way.meets;
                    let e = view.eval::<M>(wi);
                    let weight = power_heuristic(light.pdf, e.pdf);
                    let reflected =
                        beta * light.radiance * e.f * (M::cosine(wi.z) / light.pdf * weight);
                    if role.second.any() {
                        let mut wi = wi;
                        if bends.any() {
                            wi = V3::select(bends, agreed.to_local(light.wi), wi);
                        }
                        towards_light = (wi, light.pdf.or_zero(asked));
                        // What the path itself makes of it, wherever a lobe is not shared.
                        as_seen = e.f * M::cosine(frame.to_local(light.wi).z);
                        seen_pdf = e.pdf;
                    }
                    asked = asked & (role.second | !is_black(reflected));
                    let found = select(role.second, light.radiance, reflected);
                    let shadows = &mut bundle.shadows;
                    let end = shadows.count;
                    shadows.o.push::<P>(end, asked, o);
                    shadows.d.push::<P>(end, asked, way.d);
                    shadows.t_max.push::<P>(end, asked, way.t_max);
                    shadows.light.push_rgb::<P>(end, asked, found);
                    shadows.plates[0].push::<P>(end, asked, plate);
                    shadows.plates[1].push::<P>(end, asked, light.plate);
                    shadows.slot.push::<P>(end, asked, slot + role.asked);
                    shadows.count += asked.bits().count_ones() as usize;
                }
            }

            let u = pair::<P>(&stream, Slot::direction(event));
            let next = view.sample::<M>(unit::<P>(lobe_choice), u);
            let d = frame.to_world(next.wi);
            let cos = M::cosine(next.wi.z);
            let scattered = next.f * (cos / next.pdf);
            let leaves = next.pdf.gt(zero) & M::cosine(point.ng.dot(d)).gt(zero);
            let mut beta = select(role.second, scattered, beta * scattered);
            let mut goes = go & leaves & !is_black(beta);
            if bundle.shares && (event == 0 || firsts.any()) {
                let slots = (event > 0).then_some(slot);
                bundle.firsts.store_direction(at, slots, firsts, [next.pdf, cos], scattered);
            }
            if event >= roulette::FROM {
                let survival = roulette::survival(event, beta.max_channel());
                let one = P::splat(1.0);
                // A first point's direction has the density that others reckon with.
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
                bundle.capped += u64::from(escapes.bits().count_ones());
                goes = goes & !escapes;
            }
            let own_cos = cos;
            let (mut wi, mut cos) = (next.wi, cos);
            if bends.any() {
                wi = V3::select(bends, agreed.to_local(d), wi);
                cos = P::select(bends, wi.z, cos);
                point.ns = own;
            }
            let seconds = role.second & go;
            if seconds.any() {
                let sampled = (wi, next.pdf.or_zero(goes));
                let ways = [towards_light, sampled];
                let own = Own { asked: as_seen, asked_pdf: seen_pdf, sampled: next.f * own_cos };
                bundle.seconds.push::<P>(seconds, slot, &point, what, ways, next.f, &own);
            }
            let o = offset_origin(point.p, point.error, point.ng, d);
            // At the last event only lights are of interest.
            if event + 1 == self.max_depth && goes.any() {
                goes = goes & lights.may_be_met(o, d);
            }
            let (pdf, part) = (next.pdf, P::splat(1.0) / looks);
            let (receiver, stream) = (&receiver, &stream);
            let lead = role.lead;
            let way = Leaving { o, d, beta, pdf, part, cos, receiver, plate, slot, lead, stream };
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
        role: &Role<P>,
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
            bundle.keep_emitted::<P>(at, (missed & role.third).bits(), light, other);
            light = light * power_heuristic(bundle.paths.pdf.load::<P>(at), other);
        }
        light = bundle.part_of(at, light, event);
        bundle.add::<P>(at, missed, light, role);
    }

    /// What the surfaces met give off themselves, at this cosine to the rays.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn add_emission<P: Packet>(
        &self,
        bundle: &mut Bundle,
        at: usize,
        emits: P::Mask,
        mut light: Rgb<P>,
        cos: P,
        event: u32,
        role: &Role<P>,
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
            bundle.keep_emitted::<P>(at, (emits & role.third).bits(), light, other);
            light = light * power_heuristic(bundle.paths.pdf.load::<P>(at), other);
        }
        light = bundle.part_of(at, light, event);
        bundle.add::<P>(at, emits, light, role);
    }
}

/// What the present point is to each path, where paths share.
struct Role<P: Packet> {
    /// The first that is shared, the second, the third, or one after that.
    first: P::Mask,
    second: P::Mask,
    third: P::Mask,
    later: P::Mask,
    /// Mirrors before the first point, this one included.
    lead: P::Bits,
    /// The sum that light belongs to which is asked for here, shifted as in the column of slots.
    asked: P::Bits,
}

/// Most mirrors that a path goes through before the point that is its first.
const MOST_MIRRORS: u32 = 2;

impl<P: Packet> Role<P> {
    #[inline(always)]
    fn of(shares: bool, lead: P::Bits, event: u32, mirror: P::Mask) -> Role<P> {
        let (none, zero) = (P::mask(0), P::Bits::splat(0));
        if !shares {
            return Role { first: none, second: none, third: none, later: none, lead, asked: zero };
        }
        let at_front = P::equal_bits(lead, P::Bits::splat(event));
        let passes = at_front & mirror & P::mask(if event < MOST_MIRRORS { u32::MAX } else { 0 });
        // No path has a lead of all ones, which these are where there is no such event.
        let second = P::equal_bits(lead, P::Bits::splat(event.wrapping_sub(1)));
        let third = P::equal_bits(lead, P::Bits::splat(event.wrapping_sub(2)));
        let later = !(at_front | second | third);
        let one = P::Bits::splat(1);
        let (asked, reflected) = (P::Bits::splat(ASKED << 16), P::Bits::splat(REFLECTED << 16));
        let after = P::select_bits(third | later, reflected, zero);
        Role {
            first: at_front & !passes,
            second,
            third,
            later,
            lead: P::select_bits(passes, lead + one, lead),
            asked: P::select_bits(second, asked, after),
        }
    }
}

impl Bundle {
    /// Adds light that was met to the paths in these lanes from place `at` on, but for light that is
    /// kept.
    #[inline(always)]
    fn add<P: Packet>(&mut self, at: usize, lanes: P::Mask, light: Rgb<P>, role: &Role<P>) {
        let (lanes, late) = ((lanes & !role.third).bits(), role.later.bits());
        let slots = self.paths.slot.0[at..at + P::WIDTH].iter().enumerate();
        let channels = store(light);
        for (lane, slot) in slots.filter(|(lane, _)| lanes >> lane & 1 != 0) {
            let reflected = late >> lane & 1 != 0;
            let sums = if reflected { &mut self.seconds.reflected } else { &mut self.radiance };
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
fn select<P: Lane>(mask: P::Mask, a: Rgb<P>, b: Rgb<P>) -> Rgb<P> {
    Rgb::new(P::select(mask, a.r, b.r), P::select(mask, a.g, b.g), P::select(mask, a.b, b.b))
}

#[inline(always)]
pub(super) fn is_black<P: Lane>(c: Rgb<P>) -> P::Mask {
    let zero = P::splat(0.0);
    c.r.equal(zero) & c.g.equal(zero) & c.b.equal(zero)
}
