//! Scenes whose picture is known exactly: the whole renderer against the truth.
//!
//! [`all`] gives 139 scenes with answers from closed forms and quadratures, each with the bound of
//! its own error; what this program cannot express is listed beside them with the reason. A scene
//! is built, rendered by a [`crate::progressive::Session`] like any other, and judged:
//!
//! 1. `|mean - expected| <= 4 standard errors + allowance`, where the allowance is the answer's
//!    own error and the stated bound of what the construction differs from the scene (a far camera
//!    for an orthographic one, facets for a cap, rounding errors of single precision);
//! 2. the same within `4 * budget.relative` of the expected value: 1e-3 at [`CaseBudget::FULL`].
//!
//! Those answers are computed without a line of this program, in double precision: Lambert's and
//! Howell's form factors, quadratures of the BRDF over solid angle, integral equations by Nyström's
//! method. `assets/exact_scenes.json` names the method of each.
//!
//! [`drawn`] gives as many more as are wanted: the same groups with parameters drawn at random,
//! each turned, scaled (1e-4 to 1e4) and moved (up to 1e5 of its size), on all instruction sets in
//! turn. Their answers are computed here by the same methods, written anew; a test holds them
//! against the table.

mod drawn;
mod emitters;
mod factors;
mod glossy;
mod group;
mod known;
mod lobes;
mod quantity;
mod rooms;
mod run;
mod stage;
mod table;
mod transport;

pub use drawn::drawn;
pub use known::Known;
pub use run::{CaseBudget, CaseOutcome, CaseVerdict, ExactSummary, run_all};
pub use table::{Case, CaseTable, LeftOut, all};

use crate::brdf::RoughnessError;
use crate::progressive::ParamsError;
use crate::scene::{CameraError, MaterialError, ShapeError};
use thiserror::Error;

/// A fault of the table or of the program: none of these depends on a user.
#[derive(Debug, Error)]
pub enum ExactError {
    /// The table of answers is not what its reader expects.
    #[error("the table of exact scenes is broken: {0}")]
    CaseTable(#[from] serde_json::Error),
    /// A quantity that its group does not have.
    #[error("the table of exact scenes asks for `{0}`, which its group does not have")]
    Quantity(String),
    /// A number that a material cannot have.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A roughness out of range.
    #[error(transparent)]
    Roughness(#[from] RoughnessError),
    /// A shape out of reach.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A camera that takes no picture.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// What the renderer refuses.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// What stopped the renderer.
    #[error("{0}")]
    Failed(String),
}
