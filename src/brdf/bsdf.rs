//! The two lobes together: value, sampler and density of the whole BRDF.

use super::fresnel::{schlick, schlick_weight};
use super::{Alpha, Microfacet};
use crate::math::special::INV_PI;
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::math::{Mask, Rgb, Simd, V3};

/// A surface's BRDF parameters.
#[derive(Clone, Copy, Debug)]
pub struct BrdfParams<L = f32> {
    /// Diffuse reflectance.
    pub kd: Rgb<L>,
    /// Specular reflectance at normal incidence; all zero for no specular lobe.
    pub ks: Rgb<L>,
    /// Roughness.
    pub roughness: Alpha<L>,
}

/// The BRDF's value for two directions with the density of finding `wi`.
#[derive(Clone, Copy, Debug)]
pub struct Evaluation<L = f32> {
    /// f in 1/sr, without the cosine.
    pub f: Rgb<L>,
    /// Density of [`BrdfParams::sample`] at `wi`, in 1/sr, over both lobes.
    pub pdf: L,
}

/// A sampled direction. Where `pdf` is 0 nothing was found: the path ends there, and counts.
#[derive(Clone, Copy, Debug)]
pub struct LobeSample<L = f32> {
    /// Towards the light, unit, z > 0 where the pdf is.
    pub wi: V3<L>,
    /// f in 1/sr, without the cosine.
    pub f: Rgb<L>,
    /// Density of `wi`, in 1/sr, over both lobes.
    pub pdf: L,
}

/// Every factor of the BRDF for one channel, for tables and plots.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// D of the half vector.
    pub d: f32,
    /// G1 of `wi`, as the source report has it.
    pub g1i: f32,
    /// G1 of `wo`, as the source report has it.
    pub g1o: f32,
    /// Their product.
    pub g: f32,
    /// Schlick's F.
    pub fresnel: f32,
    /// D G F / (4 cos cos).
    pub specular: f32,
    /// Density of the diffuse sampler.
    pub pdf_diffuse: f32,
    /// Density of the specular sampler.
    pub pdf_specular: f32,
    /// Probability of choosing the specular one.
    pub p_specular: f32,
}

impl<L: Simd> BrdfParams<L> {
    /// Probability of sampling the specular lobe: its share of the reflectance seen from `wo`,
    /// kept within [0.05, 0.95] where both lobes exist. Any value would be unbiased; a share that
    /// followed Ks alone would starve the lobe where F is strong.
    #[inline(always)]
    pub fn p_specular(&self, wo: V3<L>) -> L {
        let zero = L::splat(0.0);
        let [diffuse, specular] = self.reflectances(wo);
        let share = (specular / (specular + diffuse)).max(L::splat(0.05)).min(L::splat(0.95));
        let share = L::select(diffuse.gt(zero), share, L::splat(1.0));
        share.or_zero(self.has_specular())
    }

    /// Luminance of the diffuse reflectance and of Fresnel's at a mirror, seen from `wo`.
    #[inline(always)]
    pub(crate) fn reflectances(&self, wo: V3<L>) -> [L; 2] {
        let specular = schlick(self.ks, schlick_weight(L::splat(1.0) - wo.z)).luminance();
        [self.kd.luminance(), specular.or_zero(self.has_specular())]
    }

    /// Whether there is a specular lobe.
    #[inline(always)]
    fn has_specular(&self) -> L::Mask {
        self.ks.max_channel().gt(L::splat(0.0))
    }

    /// The BRDF as one viewer sees it: what depends on `wo` alone is computed once.
    #[inline(always)]
    pub fn at_wo<M: Microfacet>(&self, wo: V3<L>) -> Brdf<L> {
        let zero = L::splat(0.0);
        let glossy = self.has_specular();
        let (p_specular, g1, pdf_factor) = if glossy.any() {
            let g1 = M::g1_over_cos(self.roughness, wo);
            (self.p_specular(wo), g1, M::pdf_factor(self.roughness, wo))
        } else {
            (zero, zero, zero)
        };
        Brdf { params: *self, wo, glossy, p_specular, g1, pdf_factor }
    }

