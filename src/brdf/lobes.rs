//! The two lobes together: value, sampler and density of the whole BRDF.

use super::fresnel::{schlick, schlick_weight};
use super::{Microfacet, Width};
use crate::math::special::INV_PI;
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::math::{Lane, Mask, Rgb, V3};

/// A surface's BRDF parameters.
#[derive(Clone, Copy, Debug)]
pub struct Lobes<L = f32> {
    /// Diffuse reflectance.
    pub kd: Rgb<L>,
    /// Specular reflectance at normal incidence; all zero for no specular lobe.
    pub ks: Rgb<L>,
    /// Roughness.
    pub width: Width<L>,
}

/// The BRDF's value for two directions with the density of finding `wi`.
#[derive(Clone, Copy, Debug)]
pub struct Evaluation<L = f32> {
    /// f in 1/sr, without the cosine.
    pub f: Rgb<L>,
    /// Density of [`Lobes::sample`] at `wi`, in 1/sr, over both lobes.
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
    /// G1 of `wi`, as the seed has it.
    pub g1i: f32,
    /// G1 of `wo`, as the seed has it.
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

impl<L: Lane> Lobes<L> {
    /// Probability of sampling the specular lobe: its share of the reflectance seen from `wo`,
    /// kept within [0.05, 0.95] where both lobes exist. Any value would be unbiased; a share that
    /// followed Ks alone would starve the lobe where F is strong.
    #[inline(always)]
    pub fn p_specular(&self, wo: V3<L>) -> L {
        let zero = L::splat(0.0);
        let specular = schlick(self.ks, schlick_weight(L::splat(1.0) - wo.z)).luminance();
        let diffuse = self.kd.luminance();
        let share = (specular / (specular + diffuse)).max(L::splat(0.05)).min(L::splat(0.95));
        let share = L::select(diffuse.gt(zero), share, L::splat(1.0));
        share.or_zero(self.has_specular())
    }

    /// Whether there is a specular lobe.
    #[inline(always)]
    fn has_specular(&self) -> L::Mask {
        self.ks.max_channel().gt(L::splat(0.0))
    }

    /// Value and density for two unit directions; zero unless both are above the surface.
    #[inline(always)]
    pub fn eval<M: Microfacet>(&self, wo: V3<L>, wi: V3<L>) -> Evaluation<L> {
        let above = above(wo, wi);
        if !self.has_specular().any() {
            return self.diffuse_only(wi, above);
        }
        let h = wi + wo;
        let h2 = h.length2();
        let d = M::d(self.width, h);
        let weight = schlick_weight(one_minus_dot(wo, wi, h2));
        let cos_over_dot = (h.z + h.z) / h2;
        self.combine::<M>(wo, wi, self.p_specular(wo), d, weight, cos_over_dot, above)
    }

    /// A direction for the viewer `wo` (z > 0) from a uniform number for the lobe and two for the
    /// direction. D and F come from the sampled microfacet normal itself, which keeps digits that
    /// the sum `wi + wo` has lost when alpha is small.
    #[inline(always)]
    pub fn sample<M: Microfacet>(&self, wo: V3<L>, choice: L, u: [L; 2]) -> LobeSample<L> {
        if !self.has_specular().any() {
            let wi = cosine_hemisphere(u);
            let e = self.diffuse_only(wi, above(wo, wi));
            return LobeSample { wi, f: e.f, pdf: e.pdf };
        }
        let p = self.p_specular(wo);
        let take_specular = choice.lt(p);
        // What no lane takes is not computed.
        let nothing = V3::splat(L::splat(0.0));
        let wm = if take_specular.any() { M::sample_wm(self.width, wo, u) } else { nothing };
        let dot = wo.dot(wm);
        let mirrored = wm * (dot + dot) - wo;
        let diffuse = if take_specular.all() { nothing } else { cosine_hemisphere(u) };
        let wi = V3::select(take_specular, mirrored, diffuse);
        let h = wi + wo;
        let h2 = h.length2();
        let d = M::d(self.width, V3::select(take_specular, wm, h));
        let away = wo - wm;
        let one_minus_d =
            L::select(take_specular, away.length2() * L::splat(0.5), one_minus_dot(wo, wi, h2));
        let cos_over_dot = L::select(take_specular, wm.z / dot, (h.z + h.z) / h2);
        let facing = dot.gt(L::splat(0.0)) | !take_specular;
        let weight = schlick_weight(one_minus_d);
        let valid = above(wo, wi) & facing;
        let e = self.combine::<M>(wo, wi, p, d, weight, cos_over_dot, valid);
        LobeSample { wi, f: e.f, pdf: e.pdf }
    }

