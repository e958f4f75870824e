//! The progressive core: [`Params`] in, epoch-stamped [`Snapshot`]s out.

mod params;
mod session;
mod snapshot;

pub use params::{Params, ParamsError};
pub use session::Session;
pub use snapshot::{Counts, ErrorEstimate, Snapshot, State, TILE, TileGrid, TileImage, TileRect};