    /// [`Brdf::eval`] for one pair of directions.
    #[inline(always)]
    pub fn eval<M: Microfacet>(&self, wo: V3<L>, wi: V3<L>) -> Evaluation<L> {
        self.at_wo::<M>(wo).eval::<M>(wi)
    }

    /// [`Brdf::sample`] for one viewer.
    #[inline(always)]
    pub fn sample<M: Microfacet>(&self, wo: V3<L>, choice: L, u: [L; 2]) -> LobeSample<L> {
        self.at_wo::<M>(wo).sample::<M>(choice, u)
    }
}

/// The BRDF as one viewer sees it, from [`BrdfParams::at_wo`].
#[derive(Clone, Copy, Debug)]
pub struct Brdf<L: Simd = f32> {
    params: BrdfParams<L>,
    wo: V3<L>,
    glossy: L::Mask,
    pub(super) p_specular: L,
    /// G1(wo) over its cosine.
    g1: L,
    pdf_factor: L,
}

impl<L: Simd> Brdf<L> {
    /// What is seen.
    pub fn params(&self) -> &BrdfParams<L> {
        &self.params
    }

    /// Value and density for a unit direction `wi`; zero unless it and `wo` are above the surface.
    #[inline(always)]
    pub fn eval<M: Microfacet>(&self, wi: V3<L>) -> Evaluation<L> {
        self.eval_by::<M, Above>(wi)
    }

    /// What the specular lobe adds to f, in 1/sr, without the cosine; as [`Brdf::eval`] has it where the
    /// diffuse lobe can be sampled too. Nothing where `wo` is not a number.
    #[inline(always)]
    pub(crate) fn specular<M: Microfacet>(&self, wi: V3<L>) -> Rgb<L> {
        let h = wi + self.wo;
        let weight = schlick_weight(one_minus_dot(self.wo, wi, h.length2()));
        let lobe =
            schlick(self.params.ks, weight) * self.lobe::<M>(wi, M::d(self.params.roughness, h));
        // Whatever a direction that is none has given is no light.
        let above = is_above::<Above, L>(self.wo, wi);
        lobe.map(|c| c.or_zero(above))
    }

    /// D G / (4 |wi.n| |wo.n|).
    #[inline(always)]
    fn lobe<M: Microfacet>(&self, wi: V3<L>, d: L) -> L {
        let g = M::g1_over_cos(self.params.roughness, wi) * self.g1;
        (d * (g * L::splat(0.25))).or_zero(self.glossy)
    }

    /// [`Brdf::eval`] by some horizon.
    #[inline(always)]
    pub(super) fn eval_by<M: Microfacet, H: Horizon>(&self, wi: V3<L>) -> Evaluation<L> {
        let above = is_above::<H, L>(self.wo, wi);
        if !self.glossy.any() {
            return self.diffuse_only::<H>(wi, above);
        }
        let h = wi + self.wo;
        let h2 = h.length2();
        let d = M::d(self.params.roughness, h);
        let weight = schlick_weight(one_minus_dot(self.wo, wi, h2));
        self.combine::<M, H>(wi, d, weight, (h.z + h.z) / h2, above)
    }

    /// A direction from a uniform number for the lobe and two for the direction. D and F come from
    /// the sampled microfacet normal itself, which keeps digits that the sum `wi + wo` has lost
    /// when alpha is small.
    #[inline(always)]
    pub fn sample<M: Microfacet>(&self, choice: L, u: [L; 2]) -> LobeSample<L> {
        self.sample_by::<M, Above>(choice, u)
    }

