//! GGX (Trowbridge and Reitz 1975; Walter et al. 2007).
//!
//! | parameter | range | look |
//! | --- | --- | --- |
//! | alpha | 1e-4 to 1 | 0.01 mirror with a soft halo, 0.1 polished metal, 0.3 satin, 0.6 and up diffuse |
//!
//! `D = alpha² / (pi cos⁴ (alpha² + tan²)²)`,
//! `G1 = 2 / (1 + sqrt(1 + alpha² tan²))`: the exact Smith form. (The source report prints a sum
//! under the root and a second alpha in D; both are misprints.) Its tails are long: highlights have
//! halos, and equal alpha looks rougher than Beckmann's. One bounce between facets only: the lobe loses
//! 2.8 % of the light at alpha 0.1 and 62 % at alpha 1.

use super::{Alpha, Microfacet, Model};
use crate::math::special::{INV_PI, sin_cos_2pi};
use crate::math::{Simd, V3};

/// The GGX model.
#[derive(Clone, Copy, Debug)]
pub struct Ggx;

impl Microfacet for Ggx {
    const MODEL: Model = Model::Ggx;

    #[inline(always)]
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L {
        let a = roughness.alpha;
        let across = h.x * h.x + h.y * h.y;
        let z2 = h.z * h.z;
        let t = (across + z2) / (a * a * z2 + across);
        ((a * t).sqr() * L::splat(INV_PI)).or_zero(h.z.gt(L::splat(0.0)))
    }

    #[inline(always)]
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L {
        let across = roughness.alpha.sqr() * (w.x * w.x + w.y * w.y);
        L::splat(2.0) / (w.z + (w.z * w.z + across).sqrt())
    }

    /// Visible normals by reflection at a spherical cap (Dupuy and Benyoub, "Sampling visible GGX
    /// normals with spherical caps", 2023).
    ///
    /// To cut off the part of the cap whose reflections all lie below the surface (Eto and
    /// Tokuyoshi, "Bounded VNDF sampling for Smith-GGX reflections", 2023) was measured and left
    /// out. At normal incidence and alpha 1 it loses none of the samples instead of half of them,
    /// but a lost sample costs no rays: on the built-in scene 5 % less relMSE take 8 % more work
    /// (`burnish render --alpha 1 --max-depth 8 --group 64`), 3.4 % take 3.1 % at alpha 0.6, and
    /// rough metal in a closed room has 0.4 to 1 % less for 4 to 10 % more.
    #[inline(always)]
    fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L> {
        let one = L::splat(1.0);
        let v = V3::new(roughness.alpha * wo.x, roughness.alpha * wo.y, wo.z).normalize();
        let (sin_phi, cos_phi) = sin_cos_2pi(u[0]);
        // The cap's point has height z = (1 - u)(1 + v.z) - v.z; the sum z + v.z is the product.
        let sum = (one - u[1]) * (one + v.z);
        let z = sum - v.z;
        let sin = ((one - z) * (one + z)).max(L::splat(0.0)).sqrt();
        let h = V3::new(sin * cos_phi + v.x, sin * sin_phi + v.y, sum);
        V3::new(roughness.alpha * h.x, roughness.alpha * h.y, h.z).normalize()
    }

    #[inline(always)]
    fn pdf_factor<L: Simd>(roughness: Alpha<L>, wo: V3<L>) -> L {
        Self::g1_over_cos(roughness, wo) * L::splat(0.25)
    }

    #[inline(always)]
    fn pdf_wi<L: Simd>(factor: L, d: L, _cos_over_dot: L) -> L {
        factor * d
    }
}
