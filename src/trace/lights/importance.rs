//! How much light may come from where: what lights are chosen by.
//!
//! An estimate never looks at what is in between. It is 0 only where a light lies wholly below the
//! horizon or is seen exactly edge on, so that no light that could contribute is left out; where a
//! light has an extent, cosines and the BRDF's lobe are taken at their best over it.

use crate::brdf::BrdfParams;
use crate::math::record::gather_record;
use crate::math::simd::Simd;
use crate::math::special::INV_PI;
use crate::math::{Frame, Mask, V3};
use std::f32::consts::PI;

/// Keeps divisions by sizes and distances finite.
const TINY: f32 = 1e-12;
/// A half vector's height is taken to be at least this.
const LEAST_HEIGHT: f32 = 0.01;
/// What light sampling the environment is worth: sampling the BRDF finds it just as well.
const ENVIRONMENT_SHARE: f32 = 0.5;

/// Where light is wanted.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct LightSampleContext<L: Simd = f32> {
    /// The surface's point.
    pub(in crate::trace) p: V3<L>,
    /// Around the shading normal, which faces the viewer.
    pub(in crate::trace) frame: Frame<L>,
    /// The viewer's side, where the choice may depend on it.
    pub(in crate::trace) glossy: Option<GlossyContext<L>>,
}

impl<L: Simd> LightSampleContext<L> {
    /// How many numbers there are: of the point, of point and normal, of everything.
    pub(in crate::trace) const POINT: usize = 3;
    pub(in crate::trace) const SURFACE: usize = 6;
    pub(in crate::trace) const NUMBERS: usize = 13;

    /// A surface with this frame, and, at the camera's or `first` vertex, with what the viewer `wo` sees there.
    /// Later vertices may have several viewers, which have to agree on the densities.
    #[inline(always)]
    pub(in crate::trace) fn new(
        p: V3<L>,
        frame: Frame<L>,
        first: bool,
        params: &BrdfParams<L>,
        wo: V3<L>,
    ) -> LightSampleContext<L> {
        let glossy = if first { Some(GlossyContext::new(params, wo)) } else { None };
        LightSampleContext { p, frame, glossy }
    }

    /// To be kept.
    #[inline(always)]
    pub(in crate::trace) fn numbers(&self) -> [L; 13] {
        let (p, n, zero) = (self.p, self.frame.n, L::splat(0.0));
        match &self.glossy {
            Some(GlossyContext { wo, diffuse, specular, alpha2, masking }) => {
                let [d, s, a, m] = [*diffuse, *specular, *alpha2, *masking];
                [p.x, p.y, p.z, n.x, n.y, n.z, wo.x, wo.y, wo.z, d, s, a, m]
            }
            None => {
                let o = zero;
                [p.x, p.y, p.z, n.x, n.y, n.z, o, o, o, o, o, o, o]
            }
        }
    }

    /// From [`LightSampleContext::numbers`], with or without what is seen.
    #[inline(always)]
    pub(in crate::trace) fn from_numbers(f: &[L; 13], glossy: bool) -> LightSampleContext<L> {
        let v = |i: usize| V3::new(f[i], f[i + 1], f[i + 2]);
        let [diffuse, specular, alpha2, masking] = [f[9], f[10], f[11], f[12]];
        let glossy = if glossy {
            Some(GlossyContext { wo: v(6), diffuse, specular, alpha2, masking })
        } else {
            None
        };
        LightSampleContext { p: v(0), frame: Frame::around(v(3)), glossy }
    }
}

/// What a viewer sees of a surface, as far as it decides which light matters.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct GlossyContext<L: Simd = f32> {
    /// Towards the viewer, in the frame.
    wo: V3<L>,
    /// Diffuse and specular reflectance in luminance.
    diffuse: L,
    specular: L,
    alpha2: L,
    /// A quarter of G1(wo) over its cosine.
    masking: L,
}

impl<L: Simd> GlossyContext<L> {
    /// Every model's lobe is taken for GGX's, whose tails are the longest.
    #[inline(always)]
    pub(in crate::trace) fn new(params: &BrdfParams<L>, wo: V3<L>) -> GlossyContext<L> {
        let [diffuse, specular] = params.reflectances(wo);
        let alpha2 = params.roughness.alpha.sqr();
        let across = alpha2 * (wo.x * wo.x + wo.y * wo.y);
        let masking = L::splat(0.5) / (wo.z + (wo.z * wo.z + across).sqrt());
        GlossyContext { wo, diffuse, specular, alpha2, masking }
    }
}

