//! Emission: light that rays have hit, weighed against light sampling.

use super::PathBatch;
use super::light_sums::{LightSum, ReuseRole};
use super::vertex::Arrival;
use crate::math::Rgb;
use crate::math::simd::{Kernel, MAX_WIDTH, Mask, Simd8, SimdWide, each_lane};
use crate::trace::{Tracer, power_heuristic};

/// Adds the light that the first `count` paths have hit, at their last event.
pub(super) struct AddEmission<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) batch: &'a mut PathBatch,
    pub(super) count: usize,
    pub(super) event: u32,
}

impl Kernel for AddEmission<'_> {
    /// Number of paths that would have gone on.
    type Output = usize;
    #[inline(always)]
    fn run<W: Simd8, P: SimdWide>(self) -> usize {
        let AddEmission { tracer, batch, count, event } = self;
        let mut going = 0;
        for at in (0..count).step_by(P::WIDTH) {
            let arrival = Arrival::<P>::load(batch, &tracer.tables, at, count, event);
            tracer.add_emission(batch, &arrival);
            going += arrival.reflecting().bits().count_ones() as usize;
        }
        going
    }
}

impl Tracer {
    /// Adds what the paths have hit of the surroundings and of emitters.
    #[inline(always)]
    pub(super) fn add_emission<P: SimdWide>(&self, batch: &mut PathBatch, arrival: &Arrival<P>) {
        let Arrival { d, beta, hit, missed, material, point, .. } = arrival;
        if missed.any() {
            self.add_environment(batch, arrival);
        }
        let emits = *hit & material.emits;
        if emits.any() {
            let cos = point.ng.dot(*d).abs();
            self.add_emitters(batch, arrival, emits, *beta * material.emission, cos);
        }
    }

    /// What comes from beyond the scene, to the paths that hit nothing.
    #[inline(always)]
    fn add_environment<P: SimdWide>(&self, batch: &mut PathBatch, arrival: &Arrival<P>) {
        let environment = self.lights.environment();
        if environment.is_black() {
            return;
        }
        let &Arrival { at, event, missed, .. } = arrival;
        let mut light = arrival.beta * environment.splat_lanes();
        if event > 0 {
            let from = batch.paths.from.load::<P>(at, &self.lights, event - 1);
            let other = self.lights.environment_pdf(&from, batch.paths.cos.load::<P>(at))
                * P::splat(batch.light_samples(event - 1) as f32);
            batch.keep_emitted::<P>(at, (missed & arrival.role.after).bits(), light, other);
            light = light * power_heuristic(batch.paths.pdf.load::<P>(at), other);
        }
        light = batch.mis_weighted(at, light, event);
        batch.add(at, missed, light, &arrival.role);
    }

    /// What the surfaces hit give off themselves, at this cosine to the rays.
    #[inline(always)]
    fn add_emitters<P: SimdWide>(
        &self,
        batch: &mut PathBatch,
        arrival: &Arrival<P>,
        emits: P::Mask,
        mut light: Rgb<P>,
        cos: P,
    ) {
        let &Arrival { at, event, .. } = arrival;
        if event > 0 {
            let from = batch.paths.from.load::<P>(at, &self.lights, event - 1);
            let found = &batch.hits.found;
            let mut primitives = [u32::MAX; MAX_WIDTH];
            for lane in each_lane(emits.bits()) {
                primitives[lane] = found.primitive.0[at + lane];
            }
            let other = self.lights.pdf(&from, &primitives, found.t.load::<P>(at), cos)
                * P::splat(batch.light_samples(event - 1) as f32);
            batch.keep_emitted::<P>(at, (emits & arrival.role.after).bits(), light, other);
            light = light * power_heuristic(batch.paths.pdf.load::<P>(at), other);
        }
        light = batch.mis_weighted(at, light, event);
        batch.add(at, emits, light, &arrival.role);
    }
}

impl PathBatch {
    /// Adds light that was hit to the paths in these lanes from place `at` on, but for light that is
    /// kept.
    #[inline(always)]
    fn add<P: SimdWide>(&mut self, at: usize, lanes: P::Mask, light: Rgb<P>, role: &ReuseRole<P>) {
        let (lanes, later) = ((lanes & !role.after).bits(), role.later.bits());
        let channels = store(light);
        for lane in each_lane(lanes) {
            let slot = self.paths.slot.0[at + lane] as usize;
            let sum = LightSum::of_emission(later, lane);
            self.add_to(sum, slot, channels.map(|channel| channel[lane]));
        }
    }

    /// Adds light to a sum of the path at this place.
    #[inline(always)]
    pub(super) fn add_to(&mut self, sum: LightSum, slot: usize, light: [f32; 3]) {
        let sums = match sum {
            LightSum::Radiance => &mut self.radiance,
            LightSum::FromLight => &mut self.reuse.light,
            LightSum::Reflected => &mut self.reuse.reflected,
        };
        for (sum, light) in sums[slot].iter_mut().zip(light) {
            *sum += light;
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
        let (channels, mut pdfs) = (store(light), [0.0; MAX_WIDTH]);
        pdf.store(&mut pdfs);
        for lane in each_lane(lanes) {
            let slot = self.paths.slot.0[at + lane] as usize;
            self.reuse.emitted[slot] = channels.map(|channel| channel[lane]);
            self.reuse.emitted_pdf[slot] = pdfs[lane];
        }
    }
}

#[inline(always)]
fn store<P: SimdWide>(light: Rgb<P>) -> [[f32; MAX_WIDTH]; 3] {
    let mut channels = [[0.0; MAX_WIDTH]; 3];
    light.r.store(&mut channels[0]);
    light.g.store(&mut channels[1]);
    light.b.store(&mut channels[2]);
    channels
}
