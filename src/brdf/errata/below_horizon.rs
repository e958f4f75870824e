//! [`Erratum::BelowHorizon`](super::Erratum::BelowHorizon): a model continued below the surface, and the
//! BRDF by the absolute value of every cosine.

use crate::brdf::bsdf::Horizon;
use crate::brdf::{Alpha, Brdf, Evaluation, LobeSample, Microfacet, Model, ModelVisitor};
use crate::math::{Simd, V3};
use std::marker::PhantomData;

/// A model's D, G1 and density below the horizon as well.
#[derive(Clone, Copy, Debug)]
pub(in crate::brdf) struct BelowHorizon<M>(PhantomData<M>);

/// Does with [`BelowHorizon`] what is to be done with a model.
pub(in crate::brdf) struct Extended<V>(pub(in crate::brdf) V);

impl<V: ModelVisitor> ModelVisitor for Extended<V> {
    type Output = V::Output;
    fn visit<M: Microfacet>(self) -> V::Output {
        self.0.visit::<BelowHorizon<M>>()
    }
}

/// Directions on either side count.
struct EitherSide;

impl Horizon for EitherSide {
    #[inline(always)]
    fn cosine<L: Simd>(cos: L) -> L {
        cos.abs()
    }
}

/// [`Brdf::eval`] with the mistake.
pub(super) fn eval<M: Microfacet>(brdf: &Brdf, wi: V3) -> Evaluation {
    brdf.eval_by::<BelowHorizon<M>, EitherSide>(wi)
}

/// [`Brdf::sample`] with the mistake.
pub(super) fn sample<M: Microfacet>(brdf: &Brdf, choice: f32, u: [f32; 2]) -> LobeSample {
    brdf.sample_by::<BelowHorizon<M>, EitherSide>(choice, u)
}

impl<M: Microfacet> Microfacet for BelowHorizon<M> {
    const MODEL: Model = M::MODEL;

    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L> {
        M::sample_wm(roughness, wo, u)
    }

    #[inline(always)]
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
        M::d(roughness, upwards(h))
    }

    #[inline(always)]
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        let right = M::g1_over_cos(roughness, upwards(w));
        if M::MODEL == Model::Ggx {
            return right;
        }
        // The rational form at a = cot / alpha < 0, divided by |cos|.
        let b = roughness.alpha * (w.x * w.x + w.y * w.y).sqrt();
        let numerator = L::splat(3.535) * b + L::splat(2.181) * w.z;
        let denominator = b * b + w.z * (L::splat(2.276) * b + L::splat(2.577) * w.z);
        L::select(w.z.lt(L::splat(0.0)), -(numerator / denominator), right)
    }

    #[inline(always)]
    fn pdf_factor<L: Simd>(roughness: Alpha<L>, wo: V3<L>) -> L {
        M::pdf_factor(roughness, upwards(wo))
    }

    #[inline(always)]
    fn pdf_wi<L: Simd>(factor: L, d: L, cos_over_dot: L) -> L {
        M::pdf_wi(factor, d, cos_over_dot.abs())
    }
}

/// The direction or its mirror image, whichever is above the surface.
#[inline(always)]
fn upwards<L: Simd>(w: V3<L>) -> V3<L> {
    V3::new(w.x, w.y, w.z.abs())
}
