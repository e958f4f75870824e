//! The path tracer that one reads: one path at a time, plain control flow.

mod errata;
mod record;
mod rules;
mod vertex;

pub use record::{Escape, PathRecord, PathVertex};

use crate::brdf::Microfacet;
use crate::geometry::Ray;
use crate::math::Rgb;
use crate::math::simd::U32;
use crate::math::sobol::{Slot, Stream, pair};
use crate::trace::lights::{LightSample, LightSampleContext};
use crate::trace::{DEPTH_CAP, Scratch, THROUGHPUT_CAP, Tracer, roulette};
use errata::WithErratum;
use record::Recorder;
use rules::{Correct, Rules};
use vertex::PathPoint;

/// One pass of some pixels, by some rules.
struct Pixels<'a, R> {
    tracer: &'a Tracer,
    pixels: &'a mut dyn Iterator<Item = [u32; 2]>,
    pass: u64,
    block: u32,
    scratch: &'a mut Scratch,
    each: &'a mut dyn FnMut(Rgb),
    rules: R,
}

impl<R: Rules> Pixels<'_, R> {
    fn run(self) {
        for [x, y] in self.pixels {
            let stream = Stream::new(self.tracer.seed, U32(x), U32(y), self.pass);
            let [dx, dy] = pair::<f32>(&stream, Slot::CAMERA);
            let side = self.block as f32;
            let ray = self.tracer.camera.ray((x as f32 + dx) * side, (y as f32 + dy) * side);
            let found = self.tracer.radiance(&self.rules, ray, &stream, self.scratch, &mut ());
            (self.each)(self.rules.kept(found));
        }
    }
}

impl Tracer {
    /// Radiance of one sample: pass `pass` (from 0) of the pixel in column `x`, row `y` from the
    /// top. The same arguments give the same bits, always.
    pub fn sample(&self, x: u32, y: u32, pass: u64, scratch: &mut Scratch) -> Rgb {
        let mut radiance = Rgb::BLACK;
        let each = &mut |found| radiance = found;
        self.one_by_one(&mut [[x, y]].into_iter(), pass, 1, scratch, each);
        radiance
    }

    /// [`Tracer::sample`] of one pixel after the other, or of blocks of pixels. What is not the right tracer with visible
    /// normals is compiled once for all models.
    pub(super) fn sample_pixels<M: Microfacet>(
        &self,
        pixels: &mut dyn Iterator<Item = [u32; 2]>,
        pass: u64,
        block: u32,
        scratch: &mut Scratch,
        each: &mut dyn FnMut(Rgb),
    ) {
        let tracer = self;
        if self.method.is_correct(M::MODEL) {
            let rules = Correct::<M>::default();
            Pixels { tracer, pixels, pass, block, scratch, each, rules }.run();
        } else {
            let rules = WithErratum::new(self, M::MODEL);
            Pixels { tracer, pixels, pass, block, scratch, each, rules }.run();
        }
    }

