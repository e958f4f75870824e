//! What the source report got wrong, each as a switch: to see it, to measure it, and to prove that the
//! checks would find it.
//!
//! An [`Erratum`] is one mistake; everything else stays right. Mistakes of a formula are wrong
//! [models]: wrappers around a right one that override what is wrong, chosen by
//! [`Model::visit_with`](super::Model::visit_with); those of both lobes together are in
//! [`Formulas`]. Mistakes of the estimator are rules of the reference tracer. The list of all is
//! kept here, next to the formulas it is mostly about.
//!
//! Not shown, with the reason:
//!
//! - Samples that are not finite dropped but still divided by: there are none here to drop, and a
//!   picture that made some would show the mistake that made them.
//! - One random generator shared by all threads, a BRDF of seven numbers read as one of eleven:
//!   the outcome is left to chance, which no picture can repeat. (Safe Rust has neither.)
//! - pi = 3.14159: wrong by 8e-7, less than the rounding of what it is multiplied with.
//! - A cylinder along -z whose frame divides by 0: it vanishes, which shows nothing of light.
//! - `0/0` at Kd = Ks = 0 or at normal incidence: the same.
//! - "D is 0 when m.n *goes* 0" for "is not positive": part of [`Erratum::BelowHorizon`].

pub(super) mod below_horizon;
mod formulas;
pub mod models;

pub use formulas::Formulas;

use super::Model;
use crate::math::{Frame, V3};
use std::fmt;

/// One mistake of the source report or of its program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Erratum {
    /// The source report's `G1 = 2 / (1 + sqrt(1 + alpha² + tan²))`.
    GgxGSum,
    /// The source report's D of GGX, with Beckmann's alpha in its denominator.
    GgxDAlpha,
    /// Beckmann's normals drawn by the logarithm to base 10.
    BeckmannLog10,
    /// Phong's normals drawn from `cos^(1 / (a_p + 1))`.
    PhongExponent,
    /// A lobe near the poles drawn about z instead of the normal.
    LobeFramePole,
    /// Directions below the surface not rejected.
    BelowHorizon,
    /// Light found both ways counted both times.
    DoubleDirect,
    /// A light is seen if the ray's hit lies within 1e-6 of the point asked for.
    ShadowTolerance,
    /// Every sample clamped to 1.
    ClampSamples,
    /// The lobe chosen by Kd and Ks alone.
    ConstantLobeChoice,
    /// Only the first and the last light are ever asked.
    FirstAndLastLight,
    /// Rays start an absolute 1e-4 off.
    FixedEpsilon,
}

/// What there is to say about an erratum.
struct About {
    name: &'static str,
    title: &'static str,
    model: Option<Model>,
    wrong: &'static str,
    right: &'static str,
    shows: &'static str,
}

impl Erratum {
    /// All of them: the formulas' first, then the samplers', then the estimator's.
    pub const ALL: [Erratum; 12] = [
        Erratum::GgxGSum,
        Erratum::GgxDAlpha,
        Erratum::BeckmannLog10,
        Erratum::PhongExponent,
        Erratum::BelowHorizon,
        Erratum::LobeFramePole,
        Erratum::ConstantLobeChoice,
        Erratum::DoubleDirect,
        Erratum::ShadowTolerance,
        Erratum::ClampSamples,
        Erratum::FirstAndLastLight,
        Erratum::FixedEpsilon,
    ];