gather_record! {
    /// The extent, power and directions of a light or of several. Sides of a surface emit alike.
    pub(super) struct LightBounds {
        pub(super) centre: V3,
        /// Half the box's size.
        pub(super) half: V3,
        /// All is within this of the centre.
        pub(super) radius: f32,
        /// All normals are within a cone about this, either way round...
        pub(super) axis: V3,
        /// ...of this half angle, at most a right one.
        pub(super) cos: f32,
        pub(super) sin: f32,
        /// How far off the centre a plane along a normal may pass: 0 for one flat light.
        pub(super) slack: f32,
        /// As large as seen from the front.
        pub(super) area: f32,
        /// Of the radiance, on the mean over the area; in units of the brightest light's.
        pub(super) luminance: f32,
    }
}

impl<L: Simd> LightBounds<L> {
    /// The light that may come to a surface: irradiance, or radiance to the viewer where he is
    /// known.
    #[inline(always)]
    pub(super) fn estimate(&self, to: &LightSampleContext<L>) -> L {
        let (zero, one, tiny) = (L::splat(0.0), L::splat(1.0), L::splat(TINY));
        let away = self.centre - to.p;
        let distance2 = away.length2();
        let distance = distance2.sqrt();
        // Of a flat light the height above its plane is the same everywhere on it.
        let along = self.axis.dot(away).abs();
        let within = along.ge(distance * self.cos);
        let mut height = L::select(within, distance, along * self.cos);
        if !within.all() && self.sin.gt(zero).any() {
            let tilted = height + (distance2 - along * along).max(zero).sqrt() * self.sin;
            height = L::select(within, distance, tilted);
        }
        let height = height + self.slack;
        let nearest = (distance - self.radius).max(height).max(tiny);
        let reach = distance.max(self.radius);
        // The surface's cosine times the distance: its mean over the part above the horizon, for
        // heights spread evenly.
        let n = to.frame.n;
        let z = n.dot(away);
        let spread = n.abs().dot(self.half).min(self.radius);
        let above = (z + spread).max(zero);
        let whole = z.ge(spread);
        let rise = L::select(whole, z, above * above);
        let over = L::select(whole, one, (spread * L::splat(4.0)).max(tiny));
        let solid_angle = self.area * height / (nearest * reach * reach);
        let cos = (rise / (over * reach)).min(one);
        let Some(glossy) = &to.glossy else { return self.luminance * (solid_angle * cos) };
        let diffuse = glossy.diffuse * L::splat(INV_PI) * (solid_angle * cos);
        if !glossy.specular.gt(zero).any() {
            return self.luminance * diffuse;
        }
        // The lobe at the half vector nearest to the normal that the light's extent allows; it
        // cannot reflect more than all.
        let inverse = one / distance.max(tiny);
        let h = to.frame.to_local(away) * inverse + glossy.wo;
        let inside = distance.le(self.radius);
        let off = ((h.x * h.x + h.y * h.y).sqrt() - self.radius * inverse).max(zero);
        let across = L::select(inside, zero, off * off);
        let up = h.z.max(L::splat(LEAST_HEIGHT));
        let up = up * up;
        let t = (across + up) / (glossy.alpha2 * up + across);
        let d = glossy.alpha2 * (t * t) * L::splat(INV_PI);
        let share = (solid_angle * (d * glossy.masking)).min(one);
        self.luminance * (diffuse + (glossy.specular * share).or_zero(rise.gt(zero)))
    }
}

/// A light, or several, from far away.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct LightDisc {
    pub(in crate::trace) centre: V3,
    /// Of a disc as large as it is seen.
    pub(in crate::trace) radius: f32,
    /// The disc's area times the luminance, in units of the brightest light's.
    pub(in crate::trace) intensity: f32,
}

impl LightBounds {
    pub(super) fn disc(&self) -> LightDisc {
        let radius = (self.area * INV_PI).sqrt();
        LightDisc { centre: self.centre, radius, intensity: self.area * self.luminance }
    }
}

/// [`LightBounds::estimate`] of a uniform environment.
#[inline(always)]
pub(super) fn environment<L: Simd>(luminance: f32, to: &LightSampleContext<L>) -> L {
    let share = L::splat(luminance * ENVIRONMENT_SHARE);
    match &to.glossy {
        Some(glossy) => share * (glossy.diffuse + glossy.specular),
        None => share * L::splat(PI),
    }
}
