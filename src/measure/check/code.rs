//! The code under test: the very functions that render, by pointer, so that the proofs are compiled
//! once and not once a model.

use crate::brdf::errata::lobe_frame;
use crate::brdf::{Alpha, Erratum, Formulas, Microfacet, Model, ModelVisitor, Normals};
use crate::math::{Frame, V3};

/// A model's functions in single precision.
#[derive(Clone, Copy)]
pub(super) struct Code {
    /// [`Microfacet::d`].
    pub d: fn(Alpha, V3) -> f32,
    /// [`Microfacet::g1_over_cos`].
    pub g1_over_cos: fn(Alpha, V3) -> f32,
    /// [`Microfacet::sample_wm`].
    pub sample_wm: fn(Alpha, V3, [f32; 2]) -> V3,
    /// The density of those normals, per solid angle of the normal: of `wo` and a unit `wm`.
    pub normal_pdf: fn(Alpha, V3, V3) -> f32,
    /// Value, sampler and density of the whole BRDF.
    pub formulas: Formulas,
    /// The axes about a normal in which a lobe is sampled.
    pub frame: fn(V3) -> Frame,
}

impl Code {
    pub(super) fn of(model: Model, normals: Normals, erratum: Option<Erratum>) -> Code {
        struct Pointers(Formulas, fn(V3) -> Frame);
        impl ModelVisitor for Pointers {
            type Output = Code;
            fn visit<M: Microfacet>(self) -> Code {
                Code {
                    d: |roughness, h| M::d(roughness, h),
                    g1_over_cos: |roughness, w| M::g1_over_cos(roughness, w),
                    sample_wm: |roughness, wo, u| M::sample_wm(roughness, wo, u),
                    normal_pdf: |roughness, wo, wm| {
                        // Of `wi` there is 1 / (4 wo.wm) as much as of `wm`.
                        let (d, dot) = (M::d(roughness, wm), wo.dot(wm));
                        let pdf = M::pdf_wi(M::pdf_factor(roughness, wo), d, wm.z / dot);
                        (pdf * 4.0 * dot).max(0.0)
                    },
                    formulas: self.0,
                    frame: self.1,
                }
            }
        }
        let frame: fn(V3) -> Frame = match erratum {
            Some(Erratum::LobeFramePole) => lobe_frame,
            _ => |n| Frame::around(n),
        };
        let formulas = Formulas::of(model, normals, erratum);
        model.visit_with(normals, erratum, Pointers(formulas, frame))
    }
}
