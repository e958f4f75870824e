//! A model by pointer, with its errata.

use super::Erratum;
use super::below_horizon::{self, BelowHorizon};
use super::models::constant_lobe_choice;
use crate::brdf::{
    Brdf, BrdfParams, Evaluation, LobeSample, Microfacet, Model, ModelVisitor, Normals,
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
    /// The cosine that counts, from the signed one: where it is not above 0 there is no light.
    pub cosine: fn(f32) -> f32,
}

impl Formulas {
    /// Those of a model with its normals drawn this way and with this mistake made.
    pub fn of(model: Model, normals: Normals, erratum: Option<Erratum>) -> Formulas {
        match erratum {
            Some(Erratum::BelowHorizon) => model.visit_normals(normals, FromBothSides),
            Some(Erratum::ConstantLobeChoice) => model.visit_normals(normals, ByConstantChoice),
            _ => model.visit_with(normals, erratum, Pointers),
        }
    }
}

struct Pointers;

impl ModelVisitor for Pointers {
    type Output = Formulas;
    fn visit<M: Microfacet>(self) -> Formulas {
        Formulas {
            at_wo: |params, wo| params.at_wo::<M>(wo),
            eval: |brdf, wi| brdf.eval::<M>(wi),
            sample: |brdf, choice, u| brdf.sample::<M>(choice, u),
            cosine: |cos| cos,
        }
    }
}

/// [`Erratum::BelowHorizon`].
struct FromBothSides;

impl ModelVisitor for FromBothSides {
    type Output = Formulas;
    fn visit<M: Microfacet>(self) -> Formulas {
        Formulas {
            at_wo: |params, wo| params.at_wo::<BelowHorizon<M>>(wo),
            eval: below_horizon::eval::<M>,
            sample: below_horizon::sample::<M>,
            cosine: f32::abs,
        }
    }
}

/// [`Erratum::ConstantLobeChoice`].
struct ByConstantChoice;

impl ModelVisitor for ByConstantChoice {
    type Output = Formulas;
    fn visit<M: Microfacet>(self) -> Formulas {
        Formulas {
            at_wo: |params, wo| constant_lobe_choice(params.at_wo::<M>(wo)),
            ..Pointers.visit::<M>()
        }
    }
}
