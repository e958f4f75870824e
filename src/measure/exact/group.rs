//! The kinds of scene whose answers are known.

use super::stage::{ExactStage, Where};
use super::{ExactError, emitters, glossy, rooms};
use serde::Deserialize;

/// A kind of scene with its parameters.
#[derive(Debug, Deserialize)]
#[serde(tag = "group", rename_all = "snake_case")]
pub(super) enum Group {
    Furnace(rooms::Furnace),
    PlaneSphere(emitters::PlaneSphere),
    PlaneRect(emitters::PlaneRect),
    PlaneDisk(emitters::PlaneDisk),
    PlaneQuad(emitters::PlaneQuad),
    Dome(glossy::Dome),
    Ball(glossy::Ball),
    SpecRect(glossy::SpecRect),
    SpecSphere(glossy::SpecSphere),
    Mirror(glossy::Mirror),
    #[serde(rename = "plates")]
    ParallelPlanes(rooms::ParallelPlanes),
    Concentric(rooms::Concentric),
    Integrating(rooms::Integrating),
    Cavity(rooms::Cavity),
}

impl Group {
    pub(super) fn name(&self) -> &'static str {
        match self {
            Group::Furnace(_) => "white furnace",
            Group::PlaneSphere(_) | Group::PlaneRect(_) => "form factor",
            Group::PlaneDisk(_) | Group::PlaneQuad(_) => "form factor",
            Group::Dome(_) => "dome",
            Group::Ball(_) => "ball",
            Group::SpecRect(_) | Group::SpecSphere(_) => "glossy direct light",
            Group::Mirror(_) => "mirror limit",
            Group::ParallelPlanes(_) => "parallel plates",
            Group::Concentric(_) => "concentric spheres",
            Group::Integrating(_) => "integrating sphere",
            Group::Cavity(_) => "glossy cavity",
        }
    }

    pub(super) fn stage(&self, quantity: &str, at: Where) -> Result<ExactStage, ExactError> {
        match self {
            Group::Furnace(s) => s.stage(quantity, at),
            Group::PlaneSphere(s) => s.stage(at),
            Group::PlaneRect(s) => s.stage(at),
            Group::PlaneDisk(s) => s.stage(at),
            Group::PlaneQuad(s) => s.stage(at),
            Group::Dome(s) => s.stage(at),
            Group::Ball(s) => s.stage(at),
            Group::SpecRect(s) => s.stage(at),
            Group::SpecSphere(s) => s.stage(at),
            Group::Mirror(s) => s.stage(at),
            Group::ParallelPlanes(s) => s.stage(quantity, at),
            Group::Concentric(s) => s.stage(quantity, at),
            Group::Integrating(s) => s.stage(quantity, at),
            Group::Cavity(s) => s.stage(quantity, at),
        }
    }
}
