//! The progressive core: [`Params`] in, epoch-stamped [`Snapshot`]s out.

mod outlet;
mod params;
mod session;
mod snapshot;
mod work;

pub use crate::trace::Strategy;
pub use params::{Params, ParamsError};
pub use session::{Options, Session, render};
pub use snapshot::{Counts, ErrorEstimate, Snapshot, State, TILE, TileGrid, TileImage, TileRect};
