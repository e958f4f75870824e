//! A model by pointer.

use super::{
    Erratum, Evaluation, LobeSample, Lobes, Microfacet, Model, ModelVisitor, Normals, View,
};
use crate::math::V3;

/// A model's functions by pointer, in single precision: for those to whom the choice among all
/// [variants](Model::visit_with) at run time matters more than speed.
#[derive(Clone, Copy, Debug)]
pub struct Formulas {
    /// [`Lobes::seen_from`].
    pub seen_from: fn(&Lobes, V3) -> View,
    /// [`View::eval`].
    pub eval: fn(&View, V3) -> Evaluation,
    /// [`View::sample`].
    pub sample: fn(&View, f32, [f32; 2]) -> LobeSample,
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
                    seen_from: |lobes, wo| lobes.seen_from::<M>(wo),
                    eval: |view, wi| view.eval::<M>(wi),
                    sample: |view, choice, u| view.sample::<M>(choice, u),
                    cosine: |cos| M::cosine(cos),
                }
            }
        }
        model.visit_with(normals, erratum, Pointers)
    }
}
