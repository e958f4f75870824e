//! The tracer's rules with a mistake in them, chosen at run time.

use super::lights::Asked;
use super::reference::Vertex;
use super::rules::Rules;
use super::{Scratch, Strategy, Tracer};
use crate::brdf::errata::lobe_frame;
use crate::brdf::{Erratum, Evaluation, Formulas, LobeSample, Lobes, Model, View};
use crate::geometry::Ray;
use crate::math::{Rgb, V3};

/// The chance with which the source report's roulette samples a light at all; it never divides by it.
const SEED_SURVIVAL: f32 = 0.8;
/// How near the source report's program wants a shadow ray's hit to the sampled point, in the scene's units.
const SEED_TOLERANCE: f64 = 1e-6;
/// How far off the source report's rays start, in the scene's units.
const SEED_EPSILON: f64 = 1e-4;

/// At most one mistake; without any, a model whose normals are drawn otherwise.
pub(super) struct Wrong {
    formulas: Formulas,
    erratum: Option<Erratum>,
    lights: f32,
    /// [`SEED_TOLERANCE`] and [`SEED_EPSILON`] in the tracer's units.
    tolerance: f32,
    epsilon: f32,
}

impl Wrong {
    pub(super) fn new(tracer: &Tracer, model: Model) -> Wrong {
        let method = tracer.method;
        let scale = tracer.scene.placement().scale();
        Wrong {
            formulas: Formulas::of(model, method.normals, method.erratum),
            erratum: method.erratum,
            lights: tracer.lights.count() as f32,
            tolerance: (SEED_TOLERANCE * scale) as f32,
            epsilon: (SEED_EPSILON * scale) as f32,
        }
    }

    fn makes(&self, erratum: Erratum) -> bool {
        self.erratum == Some(erratum)
    }
}

impl Rules for Wrong {
    fn seen_from(&self, lobes: &Lobes, wo: V3) -> View {
        (self.formulas.seen_from)(lobes, wo)
    }

    fn eval(&self, view: &View, wi: V3) -> Evaluation {
        (self.formulas.eval)(view, wi)
    }

    fn sample(&self, vertex: &Vertex, view: &View, choice: f32, u: [f32; 2]) -> LobeSample {
        if !self.makes(Erratum::LobeFramePole) {
            return (self.formulas.sample)(view, choice, u);
        }
        // Drawn about one axis, judged about the other.
        let frame = lobe_frame(vertex.frame.n);
        let wo = frame.to_local(vertex.frame.to_world(vertex.wo));
        let drawn = (self.formulas.sample)(&self.seen_from(view.lobes(), wo), choice, u);
        let wi = vertex.frame.to_local(frame.to_world(drawn.wi));
        let Evaluation { f, pdf } = self.eval(view, wi);
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

    fn met(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        let twice = self.makes(Erratum::DoubleDirect) && strategy == Strategy::Mis;
        if twice { 1.0 } else { strategy.met(pdf, other) }
    }

    fn asked(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        let twice = self.makes(Erratum::DoubleDirect) && strategy == Strategy::Mis;
        if twice { SEED_SURVIVAL } else { strategy.asked(pdf, other) }
    }

    fn leave(&self, vertex: &Vertex, d: V3) -> V3 {
        if self.makes(Erratum::FixedEpsilon) {
            vertex.point.p + d * self.epsilon
        } else {
            vertex.leave(d)
        }
    }

    fn sees(
        &self,
        tracer: &Tracer,
        vertex: &Vertex,
        light: &Asked<f32>,
        scratch: &mut Scratch,
    ) -> bool {
        match light.point(vertex.point.p) {
            Some(asked) if self.makes(Erratum::ShadowTolerance) => {
                let o = vertex.leave(light.wi);
                let ray = Ray { o, d: (asked - o).normalize() };
                scratch.rays += 1;
                let (geometry, bvh) = (tracer.scene.geometry(), tracer.scene.bvh());
                bvh.closest(geometry, &ray, f32::INFINITY, &mut scratch.stack)
                    .is_some_and(|hit| (ray.at(hit.t) - asked).length() < self.tolerance)
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