    /// What [`Lobes::combine`] gives where no lane has a specular lobe.
    #[inline(always)]
    fn diffuse_only(&self, wi: V3<L>, valid: L::Mask) -> Evaluation<L> {
        Evaluation {
            f: self.kd.map(|kd| (kd * L::splat(INV_PI)).or_zero(valid)),
            pdf: cosine_hemisphere_pdf(wi.z).or_zero(valid),
        }
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)] // the shared tail of eval and sample
    fn combine<M: Microfacet>(
        &self,
        wo: V3<L>,
        wi: V3<L>,
        p: L,
        d: L,
        weight: L,
        cos_over_dot: L,
        valid: L::Mask,
    ) -> Evaluation<L> {
        let g = M::g1_over_cos(self.width, wi) * M::g1_over_cos(self.width, wo);
        let lobe = (d * (g * L::splat(0.25))).or_zero(self.has_specular());
        let f = self.kd.map(|kd| kd * L::splat(INV_PI)) + schlick(self.ks, weight) * lobe;
        let specular = M::pdf_wi(self.width, wo, d, cos_over_dot).or_zero(p.gt(L::splat(0.0)));
        let pdf = p * specular + (L::splat(1.0) - p) * cosine_hemisphere_pdf(wi.z);
        let valid = valid & pdf.gt(L::splat(0.0));
        Evaluation { f: f.map(|c| c.or_zero(valid)), pdf: pdf.or_zero(valid) }
    }
}

impl Lobes {
    /// All factors of the red channel's value.
    pub fn terms<M: Microfacet>(&self, wo: V3, wi: V3) -> Terms {
        if !above(wo, wi) {
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
        let d = M::d(self.width, h);
        let (gi, go) = (M::g1_over_cos(self.width, wi), M::g1_over_cos(self.width, wo));
        let fresnel = schlick(self.ks, schlick_weight(one_minus_dot(wo, wi, h2))).r;
        let lobe = if self.has_specular() { d * (gi * go * 0.25) } else { 0.0 };
        Terms {
            d,
            g1i: gi * wi.z,
            g1o: go * wo.z,
            g: (gi * wi.z) * (go * wo.z),
            fresnel,
            specular: lobe * fresnel,
            pdf_diffuse: cosine_hemisphere_pdf(wi.z),
            pdf_specular: M::pdf_wi(self.width, wo, d, (h.z + h.z) / h2),
            p_specular: self.p_specular(wo),
        }
    }
}

#[inline(always)]
fn above<L: Lane>(wo: V3<L>, wi: V3<L>) -> L::Mask {
    wo.z.gt(L::splat(0.0)) & wi.z.gt(L::splat(0.0))
}

/// `1 - wi.wm` for the half vector `wm`, without cancellation: |wi - wo|² / (4 (1 + d)).
#[inline(always)]
fn one_minus_dot<L: Lane>(wo: V3<L>, wi: V3<L>, h2: L) -> L {
    let d = (h2.sqrt() * L::splat(0.5)).min(L::splat(1.0));
    (wi - wo).length2() / (L::splat(4.0) * (L::splat(1.0) + d))
}
