//! Phong's distribution (Phong 1975; normalised as in Walter et al. 2007).
//!
//! | parameter | range | look |
//! | --- | --- | --- |
//! | a_p, the exponent | 0 to 2e8 - 2 | 10 diffuse, 200 satin, 2000 polished, 1e6 mirror |
//!
//! `D = (a_p + 2) / (2 pi) cos^a_p`, with Beckmann's rational G1 at alpha = sqrt(2/(a_p+2)). D and
//! G do not belong together: at low exponents and grazing angles the lobe gains energy (albedo up
//! to 1.34 at a_p = 0), and no density of visible normals exists. Normals are drawn from `D cos`.

use super::{Alpha, Microfacet, Model, rational_g1_over_cos, tan2};
use crate::math::special::{INV_PI, exp, exp_m1, ln, ln_1p, sin_cos_2pi};
use crate::math::{Simd, V3};

/// The Phong model.
#[derive(Clone, Copy, Debug)]
pub struct Phong;

impl Microfacet for Phong {
    const MODEL: Model = Model::Phong;

    #[inline(always)]
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
        let a = roughness.exponent;
        let lobe = exp(-(a * L::splat(0.5) * ln_1p(tan2(h))));
        ((a + L::splat(2.0)) * L::splat(0.5 * INV_PI) * lobe).or_zero(h.z.gt(L::splat(0.0)))
    }

    #[inline(always)]
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        rational_g1_over_cos(roughness.alpha, w)
    }

    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, _wo: V3<L>, u: [L; 2]) -> V3<L> {
        // cos^(a+2) is uniform; 1 - u is never 0.
        let ln_cos = ln(L::splat(1.0) - u[0]) / (roughness.exponent + L::splat(2.0));
        let sin = (-exp_m1(ln_cos + ln_cos)).sqrt();
        let (sin_phi, cos_phi) = sin_cos_2pi(u[1]);
        V3::new(sin * cos_phi, sin * sin_phi, exp(ln_cos))
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