    /// Radiance along a ray. The recorder is told of every step; what it is given adds up to the
    /// result, in this order.
    #[inline(always)]
    fn radiance<R: Rules>(
        &self,
        rules: &R,
        mut ray: Ray,
        stream: &Stream<U32>,
        scratch: &mut Scratch,
        record: &mut impl Recorder,
    ) -> Rgb {
        let geometry = self.scene.geometry();
        let strategy = self.method.strategy;
        let mut sum = Rgb::BLACK;
        let mut beta = Rgb::splat(1.0);
        // Where the ray left from, with the density of its direction; none for the camera's.
        let mut from: Option<(LightSampleContext, f32)> = None;
        for event in 0.. {
            scratch.rays += 1;
            let bvh = self.scene.bvh();
            let hit = bvh.closest(geometry, &ray, f32::INFINITY, &mut scratch.stack);
            let Some(hit) = hit else {
                let weight = from.as_ref().map_or(1.0, |(from, pdf)| {
                    let other = self.lights.environment_pdf(from, from.frame.n.dot(ray.d));
                    rules.w_bsdf(strategy, *pdf, other)
                });
                let found = beta * self.lights.environment() * weight;
                record.escaped(ray.d, found);
                sum += found;
                return sum;
            };
            let point = geometry.surface(&ray, &hit);
            let material = geometry.material(hit.primitive);
            let surface = &self.surfaces[material as usize];
            record.hit(point.p, material, beta);
            if surface.emits {
                let weight = from.as_ref().map_or(1.0, |(from, pdf)| {
                    let cos = point.ng.dot(ray.d).abs();
                    let other = self.lights.pdf(from, &[hit.primitive], hit.t, cos);
                    rules.w_bsdf(strategy, *pdf, other)
                });
                let found = beta * surface.emission * weight;
                record.emitted(found);
                sum += found;
            }
            if event >= self.max_depth || !surface.reflects {
                return sum;
            }
            if event >= DEPTH_CAP {
                scratch.capped += 1;
                return sum;
            }
            let Some(vertex) = PathPoint::facing(point, -ray.d) else { return sum };
            let brdf = rules.at_wo(&surface.params, vertex.wo);
            let [lobe_choice, light_choice] = pair::<f32>(stream, Slot::choice(event));

            let u = pair::<f32>(stream, Slot::light(event));
            let choice = rules.light_choice(light_choice);
            let (p, params) = (vertex.point.p, brdf.params());
            let context = LightSampleContext::new(p, vertex.frame, event == 0, params, vertex.wo);
            if self.lights.count() > 0
                && let light = self.lights.sample(bvh, geometry, &context, choice, u)
                && light.found
                && let Some(wi) = rules.inwards(&vertex, light.wi)
            {
                let e = rules.eval(&brdf, wi);
                let weight = rules.w_light(strategy, light.pdf, e.pdf);
                let found = light.radiance * e.f * (rules.cosine(wi.z) / light.pdf * weight);
                if !found.is_black() && rules.sees(self, &vertex, &light, scratch) {
                    let found = beta * found;
                    record.lit(found, light.point(p));
                    sum += found;
                }
            }

            let u = pair::<f32>(stream, Slot::direction(event));
            let next = rules.sample(&vertex, &brdf, lobe_choice, u);
            let d = vertex.frame.to_world(next.wi);
            record.scattered(vertex.wo, next.wi);
            if next.pdf <= 0.0 || rules.cosine(vertex.ng.dot(d)) <= 0.0 {
                return sum;
            }
            beta *= next.f * (rules.cosine(next.wi.z) / next.pdf);
            if beta.is_black() {
                return sum;
            }
            if event >= roulette::FROM {
                let survival = roulette::survival(event, beta.max_channel());
                if survival < 1.0 {
                    if pair::<f32>(stream, Slot::roulette(event))[0] >= survival {
                        return sum;
                    }
                    beta = beta * (1.0 / survival);
                }
            }
            if beta.max_channel() > THROUGHPUT_CAP {
                scratch.capped += 1;
                return sum;
            }
            ray = Ray { o: rules.leave(&vertex, d), d };
            from = Some((context, next.pdf));
        }
        sum
    }

    /// Whether nothing is between a vertex and a point on a light, or infinity.
    #[inline(always)]
    fn sees<R: Rules>(
        &self,
        rules: &R,
        vertex: &PathPoint,
        light: &LightSample<f32>,
        scratch: &mut Scratch,
    ) -> bool {
        let wi = light.wi;
        let o = rules.leave(vertex, wi);
        let shadow = light.shadow_ray(o);
        if !shadow.hits {
            return false;
        }
        scratch.rays += 1;
        let geometry = self.scene.geometry();
        let ray = Ray { o, d: shadow.d };
        !self.scene.bvh().occluded(geometry, &ray, shadow.t_max, &mut scratch.stack)
    }
}
