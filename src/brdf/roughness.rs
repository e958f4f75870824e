//! The one place where a Phong exponent becomes a roughness and back.

use thiserror::Error;

/// How rough a surface is: the width `alpha` of Beckmann and GGX and the Phong exponent `a_p`
/// are two names of one number, `alpha = sqrt(2 / (a_p + 2))` (Walter et al. 2007).
///
/// Always within [`Roughness::ALPHA`], which is the same range as [`Roughness::EXPONENT`]. Equal
/// alpha is a convention, not an equal look: GGX has longer tails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    alpha: f64,
    exponent: f64,
}

/// A roughness outside what single-precision directions can resolve.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("{quantity} must be from {min} to {max}, not {value}")]
pub struct RoughnessError {
    /// "roughness alpha" or "Phong exponent a_p".
    pub quantity: &'static str,
    /// What was given.
    pub value: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
}

impl Roughness {
    /// Smallest and largest alpha.
    pub const ALPHA: [f64; 2] = [1e-4, 1.0];
    /// Smallest and largest Phong exponent; larger is smoother.
    pub const EXPONENT: [f64; 2] = [0.0, 2e8 - 2.0];

    /// From the width alpha in 1e-4..=1.
    pub fn from_alpha(alpha: f64) -> Result<Roughness, RoughnessError> {
        let [min, max] = Self::ALPHA;
        if !(min..=max).contains(&alpha) {
            return Err(RoughnessError { quantity: "roughness alpha", value: alpha, min, max });
        }
        Ok(Roughness { alpha, exponent: 2.0 / (alpha * alpha) - 2.0 })
    }

    /// From the Phong exponent a_p in 0..=2e8 - 2.
    pub fn from_exponent(exponent: f64) -> Result<Roughness, RoughnessError> {
        let [min, max] = Self::EXPONENT;
        if !(min..=max).contains(&exponent) {
            return Err(RoughnessError {
                quantity: "Phong exponent a_p",
                value: exponent,
                min,
                max,
            });
        }
        Ok(Roughness { alpha: (2.0 / (exponent + 2.0)).sqrt(), exponent })
    }

    /// The width alpha of Beckmann and GGX.
    pub fn alpha(self) -> f64 {
        self.alpha
    }

    /// The Phong exponent a_p.
    pub fn exponent(self) -> f64 {
        self.exponent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_both_ranges_agree() {
        for (alpha, exponent) in [(1.0, 0.0), (1e-4, 2e8 - 2.0)] {
            let a = Roughness::from_alpha(alpha).unwrap();
            let e = Roughness::from_exponent(exponent).unwrap();
            assert!((a.exponent() - exponent).abs() <= 1e-6 * (1.0 + exponent));
            assert!((e.alpha() - alpha).abs() <= 1e-12);
        }
    }

    #[test]
    fn outside_is_an_error_that_names_the_range() {
        for bad in [0.0, 9.9e-5, 1.0001, f64::NAN, -1.0, f64::INFINITY] {
            let e = Roughness::from_alpha(bad).unwrap_err().to_string();
            assert!(e.contains("0.0001 to 1"), "{e}");
        }
        for bad in [-0.1, 2e8, f64::NAN] {
            assert!(Roughness::from_exponent(bad).is_err());
        }
    }
}
