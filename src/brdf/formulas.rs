//! A model by pointer.

use super::{
    Brdf, BrdfParams, Erratum, Evaluation, LobeSample, Microfacet, Model, ModelVisitor, Normals,
};
use crate::math::V3;

/// A model's functions by pointer, in single precision: for those to whom the choice among all
/// [variants](Model::visit_with) at run time matters more than speed.
#[derive(Clone, Copy, Debug)]
pub struct Formulas {
    /// [`BrdfParams::at_wo`].
    pub at_wo: fn(&BrdfParams, V3) -> Brdf,
    /// [`Brdf::eval`].
    pub eval: fn(&Brdf, V3) -> Evaluation,
    /// [`Brdf::sample`].
    pub sample: fn(&Brdf, f32, [f32; 2]) -> LobeSample,
    /// [`Microfacet::cosine`].
    pub cosine: fn(f32) -> f32,
}

impl Formulas {
    /// Those of a model with its normals drawn this way and with this mistake made.
    pub fn of(model: Model, normals: Normals, erratum: Option<Erratum>) -> Formulas {
        struct Pointers;
        impl ModelVisitor for Pointers {
            type Output = Formulas;
            fn visit<M: Microfacet>(self) -> Formulas {
                Formulas {
                    at_wo: |params, wo| params.at_wo::<M>(wo),
                    eval: |brdf, wi| brdf.eval::<M>(wi),
                    sample: |brdf, choice, u| brdf.sample::<M>(choice, u),
                    cosine: |cos| M::cosine(cos),
                }
            }
        }
        model.visit_with(normals, erratum, Pointers)
    }
}
