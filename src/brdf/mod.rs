//! The BRDF that this project is about.
//!
//! `f(wi, wo) = Kd/pi + D(wm) G(wi, wo) F(wi.wm) / (4 |wi.n| |wo.n|)` in 1/sr, with
//! `wm = normalize(wi + wo)`, Schlick's F, separable `G = G1(wi) G1(wo)`, and a [`Model`]'s D and
//! G1. It is zero unless both directions are above the surface. Ks = (0, 0, 0) means that there
//! is no specular lobe at all. The diffuse part is not reduced by F, so the albedo of a bright
//! material can exceed 1 at grazing; nothing is silently "improved".
//!
//! All directions are local, unit, and leave the surface: z is the shading normal, `wo` points to
//! the viewer, `wi` to the light. Formulas are written for single precision: nothing divides by a
//! cosine, forms `1 - cos²`, or normalises a half vector before its angle is known.

mod beckmann;
mod bsdf;
pub mod errata;
mod fresnel;
mod full_ndf;
mod ggx;
mod phong;
mod roughness;

pub use beckmann::Beckmann;
pub use bsdf::{Brdf, BrdfParams, Evaluation, LobeSample, Terms};
pub use errata::{Erratum, Formulas};
pub(crate) use fresnel::{schlick, schlick_weight};
pub use full_ndf::{FullNdf, Invertible, Normals};
pub use ggx::Ggx;
pub use phong::Phong;
pub use roughness::{Roughness, RoughnessError};

use crate::math::{Simd, V3};

/// Which D and G.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Model {
    /// Phong's D with Beckmann's rational G.
    Phong,
    /// Beckmann's D with its rational G.
    Beckmann,
    /// GGX's D with its exact G.
    Ggx,
}

impl Model {
    /// All of them, in the order of the window's buttons.
    pub const ALL: [Model; 3] = [Model::Phong, Model::Beckmann, Model::Ggx];

    /// Lower-case name, as the command line takes it.
    pub fn name(self) -> &'static str {
        match self {
            Model::Phong => "phong",
            Model::Beckmann => "beckmann",
            Model::Ggx => "ggx",
        }
    }

    /// As a person writes it.
    pub fn title(self) -> &'static str {
        match self {
            Model::Phong => "Phong",
            Model::Beckmann => "Beckmann",
            Model::Ggx => "GGX",
        }
    }

    /// Runs code that is generic over the microfacet model.
    #[inline(always)]
    pub fn visit<V: ModelVisitor>(self, visitor: V) -> V::Output {
        match self {
            Model::Phong => visitor.visit::<Phong>(),
            Model::Beckmann => visitor.visit::<Beckmann>(),
            Model::Ggx => visitor.visit::<Ggx>(),
        }
    }

    /// The same with its normals drawn this way.
    pub fn visit_normals<V: ModelVisitor>(self, normals: Normals, visitor: V) -> V::Output {
        match (self, normals) {
            (Model::Phong, _) => visitor.visit::<Phong>(),
            (Model::Beckmann, Normals::Visible) => visitor.visit::<Beckmann>(),
            (Model::Ggx, Normals::Visible) => visitor.visit::<Ggx>(),
            (Model::Beckmann, Normals::Distribution) => visitor.visit::<FullNdf<Beckmann>>(),
            (Model::Ggx, Normals::Distribution) => visitor.visit::<FullNdf<Ggx>>(),
        }
    }

    /// The same with this mistake made in D, G1, the sampler of normals or their density. An erratum
    /// about another model, about both lobes together or about the tracer leaves the model as it is.
    ///
    /// This compiles the work for 16 models. Where that is too much, [`Formulas`] has them all by
    /// pointer.
    pub fn visit_with<V: ModelVisitor>(
        self,
        normals: Normals,
        erratum: Option<Erratum>,
        visitor: V,
    ) -> V::Output {
        use errata::models::{BeckmannLog10, GgxDAlpha, GgxGSum, PhongExponent};
        type All = FullNdf<Ggx>;
        match (self, normals, erratum) {
            (Model::Beckmann, _, Some(Erratum::BeckmannLog10)) => visitor.visit::<BeckmannLog10>(),
            (Model::Phong, _, Some(Erratum::PhongExponent)) => visitor.visit::<PhongExponent>(),
            (Model::Ggx, Normals::Visible, Some(Erratum::GgxGSum)) => {
                visitor.visit::<GgxGSum<Ggx>>()
            }
            (Model::Ggx, Normals::Visible, Some(Erratum::GgxDAlpha)) => {
                visitor.visit::<GgxDAlpha<Ggx>>()
            }
            (Model::Ggx, _, Some(Erratum::GgxGSum)) => visitor.visit::<GgxGSum<All>>(),
            (Model::Ggx, _, Some(Erratum::GgxDAlpha)) => visitor.visit::<GgxDAlpha<All>>(),
            (_, _, Some(Erratum::BelowHorizon)) => {
                self.visit_normals(normals, errata::below_horizon::Extended(visitor))
            }
            _ => self.visit_normals(normals, visitor),
        }
    }
}

