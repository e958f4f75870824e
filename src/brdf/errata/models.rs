//! The wrong models: each wraps a right one and overrides what the erratum is about.

use crate::brdf::{Alpha, Beckmann, Brdf, FullNdf, Ggx, Microfacet, Model, Phong};
use crate::math::{Rgb, Simd, V3};
use std::marker::PhantomData;

/// How many times too large [`GgxDAlpha`] takes the alpha of the denominator.
pub const ALPHA_FACTOR: f32 = 2.0;

/// `1 / sqrt(ln 10)`: what a logarithm to base 10 does to the width of a Gaussian.
const LOG10_WIDTH: f32 = 0.659_010_2;

/// [`Erratum::GgxGSum`](super::Erratum::GgxGSum): the value's G alone is wrong. The density of
/// the visible normals keeps the right one, as it would if it were written by another hand.
#[derive(Clone, Copy, Debug)]
pub struct GgxGSum<M = Ggx>(PhantomData<M>);

/// [`Erratum::GgxDAlpha`](super::Erratum::GgxDAlpha): wrong wherever D is read, in the value and
/// in the density.
#[derive(Clone, Copy, Debug)]
pub struct GgxDAlpha<M = Ggx>(PhantomData<M>);

/// [`Erratum::BeckmannLog10`](super::Erratum::BeckmannLog10): draws from `D cos`, as the source
/// report does; a wrong logarithm has no place in the sampler of visible normals.
#[derive(Clone, Copy, Debug)]
pub struct BeckmannLog10;

/// [`Erratum::PhongExponent`](super::Erratum::PhongExponent).
#[derive(Clone, Copy, Debug)]
pub struct PhongExponent;

/// What a wrapper leaves to the model that it wraps.
macro_rules! right {
    ($inner:ty: $($item:ident)*) => { $(right!(@ $item $inner);)* };
    (@ d $inner:ty) => {
        #[inline(always)]
        fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
            <$inner>::d(roughness, h)
        }
    };
    (@ g1_over_cos $inner:ty) => {
        #[inline(always)]
        fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
            <$inner>::g1_over_cos(roughness, w)
        }
    };
    (@ sample_wm $inner:ty) => {
        #[inline(always)]
        fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L> {
            <$inner>::sample_wm(roughness, wo, u)
        }
    };
    (@ pdf $inner:ty) => {
        #[inline(always)]
        fn pdf_factor<L: Simd>(roughness: Alpha<L>, wo: V3<L>) -> L {
            <$inner>::pdf_factor(roughness, wo)
        }
        #[inline(always)]
        fn pdf_wi<L: Simd>(factor: L, d: L, cos_over_dot: L) -> L {
            <$inner>::pdf_wi(factor, d, cos_over_dot)
        }
    };
}

impl<M: Microfacet> Microfacet for GgxGSum<M> {
    const MODEL: Model = M::MODEL;
    right!(M: d sample_wm pdf);

    #[inline(always)]
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        let (z2, across) = (w.z * w.z, w.x * w.x + w.y * w.y);
        let sum = z2 * (L::splat(1.0) + roughness.alpha.sqr()) + across;
        L::splat(2.0) / (w.z + sum.sqrt())
    }
}

impl<M: Microfacet> Microfacet for GgxDAlpha<M> {
    const MODEL: Model = M::MODEL;
    right!(M: g1_over_cos sample_wm pdf);

    #[inline(always)]
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
        // The D of the wider alpha, but for the alpha² before it.
        let wide = Alpha { alpha: roughness.alpha * L::splat(ALPHA_FACTOR), ..roughness };
        M::d(wide, h) * L::splat(1.0 / (ALPHA_FACTOR * ALPHA_FACTOR))
    }
}

impl Microfacet for BeckmannLog10 {
    const MODEL: Model = Model::Beckmann;
    right!(FullNdf<Beckmann>: d g1_over_cos pdf);

    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L> {
        let narrow = Alpha { alpha: roughness.alpha * L::splat(LOG10_WIDTH), ..roughness };
        FullNdf::<Beckmann>::sample_wm(narrow, wo, u)
    }
}

impl Microfacet for PhongExponent {
    const MODEL: Model = Model::Phong;
    right!(Phong: d g1_over_cos pdf);

    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L> {
        Phong::sample_wm(Alpha { exponent: roughness.exponent - L::splat(1.0), ..roughness }, wo, u)
    }
}

/// [`Erratum::ConstantLobeChoice`](super::Erratum::ConstantLobeChoice) of what a viewer sees.
pub(super) fn constant_lobe_choice(mut brdf: Brdf) -> Brdf {
    let length = |c: Rgb| (c.r * c.r + c.g * c.g + c.b * c.b).sqrt();
    let (kd, ks) = (length(brdf.params().kd), length(brdf.params().ks));
    // 0/0 is left out: it says nothing about the choice.
    brdf.p_specular = if ks > 0.0 { ks / (kd + ks) } else { 0.0 };
    brdf
}
