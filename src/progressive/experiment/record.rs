//! What stands in an experiment's file besides its recipe and its tables.

use serde::{Deserialize, Serialize};

/// What an experiment is to become, and of which file's scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Goal {
    /// The number of the pass before which this render is to end, if it is known.
    pub end: Option<u64>,
    /// Passes of the whole picture, of which this may be a part.
    pub passes: Option<u64>,
    /// The scene as the command line calls it; nothing for the built-in one.
    pub scene: Option<String>,
}

impl Goal {
    /// Of two parts together: of a whole picture that ends where the one does that is to be longer.
    pub(super) fn of_both(&self, other: &Goal) -> Goal {
        let passes = self.passes.max(other.passes);
        Goal { end: passes, passes, scene: self.scene.clone() }
    }
}

/// The text that is beside the recipe.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    /// Version of this form, [`Record::VERSION`].
    pub(super) experiment: u32,
    pub(super) spans: Vec<[u64; 2]>,
    pub(super) goal: Goal,
    /// After how many passes numbers of samples were last chosen.
    pub(super) planned_at: Option<u64>,
    pub(super) quantum: i32,
    pub(super) alphas: Vec<f64>,
    pub(super) chosen: bool,
}

impl Record {
    pub(super) const VERSION: u32 = 2;
}
