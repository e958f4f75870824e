//! Scenes drawn at random: the engine's pictures against the reference tracer's.
//!
//! [`RandomScene::draw`] makes a scene of nothing but a seed: a room or open ground, solids, emitters
//! of every shape that hang free, touch surfaces, lie in them, or reflect themselves, materials of
//! every roughness, a depth limit, a camera, and a rotation, a scale and a place. [`judge`] holds
//! the engine's pictures of it, as users get them (paths share, emitters are looked for by split rays),
//! against those of the reference tracer, which share with it nothing but the scene, the formulas
//! of the lobes and the sampling of lights.
//!
//! Means are compared over sixteen regions and the whole. What a sharp lobe sends is rare and
//! bright, so that a mean of many pictures may be far from normal, and a single test at a level of
//! one in millions would lie. So a difference is *looked at* up to [`LOOKS`] times, each time on
//! pictures of new seeds and of more passes: only a region that is beyond [`SUSPECT`] standard
//! errors on the same side each time, and by more than [`EFFECT`] of the scene's mean at the last,
//! differs. With normal means that happens to a right program in one scene of 1e9.

mod draw;
mod emitter_kind;
mod emitters;
mod judge;
mod room;
mod stage;

pub use draw::RandomScene;
pub use emitter_kind::EmitterKind;
pub use judge::{
    Budget, EFFECT, JudgedScene, LOOKS, Look, REGIONS, RandomSummary, Region, SUSPECT, Verdict,
    judge, run,
};

use crate::brdf::RoughnessError;
use crate::progressive::ParamsError;
use crate::scene::{CameraError, MaterialError, ShapeError};
use thiserror::Error;

/// A fault of the program: none of these depends on a user.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RandomError {
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