    /// [`Brdf::sample`] by some horizon.
    #[inline(always)]
    pub(super) fn sample_by<M: Microfacet, H: Horizon>(
        &self,
        choice: L,
        u: [L; 2],
    ) -> LobeSample<L> {
        let wo = self.wo;
        if !self.glossy.any() {
            let wi = cosine_hemisphere(u);
            let e = self.diffuse_only::<H>(wi, is_above::<H, L>(wo, wi));
            return LobeSample { wi, f: e.f, pdf: e.pdf };
        }
        let take_specular = choice.lt(self.p_specular);
        // What no lane takes is not computed.
        let nothing = V3::splat(L::splat(0.0));
        let roughness = self.params.roughness;
        let wm = if take_specular.any() { M::sample_wm(roughness, wo, u) } else { nothing };
        let dot = wo.dot(wm);
        let mirrored = wm * (dot + dot) - wo;
        let diffuse = if take_specular.all() { nothing } else { cosine_hemisphere(u) };
        let wi = V3::select(take_specular, mirrored, diffuse);
        let h = wi + wo;
        let h2 = h.length2();
        let d = M::d(roughness, V3::select(take_specular, wm, h));
        let one_minus_d = L::select(
            take_specular,
            (wo - wm).length2() * L::splat(0.5),
            one_minus_dot(wo, wi, h2),
        );
        let cos_over_dot = L::select(take_specular, wm.z / dot, (h.z + h.z) / h2);
        let facing = dot.gt(L::splat(0.0)) | !take_specular;
        let weight = schlick_weight(one_minus_d);
        let valid = is_above::<H, L>(wo, wi) & facing;
        let e = self.combine::<M, H>(wi, d, weight, cos_over_dot, valid);
        LobeSample { wi, f: e.f, pdf: e.pdf }
    }

    /// What [`Brdf::combine`] gives where no lane has a specular lobe.
    #[inline(always)]
    fn diffuse_only<H: Horizon>(&self, wi: V3<L>, valid: L::Mask) -> Evaluation<L> {
        Evaluation {
            f: self.params.kd.map(|kd| (kd * L::splat(INV_PI)).or_zero(valid)),
            pdf: cosine_hemisphere_pdf(H::cosine(wi.z)).or_zero(valid),
        }
    }

    #[inline(always)]
    fn combine<M: Microfacet, H: Horizon>(
        &self,
        wi: V3<L>,
        d: L,
        weight: L,
        cos_over_dot: L,
        valid: L::Mask,
    ) -> Evaluation<L> {
        let lobe = self.lobe::<M>(wi, d);
        let diffuse = self.params.kd.map(|kd| kd * L::splat(INV_PI));
        let f = diffuse + schlick(self.params.ks, weight) * lobe;
        let p = self.p_specular;
        let specular = M::pdf_wi(self.pdf_factor, d, cos_over_dot).or_zero(p.gt(L::splat(0.0)));
        let pdf = p * specular + (L::splat(1.0) - p) * cosine_hemisphere_pdf(H::cosine(wi.z));
        let valid = valid & pdf.gt(L::splat(0.0));
        Evaluation { f: f.map(|c| c.or_zero(valid)), pdf: pdf.or_zero(valid) }
    }
}

impl BrdfParams {
    /// The same parameters in every lane.
    #[inline(always)]
    pub fn splat_lanes<L: Simd>(&self) -> BrdfParams<L> {
        let roughness = Alpha {
            alpha: L::splat(self.roughness.alpha),
            exponent: L::splat(self.roughness.exponent),
        };
        BrdfParams { kd: self.kd.splat_lanes(), ks: self.ks.splat_lanes(), roughness }
    }