    /// Lower-case name with hyphens, as the command line takes it.
    pub fn name(self) -> &'static str {
        self.about().name
    }

    /// As a person says it, in a few words.
    pub fn title(self) -> &'static str {
        self.about().title
    }

    /// The one model that it is about, if it is not about all. On the others it has no effect.
    pub fn model(self) -> Option<Model> {
        self.about().model
    }

    /// Whether it can change a picture made with this model.
    pub fn concerns(self, model: Model) -> bool {
        self.model().is_none_or(|m| m == model)
    }

    /// What the source report does.
    pub fn wrong(self) -> &'static str {
        self.about().wrong
    }

    /// What it should do, as burnish does.
    pub fn right(self) -> &'static str {
        self.about().right
    }

    /// What the mistake does to a picture.
    pub fn shows(self) -> &'static str {
        self.about().shows
    }

    /// False where the mistake costs only noise, and the mean stays right.
    pub fn is_bias(self) -> bool {
        self != Erratum::ConstantLobeChoice
    }

    fn about(self) -> About {
        match self {
            Erratum::GgxGSum => About {
                name: "ggx-g-sum",
                title: "A sum under GGX's root",
                model: Some(Model::Ggx),
                wrong: "G1 = 2 / (1 + sqrt(1 + alpha² + tan²))",
                right: "2 / (1 + sqrt(1 + alpha² tan²)), which is 1 for a smooth surface",
                shows: "Metals go dark at grazing, smooth ones most.",
            },
            Erratum::GgxDAlpha => About {
                name: "ggx-d-alpha",
                title: "Two alphas in GGX's D",
                model: Some(Model::Ggx),
                wrong: "D = a_g² / (pi cos⁴ (a_b² + tan²)²), here with a_b = 2 a_g",
                right: "a_g in both places, or D cos does not integrate to 1 but to (a_g / a_b)²",
                shows: "Lamps' highlights are twice as wide and 16 times too faint in the middle; \
                        what the lobe's own samples meet stays, for D cancels there.",
            },
            Erratum::BeckmannLog10 => About {
                name: "beckmann-log10",
                title: "Beckmann's logarithm to base 10",
                model: Some(Model::Beckmann),
                wrong: "normals drawn by tan² = -alpha² log10(1 - u), from D cos",
                right: "the natural logarithm; with the other the lobe is 0.66 as wide as its \
                        density claims",
                shows: "Reflections are too sharp and, by the ratio of the densities, wrong in \
                        brightness.",
            },
            Erratum::PhongExponent => About {
                name: "phong-exponent",
                title: "Phong's exponent off by 1",
                model: Some(Model::Phong),
                wrong: "normals drawn by cos = u^(1 / (a_p + 1))",
                right: "u^(1 / (a_p + 2)), for the density is D cos",
                shows: "Low exponents brighten towards grazing; high ones hardly change.",
            },
            Erratum::BelowHorizon => About {
                name: "below-horizon",
                title: "Light from below the surface",
                model: None,
                wrong: "directions below the surface kept, with |cos| in place of cos; the \
                        rational G1 is negative there",
                right: "f = 0 unless both directions are above, and the path ends",
                shows: "Light leaks through thin walls and rough edges; Phong and Beckmann lose \
                        light to negative values.",
            },
            Erratum::LobeFramePole => About {
                name: "lobe-frame-pole",
                title: "Lobes about z near the poles",
                model: None,
                wrong: "directions drawn about ±z wherever the normal is within 2.56° of it",
                right: "about the normal itself, by a frame without a pole",
                shows: "The tops of smooth balls reflect from the wrong place or not at all.",
            },
            Erratum::ConstantLobeChoice => About {
                name: "constant-lobe-choice",
                title: "A lobe chosen by Kd and Ks",
                model: None,
                wrong: "the specular lobe sampled with probability |Ks| / (|Kd| + |Ks|)",
                right: "by its share of the reflectance at the viewer's angle, at least 0.05",
                shows: "Right on average, but noisy where F is strong: lacquer at grazing.",
            },
            Erratum::DoubleDirect => About {
                name: "double-direct",
                title: "Direct light counted twice",
                model: None,
                wrong: "a light counts in full when met by chance, and again when asked, there \
                        times the roulette's 0.8",
                right: "the two ways weighed so that their weights sum to 1",
                shows: "Everything is 1.8 times too bright after one bounce, more after two. With \
                        one strategy alone there is nothing to double.",
            },
            Erratum::ShadowTolerance => About {
                name: "shadow-tolerance",
                title: "Shadows by a distance of 1e-6",
                model: None,
                wrong: "a light is seen if the shadow ray's hit lies within 1e-6 of the point \
                        asked for, in single precision",
                right: "if nothing lies between, up to the rounding of the point itself",
                shows: "Asked light is lost, the more the farther the lamp and the larger the \
                        scene's numbers.",
            },
            Erratum::ClampSamples => About {
                name: "clamp-samples",
                title: "Samples clamped to 1",
                model: None,
                wrong: "every sample clamped to 0..1 before it is averaged",
                right: "the average of what was found; a picture is brought into range afterwards",
                shows: "Lamps and their reflections go dull, and all light that comes rarely but \
                        strongly is lost.",
            },
            Erratum::FirstAndLastLight => About {
                name: "first-and-last-light",
                title: "Only the first and last light asked",
                model: None,
                wrong: "the light's number is (0 or 1) times (n - 1), with a density of 1/n",
                right: "every light with the probability that its density states",
                shows: "With three lights or more: those in the middle are dimmed, the others too \
                        bright.",
            },
            Erratum::FixedEpsilon => About {
                name: "fixed-epsilon",
                title: "Rays start 1e-4 off",
                model: None,
                wrong: "a ray leaves from its point plus 1e-4 of its direction, in the scene's units",
                right: "from off the surface by the error bound of the point, at any scale",
                shows: "Small scenes leak light, and large ones shadow themselves.",
            },
        }
    }
}

impl fmt::Display for Erratum {
    /// Its name, the mistake and what would be right, in a line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}; right is {}", self.name(), self.wrong(), self.right())
    }
}

/// [`Erratum::LobeFramePole`]'s axes for a lobe about the unit vector `n`: z's own near the poles.
pub fn lobe_frame(n: V3) -> Frame {
    let z = 1.0f32.copysign(n.z);
    let axis = if (n.z - z).abs() < 0.001 { V3::new(0.0, 0.0, z) } else { n };
    Frame::around(axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_erratum_is_listed_once_with_a_name_of_its_own() {
        let names: Vec<_> = Erratum::ALL.iter().map(|e| e.name()).collect();
        for (i, name) in names.iter().enumerate() {
            assert!(name.chars().all(|c| c.is_ascii_lowercase() || c == '-' || c.is_ascii_digit()));
            assert!(!names[..i].contains(name), "{name} twice");
        }
        for e in Erratum::ALL {
            assert!(e.title().len() < 40 && e.shows().ends_with('.'), "{e:?}");
        }
    }

    #[test]
    fn the_wrong_frame_is_wrong_near_the_poles_alone() {
        for (tilt, wrong) in [(0.0f32, false), (0.04, true), (0.05, false), (1.0, false)] {
            for z in [1.0f32, -1.0] {
                let n = V3::new(tilt.sin(), 0.0, z * tilt.cos());
                let frame = lobe_frame(n);
                assert_eq!((frame.n - n).length() > 1e-3, wrong, "{tilt} {z}");
                let across = frame.s.cross(frame.t) - frame.n;
                assert!(across.length() < 1e-6, "still an orthonormal frame");
            }
        }
    }
}
