//! The BRDF: Kd/pi + D G F / (4 |wi.n| |wo.n|), over local directions.

mod roughness;

pub use roughness::{Roughness, RoughnessError};

/// Which D and G.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Model {
    /// Phong's D with Beckmann's rational G.
    Phong,
    /// Beckmann's D with its rational G.
    Beckmann,
    /// GGX's D with its exact G.
    Ggx,
}

impl Model {
    /// All of them, in the order of the window's buttons.
    pub const ALL: [Model; 3] = [Model::Phong, Model::Beckmann, Model::Ggx];

    /// Lower-case name, as the command line takes it.
    pub fn name(self) -> &'static str {
        match self {
            Model::Phong => "phong",
            Model::Beckmann => "beckmann",
            Model::Ggx => "ggx",
        }
    }

    /// As a person writes it.
    pub fn title(self) -> &'static str {
        match self {
            Model::Phong => "Phong",
            Model::Beckmann => "Beckmann",
            Model::Ggx => "GGX",
        }
    }
}
