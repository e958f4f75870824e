//! The measurements of one scene, for the table, the sheet and the plot.

use burnish::measure::speed::{SpeedExperiment, SpeedPlan, Summary};

/// Measurements of one scene.
pub(super) struct Measured {
    pub(super) scene: String,
    pub(super) plan: SpeedPlan,
    /// The reference, in words.
    pub(super) truth: String,
    pub(super) experiment: SpeedExperiment,
    pub(super) summaries: Vec<Summary>,
    /// Most memory the program held so far, in MiB, where the system tells.
    pub(super) peak_mib: Option<f64>,
}
