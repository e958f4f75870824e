//! Normals drawn from the distribution itself, as was done before visible normals were known.

use super::{Alpha, Beckmann, Ggx, Microfacet, Model};
use crate::math::special::{ln, sin_cos_2pi};
use crate::math::{Simd, V3};
use std::marker::PhantomData;

/// How Beckmann's and GGX's microfacet normals are drawn. Both are right on average; they differ in
/// noise. Phong knows no visible normals and always draws from the distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Normals {
    /// From those that the viewer sees (Heitz and d'Eon 2014).
    #[default]
    Visible,
    /// From `D cos`, whoever looks (Walter et al. 2007). Most of what is drawn at grazing is wasted
    /// on normals that face away, and what is left weighs more.
    Distribution,
}

impl Normals {
    /// Both, the default first.
    pub const ALL: [Normals; 2] = [Normals::Visible, Normals::Distribution];

    /// Lower-case name, as the command line takes it.
    pub fn name(self) -> &'static str {
        match self {
            Normals::Visible => "visible",
            Normals::Distribution => "distribution",
        }
    }

    /// As a person says it.
    pub fn title(self) -> &'static str {
        match self {
            Normals::Visible => "VNDF",
            Normals::Distribution => "NDF",
        }
    }
}

/// A model whose normals are drawn from `D cos`.
#[derive(Clone, Copy, Debug)]
pub struct FullNdf<M>(PhantomData<M>);

/// A distribution whose `D cos` can be inverted.
pub trait Invertible: Microfacet {
    /// The squared tangent of a normal of alpha 1 from a uniform number.
    fn tan2<L: Simd>(u: L) -> L;
}

impl Invertible for Beckmann {
    #[inline(always)]
    fn tan2<L: Simd>(u: L) -> L {
        // 1 - u is never 0. At u = 0 the logarithm may round to the other side of it.
        (-ln(L::splat(1.0) - u)).max(L::splat(0.0))
    }
}

impl Invertible for Ggx {
    #[inline(always)]
    fn tan2<L: Simd>(u: L) -> L {
        u / (L::splat(1.0) - u)
    }
}

impl<M: Invertible> Microfacet for FullNdf<M> {
    const MODEL: Model = M::MODEL;

    #[inline(always)]
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
        M::d(roughness, h)
    }

    #[inline(always)]
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        M::g1_over_cos(roughness, w)
    }

    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, _wo: V3<L>, u: [L; 2]) -> V3<L> {
        let tan = roughness.alpha * M::tan2(u[0]).sqrt();
        let (sin_phi, cos_phi) = sin_cos_2pi(u[1]);
        V3::new(tan * cos_phi, tan * sin_phi, L::splat(1.0)).normalize()
    }

    #[inline(always)]
    fn pdf_factor<L: Simd>(_width: Alpha<L>, _wo: V3<L>) -> L {
        L::splat(0.25)
    }

    #[inline(always)]
    fn pdf_wi<L: Simd>(factor: L, d: L, cos_over_dot: L) -> L {
        factor * d * cos_over_dot
    }
}
