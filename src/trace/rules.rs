//! What the path tracer asks at each step, with the right answers.
//!
//! The tracer is one text, compiled for [`Right`] rules, which vanish into it, and once more for
//! [those that make a mistake](super::errata).

use super::lights::Asked;
use super::reference::Vertex;
use super::{Scratch, Strategy, Tracer};
use crate::brdf::{Evaluation, LobeSample, Lobes, Microfacet, View};
use crate::math::{Rgb, V3};
use std::marker::PhantomData;

/// The steps that can be taken wrongly.
pub(super) trait Rules: Sized {
    /// [`Lobes::seen_from`].
    fn seen_from(&self, lobes: &Lobes, wo: V3) -> View;
    /// [`View::eval`].
    fn eval(&self, view: &View, wi: V3) -> Evaluation;
    /// [`View::sample`], in the vertex's frame.
    fn sample(&self, vertex: &Vertex, view: &View, choice: f32, u: [f32; 2]) -> LobeSample;
    /// [`Microfacet::cosine`].
    fn cosine(&self, cos: f32) -> f32;

    /// The number by which a light is chosen, from a uniform one.
    #[inline(always)]
    fn light_choice(&self, choice: f32) -> f32 {
        choice
    }

    /// Weight of a light met by chance.
    #[inline(always)]
    fn met(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        strategy.met(pdf, other)
    }

    /// Weight of a light asked.
    #[inline(always)]
    fn asked(&self, strategy: Strategy, pdf: f32, other: f32) -> f32 {
        strategy.asked(pdf, other)
    }

    /// Where a ray in this direction starts.
    #[inline(always)]
    fn leave(&self, vertex: &Vertex, d: V3) -> V3 {
        vertex.leave(d)
    }

    /// Whether a light is seen.
    #[inline(always)]
    fn sees(
        &self,
        tracer: &Tracer,
        vertex: &Vertex,
        light: &Asked<f32>,
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
pub(super) struct Right<M>(PhantomData<M>);

impl<M> Default for Right<M> {
    fn default() -> Right<M> {
        Right(PhantomData)
    }
}

impl<M: Microfacet> Rules for Right<M> {
    #[inline(always)]
    fn seen_from(&self, lobes: &Lobes, wo: V3) -> View {
        lobes.seen_from::<M>(wo)
    }
    #[inline(always)]
    fn eval(&self, view: &View, wi: V3) -> Evaluation {
        view.eval::<M>(wi)
    }
    #[inline(always)]
    fn sample(&self, _vertex: &Vertex, view: &View, choice: f32, u: [f32; 2]) -> LobeSample {
        view.sample::<M>(choice, u)
    }
    #[inline(always)]
    fn cosine(&self, cos: f32) -> f32 {
        M::cosine(cos)
    }
}
