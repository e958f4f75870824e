//! The model as the textbook has it, in double precision.
//!
//! Nothing here is shared with the code under test: angles and plain formulas (Walter et al. 2007,
//! equations for D and G1; Schlick 1994 for F), written for reading and not for speed.

use crate::brdf::{Alpha, Model, Roughness};
use std::f64::consts::PI;

/// A model at a roughness.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceBrdf {
    /// Which D and G.
    pub model: Model,
    /// Width of the distribution.
    pub alpha: f64,
    /// Phong's exponent a_p.
    pub exponent: f64,
}

impl ReferenceBrdf {
    /// At an exact roughness.
    pub fn new(model: Model, roughness: Roughness) -> ReferenceBrdf {
        ReferenceBrdf { model, alpha: roughness.alpha(), exponent: roughness.exponent() }
    }

    /// At the very numbers that single-precision code works with, so that what is compared is its
    /// arithmetic alone.
    pub fn of_width(model: Model, roughness: Alpha) -> ReferenceBrdf {
        ReferenceBrdf { model, alpha: roughness.alpha.into(), exponent: roughness.exponent.into() }
    }

    /// D of a normal with this squared tangent to z, in 1/sr.
    pub fn d(&self, tan2: f64) -> f64 {
        let cos2 = 1.0 / (1.0 + tan2);
        let a2 = self.alpha * self.alpha;
        match self.model {
            Model::Phong => {
                let a = self.exponent;
                (a + 2.0) / (2.0 * PI) * (-0.5 * a * tan2.ln_1p()).exp()
            }
            Model::Beckmann => (-tan2 / a2).exp() / (PI * a2 * cos2 * cos2),
            Model::Ggx => a2 / (PI * cos2 * cos2 * (a2 + tan2) * (a2 + tan2)),
        }
    }

    /// G1 of a direction of these cosine and sine to z; the cosine is above 0. Phong and Beckmann:
    /// Walter's rational form.
    pub fn g1(&self, cos: f64, sin: f64) -> f64 {
        match self.model {
            Model::Ggx => 2.0 / (1.0 + (1.0 + (self.alpha * sin / cos).powi(2)).sqrt()),
            Model::Phong | Model::Beckmann => {
                let a = cos / (self.alpha * sin);
                if a >= KINK || sin == 0.0 {
                    1.0
                } else {
                    (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
                }
            }
        }
    }

    /// f in 1/sr of directions above the surface, which need be unit to single precision only: a
    /// diffuse and a specular lobe of one channel.
    pub fn f(&self, kd: f64, ks: f64, wo: [f64; 3], wi: [f64; 3]) -> f64 {
        let h = [wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]];
        let across = h[0] * h[0] + h[1] * h[1];
        let length = (across + h[2] * h[2]).sqrt();
        // wi.m of unit vectors: half the length of their sum.
        let d = (length / 2.0).min(1.0);
        let fresnel = ks + (1.0 - ks) * (1.0 - d).powi(5);
        let g = |w: [f64; 3]| self.g1(w[2], w[0].hypot(w[1]));
        let lobe = self.d(across / (h[2] * h[2])) * g(wi) * g(wo) / (4.0 * wi[2] * wo[2]);
        kd / PI + fresnel * lobe
    }
}

/// Where the rational G1 becomes 1, in `cot / alpha`.
pub const KINK: f64 = 1.6;