/// Work that is compiled once a model.
pub trait ModelVisitor {
    /// What it returns.
    type Output;
    /// The work.
    fn visit<M: Microfacet>(self) -> Self::Output;
}

/// The roughness of a lobe, in the two forms that the models use.
#[derive(Clone, Copy, Debug)]
pub struct Alpha<L = f32> {
    /// Beckmann's and GGX's alpha.
    pub alpha: L,
    /// Phong's a_p.
    pub exponent: L,
}

impl From<Roughness> for Alpha {
    fn from(r: Roughness) -> Alpha {
        Alpha { alpha: r.alpha() as f32, exponent: r.exponent() as f32 }
    }
}

/// A microfacet model: distribution of normals, masking, and a sampler with its density.
///
/// `w` are unit directions with z > 0. A half vector `h` may have any length above 0.
pub trait Microfacet: Copy + Send + Sync + 'static {
    /// Which one it is.
    const MODEL: Model;

    /// D, the density of microfacet normals per area and solid angle, in 1/sr. The integral of
    /// `D cos` over the hemisphere is 1. Zero for `h.z <= 0`.
    fn d<L: Simd>(roughness: Alpha<L>, h: V3<L>) -> L;

    /// `G1(w) / w.z`, as the source report has it: finite up to the horizon. The rational forms exceed
    /// `1 / w.z` by up to 6.2e-5 of it just below their joint.
    fn g1_over_cos<L: Simd>(roughness: Alpha<L>, w: V3<L>) -> L;

    /// A microfacet normal for the viewer `wo` from two uniform numbers: unit, z >= 0.
    fn sample_wm<L: Simd>(roughness: Alpha<L>, wo: V3<L>, u: [L; 2]) -> V3<L>;

    /// What [`Microfacet::pdf_wi`] needs to know of the viewer.
    fn pdf_factor<L: Simd>(roughness: Alpha<L>, wo: V3<L>) -> L;

    /// The density in 1/sr of `wi` made by reflecting `wo` at [`Microfacet::sample_wm`]'s normal,
    /// from the viewer's [`Microfacet::pdf_factor`], `d` = D(wm) and `cos_over_dot` =
    /// wm.z / (wo.wm). What falls below the horizon is missing from its integral.
    fn pdf_wi<L: Simd>(factor: L, d: L, cos_over_dot: L) -> L;
}

/// Walter et al. 2007's rational G1 of Beckmann, divided by the cosine. Both Beckmann and Phong
/// use it, at the same alpha. Where `a = cot / alpha >= 1.6` it is 1.
#[inline(always)]
fn rational_g1_over_cos<L: Simd>(alpha: L, w: V3<L>) -> L {
    let b = alpha * (w.x * w.x + w.y * w.y).sqrt();
    let a = w.z / b;
    let numerator = L::splat(3.535) + L::splat(2.181) * a;
    let denominator = L::splat(1.0) + a * (L::splat(2.276) + L::splat(2.577) * a);
    let smooth = w.z.ge(L::splat(1.6) * b);
    L::select(smooth, L::splat(1.0) / w.z, numerator / denominator / b)
}

/// `tan²` of the angle between `h` and z.
#[inline(always)]
fn tan2<L: Simd>(h: V3<L>) -> L {
    (h.x * h.x + h.y * h.y) / (h.z * h.z)
}
