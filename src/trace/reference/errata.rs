//! The tracer's rules with a mistake in them, chosen at run time.

use super::rules::Rules;
use super::vertex::PathPoint;
use crate::brdf::errata::lobe_frame;
use crate::brdf::{Brdf, BrdfParams, Erratum, Evaluation, Formulas, LobeSample, Model};
use crate::geometry::Ray;
use crate::math::{Rgb, V3};
use crate::trace::lights::LightSample;
use crate::trace::{Scratch, Strategy, Tracer};

/// The chance with which the source report's roulette samples a light at all; it never divides by it.
const REPORT_SURVIVAL: f32 = 0.8;
/// How near the source report's program wants a shadow ray's hit to the sampled point, in the scene's units.
const REPORT_TOLERANCE: f64 = 1e-6;
/// How far off the source report's rays start, in the scene's units.
const REPORT_EPSILON: f64 = 1e-4;

/// At most one mistake; without any, a model whose normals are drawn otherwise.
pub(super) struct WithErratum {
    formulas: Formulas,
    erratum: Option<Erratum>,
    lights: f32,
    /// [`REPORT_TOLERANCE`] and [`REPORT_EPSILON`] in the tracer's units.
    tolerance: f32,
    epsilon: f32,
}

impl WithErratum {
    pub(super) fn new(tracer: &Tracer, model: Model) -> WithErratum {
        let method = tracer.method;
        let scale = tracer.scene.placement().scale();
        WithErratum {
            formulas: Formulas::of(model, method.normals, method.erratum),
            erratum: method.erratum,
            lights: tracer.lights.count() as f32,
            tolerance: (REPORT_TOLERANCE * scale) as f32,
            epsilon: (REPORT_EPSILON * scale) as f32,
        }
    }

    fn makes(&self, erratum: Erratum) -> bool {
        self.erratum == Some(erratum)
    }
}

impl Rules for WithErratum {
    fn at_wo(&self, params: &BrdfParams, wo: V3) -> Brdf {
        (self.formulas.at_wo)(params, wo)
    }

    fn eval(&self, brdf: &Brdf, wi: V3) -> Evaluation {
        (self.formulas.eval)(brdf, wi)
    }

    fn sample(&self, vertex: &PathPoint, brdf: &Brdf, choice: f32, u: [f32; 2]) -> LobeSample {
        if !self.makes(Erratum::LobeFramePole) {
            return (self.formulas.sample)(brdf, choice, u);
        }
        // Drawn about one axis, judged about the other.
        let frame = lobe_frame(vertex.frame.n);
        let wo = frame.to_local(vertex.frame.to_world(vertex.wo));
        let drawn = (self.formulas.sample)(&self.at_wo(brdf.params(), wo), choice, u);
        let wi = vertex.frame.to_local(frame.to_world(drawn.wi));
        let Evaluation { f, pdf } = self.eval(brdf, wi);
        LobeSample { wi, f, pdf: if drawn.pdf > 0.0 { pdf } else { 0.0 } }
    }

    fn cosine(&self, cos: f32) -> f32 {
        (self.formulas.cosine)(cos)
    }

    fn light_choice(&self, choice: f32) -> f32 {
        if !self.makes(Erratum::FirstAndLastLight) {
            return choice;
        }
        // All lights share [0, 1) evenly; only the first and the last share are ever reached.
        let last = choice >= 0.5;
        let within = 2.0 * choice - f32::from(last);
        let start = if last { self.lights - 1.0 } else { 0.0 };
        ((start + within) / self.lights).min(1.0 - f32::EPSILON)
    }

    fn w_bsdf(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        let twice = self.makes(Erratum::DoubleDirect) && strategy == Strategy::Mis;
        if twice { 1.0 } else { strategy.w_bsdf(pdf, other) }
    }

    fn w_light(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        let twice = self.makes(Erratum::DoubleDirect) && strategy == Strategy::Mis;
        if twice { REPORT_SURVIVAL } else { strategy.w_light(pdf, other) }
    }

    fn leave(&self, vertex: &PathPoint, d: V3) -> V3 {
        if self.makes(Erratum::FixedEpsilon) {
            vertex.point.p + d * self.epsilon
        } else {
            vertex.leave(d)
        }
    }

    fn sees(
        &self,
        tracer: &Tracer,
        vertex: &PathPoint,
        light: &LightSample<f32>,
        scratch: &mut Scratch,
    ) -> bool {
        match light.point(vertex.point.p) {
            Some(w_light) if self.makes(Erratum::ShadowTolerance) => {
                let o = vertex.leave(light.wi);
                let ray = Ray { o, d: (w_light - o).normalize() };
                scratch.rays += 1;
                let (geometry, bvh) = (tracer.scene.geometry(), tracer.scene.bvh());
                bvh.closest(geometry, &ray, f32::INFINITY, &mut scratch.stack)
                    .is_some_and(|hit| (ray.at(hit.t) - w_light).length() < self.tolerance)
            }
            _ => tracer.sees(self, vertex, light, scratch),
        }
    }

    fn kept(&self, radiance: Rgb) -> Rgb {
        if self.makes(Erratum::ClampSamples) {
            radiance.map(|c| c.clamp(0.0, 1.0))
        } else {
            radiance
        }
    }
}
