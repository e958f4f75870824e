//! The progressive core: [`Params`] in, epoch-stamped [`Snapshot`]s out.

mod accumulator;
mod choose_group;
mod control;
mod driver;
mod epoch;
mod experiment;
mod first_hits;
mod mailbox;
mod pair_queue;
mod params;
mod parts;
mod plan;
mod probe;
mod recipe;
mod replay;
mod sample_buffer;
mod session;
mod sheet;
mod snapshot;
mod stop;
mod turn;
mod work;

pub use crate::film::{ErrorEstimate, Figure, Interval};
pub use crate::trace::Strategy;
pub use control::Options;
pub use experiment::{Difference, Experiment, ExperimentError, Goal};
pub use params::{Params, ParamsError};
pub use parts::part;
pub use probe::{LogHistogram, PixelReport, ProbeEstimate, Technique, probe};
pub use recipe::{
    ErrorRecipe, FileRecipe, MaterialRecipe, Recipe, RecipeError, SceneRecipe, ToneRecipe,
};
pub use replay::{Replay, Sample};
pub use session::{KeptPictures, Session, render};
pub use sheet::{Sheet, SheetError, SheetProgress, TracedCell, TracedSheet};
pub use snapshot::{Counts, Snapshot, State, TILE, TileGrid, TileImage, TileRect};
pub use stop::StopRule;
