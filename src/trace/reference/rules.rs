//! The steps of the path tracer that an erratum may change, and the correct ones.
//!
//! The tracer is one text, compiled for [`Correct`] rules, which vanish into it, and once more for
//! [those that make a mistake](super::errata).

use super::vertex::PathPoint;
use crate::brdf::{Brdf, BrdfParams, Evaluation, LobeSample, Microfacet};
use crate::math::{Rgb, V3};
use crate::trace::lights::LightSample;
use crate::trace::{Scratch, Strategy, Tracer};
use std::marker::PhantomData;

/// The steps that can be taken wrongly.
pub(super) trait Rules: Sized {
    /// [`BrdfParams::at_wo`].
    fn at_wo(&self, params: &BrdfParams, wo: V3) -> Brdf;
    /// [`Brdf::eval`].
    fn eval(&self, brdf: &Brdf, wi: V3) -> Evaluation;
    /// [`Brdf::sample`], in the vertex's frame.
    fn sample(&self, vertex: &PathPoint, brdf: &Brdf, choice: f32, u: [f32; 2]) -> LobeSample;
    /// The cosine that counts, from the signed one: where it is not above 0 there is no light.
    #[inline(always)]
    fn cosine(&self, cos: f32) -> f32 {
        cos
    }

    /// A world direction in the vertex's frame, where both normals have it on the viewer's side.
    #[inline(always)]
    fn inwards(&self, vertex: &PathPoint, wi: V3) -> Option<V3> {
        let local = vertex.frame.to_local(wi);
        let both = self.cosine(local.z) > 0.0 && self.cosine(vertex.ng.dot(wi)) > 0.0;
        both.then_some(local)
    }

    /// The number by which a light is chosen, from a uniform one.
    #[inline(always)]
    fn light_choice(&self, choice: f32) -> f32 {
        choice
    }

    /// Weight of a light hit by chance.
    #[inline(always)]
    fn w_bsdf(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        strategy.w_bsdf(pdf, other)
    }

    /// Weight of a light sampled.
    #[inline(always)]
    fn w_light(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        strategy.w_light(pdf, other)
    }

    /// Where a ray in this direction starts.
    #[inline(always)]
    fn leave(&self, vertex: &PathPoint, d: V3) -> V3 {
        vertex.leave(d)
    }

    /// Whether a light is seen.
    #[inline(always)]
    fn sees(
        &self,
        tracer: &Tracer,
        vertex: &PathPoint,
        light: &LightSample<f32>,
        scratch: &mut Scratch,
    ) -> bool {
        tracer.sees(self, vertex, light, scratch)
    }

    /// What a film gets of a sample.
    #[inline(always)]
    fn kept(&self, radiance: Rgb) -> Rgb {
        radiance
    }
}

/// Everything right, with the model known when compiled.
pub(super) struct Correct<M>(PhantomData<M>);

impl<M> Default for Correct<M> {
    fn default() -> Correct<M> {
        Correct(PhantomData)
    }
}

impl<M: Microfacet> Rules for Correct<M> {
    #[inline(always)]
    fn at_wo(&self, params: &BrdfParams, wo: V3) -> Brdf {
        params.at_wo::<M>(wo)
    }
    #[inline(always)]
    fn eval(&self, brdf: &Brdf, wi: V3) -> Evaluation {
        brdf.eval::<M>(wi)
    }
    #[inline(always)]
    fn sample(&self, _vertex: &PathPoint, brdf: &Brdf, choice: f32, u: [f32; 2]) -> LobeSample {
        brdf.sample::<M>(choice, u)
    }
}