    /// All factors of the red channel's value.
    pub fn terms<M: Microfacet>(&self, wo: V3, wi: V3) -> Terms {
        if !is_above::<Above, f32>(wo, wi) {
            return Terms {
                d: 0.0,
                g1i: 0.0,
                g1o: 0.0,
                g: 0.0,
                fresnel: 0.0,
                specular: 0.0,
                pdf_diffuse: 0.0,
                pdf_specular: 0.0,
                p_specular: 0.0,
            };
        }
        let h = wi + wo;
        let h2 = h.length2();
        let d = M::d(self.roughness, h);
        let (gi, go) = (M::g1_over_cos(self.roughness, wi), M::g1_over_cos(self.roughness, wo));
        let (g1i, g1o) = (gi * wi.z, go * wo.z);
        let fresnel = schlick(self.ks, schlick_weight(one_minus_dot(wo, wi, h2))).r;
        let lobe = if self.has_specular() { d * (gi * go * 0.25) } else { 0.0 };
        Terms {
            d,
            g1i,
            g1o,
            g: g1i * g1o,
            fresnel,
            specular: lobe * fresnel,
            pdf_diffuse: cosine_hemisphere_pdf(wi.z),
            pdf_specular: M::pdf_wi(M::pdf_factor(self.roughness, wo), d, (h.z + h.z) / h2),
            p_specular: self.p_specular(wo),
        }
    }
}

/// The cosine that counts, from the signed one: where it is not above 0 there is no light.
pub(super) trait Horizon {
    fn cosine<L: Simd>(cos: L) -> L;
}

/// Directions above the surface count.
pub(super) struct Above;

impl Horizon for Above {
    #[inline(always)]
    fn cosine<L: Simd>(cos: L) -> L {
        cos
    }
}

#[inline(always)]
fn is_above<H: Horizon, L: Simd>(wo: V3<L>, wi: V3<L>) -> L::Mask {
    H::cosine(wo.z).gt(L::splat(0.0)) & H::cosine(wi.z).gt(L::splat(0.0))
}

/// `1 - wi.wm` for the half vector `wm`, without cancellation: |wi - wo|² / (4 (1 + d)).
#[inline(always)]
fn one_minus_dot<L: Simd>(wo: V3<L>, wi: V3<L>, h2: L) -> L {
    let d = (h2.sqrt() * L::splat(0.5)).min(L::splat(1.0));
    (wi - wo).length2() / (L::splat(4.0) * (L::splat(1.0) + d))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{Beckmann, Ggx, Phong, Roughness};
    use crate::math::warp::cosine_hemisphere;

    /// The lobe alone is what the whole has besides the diffuse one, and no light comes of directions
    /// below the surface or of none.
    fn lobe_is_the_rest<M: Microfacet>() {
        let number = |i: u32, by: f32| (i as f32 * by).fract();
        for i in 0..4000 {
            let kd = Rgb::new(number(i, 0.31), number(i, 0.57), number(i, 0.83)) + Rgb::splat(0.01);
            let ks = Rgb::new(number(i, 0.77), number(i, 0.13), number(i, 0.91)) * 0.1;
            let alpha = 0.2 + 0.8 * f64::from(number(i, 0.618_034));
            let roughness = Alpha::from(Roughness::from_alpha(alpha).unwrap());
            let params = BrdfParams { kd, ks, roughness };
            let direction = |a: f32, b: f32| cosine_hemisphere([number(i, a), number(i, b)]);
            let (wo, wi) = (direction(0.414_2, 0.732_05), direction(0.236_07, 0.645_75));
            let seen = params.at_wo::<M>(wo);
            let (f, lobe) = (seen.eval::<M>(wi).f, seen.specular::<M>(wi));
            let pairs = [(f.r, kd.r, lobe.r), (f.g, kd.g, lobe.g), (f.b, kd.b, lobe.b)];
            for (f, kd, lobe) in pairs {
                assert!((f - (kd * INV_PI + lobe)).abs() <= 1e-6 * f, "{wo:?} {wi:?} {f} {lobe}");
            }
            let none = V3::new(f32::NAN, f32::NAN, f32::NAN);
            let below = V3::new(wi.x, wi.y, -wi.z);
            assert!(seen.specular::<M>(below).is_black());
            assert!(params.at_wo::<M>(none).specular::<M>(wi).is_black());
        }
    }

    #[test]
    fn the_lobe_is_what_there_is_besides_the_diffuse_one() {
        lobe_is_the_rest::<Phong>();
        lobe_is_the_rest::<Beckmann>();
        lobe_is_the_rest::<Ggx>();
    }
}
