//! What a surface is made of.

use crate::brdf::{Roughness, RoughnessError};
use crate::plain::number;
use thiserror::Error;

/// Index of a material in its scene.
pub type MaterialId = u32;

/// A surface: diffuse Kd, specular Ks at normal incidence, roughness, emitted radiance.
///
/// Colours are linear Rec. 709. Ks = (0, 0, 0) means that there is no specular lobe at all.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What the window calls it.
    pub name: String,
    /// Diffuse reflectance Kd, each channel in 0..=1.
    pub kd: [f32; 3],
    /// Specular reflectance at normal incidence Ks, each channel in 0..=1.
    pub ks: [f32; 3],
    /// Roughness of the specular lobe, the same number for all three models.
    pub roughness: Roughness,
    /// Radiance leaving every point in every direction, both sides, W/(m² sr) per channel.
    pub emission: [f32; 3],
}

fn numbers(all: &[f64; 3]) -> String {
    all.map(number).join(" ")
}

/// A number that a material cannot have.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MaterialError {
    /// A reflectance outside 0..=1.
    #[error("{name} must be three numbers from 0 to 1, not {}", numbers(.value))]
    Reflectance {
        /// "Kd" or "Ks".
        name: &'static str,
        /// What was given.
        value: [f64; 3],
    },
    /// A negative, infinite or undefined emission.
    #[error(
        "emitted radiance must be three finite numbers of at least 0 (at most 1e18), not {}",
        numbers(.0)
    )]
    Emission([f64; 3]),
    /// The roughness is out of range.
    #[error(transparent)]
    Roughness(#[from] RoughnessError),
}

impl Material {
    /// Largest radiance accepted, so that squares stay finite in single precision.
    pub const MAX_EMISSION: f64 = 1e18;

    /// A reflecting surface from Kd, Ks and the Phong exponent a_p.
    pub fn reflecting(
        name: impl Into<String>,
        kd: [f64; 3],
        ks: [f64; 3],
        exponent: f64,
    ) -> Result<Material, MaterialError> {
        Ok(Material {
            name: name.into(),
            kd: reflectance("Kd", kd)?,
            ks: reflectance("Ks", ks)?,
            roughness: Roughness::from_exponent(exponent)?,
            emission: [0.0; 3],
        })
    }

    /// A black surface that emits.
    pub fn light(name: impl Into<String>, radiance: [f64; 3]) -> Result<Material, MaterialError> {
        Material::reflecting(name, [0.0; 3], [0.0; 3], 0.0)?.emitting(radiance)
    }

    /// The same surface with this emission.
    pub fn emitting(mut self, radiance: [f64; 3]) -> Result<Material, MaterialError> {
        if !radiance.iter().all(|c| (0.0..=Self::MAX_EMISSION).contains(c)) {
            return Err(MaterialError::Emission(radiance));
        }
        self.emission = radiance.map(|c| c as f32);
        Ok(self)
    }

    /// True when any channel emits.
    pub fn emits(&self) -> bool {
        self.emission.iter().any(|&c| c > 0.0)
    }
}

fn reflectance(name: &'static str, value: [f64; 3]) -> Result<[f32; 3], MaterialError> {
    if value.iter().all(|c| (0.0..=1.0).contains(c)) {
        Ok(value.map(|c| c as f32))
    } else {
        Err(MaterialError::Reflectance { name, value })
    }
}
