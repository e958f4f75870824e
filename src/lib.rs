//! burnish: a progressive path tracer for the microfacet BRDFs Phong, Beckmann and GGX, in which
//! every picture knows its error.
//!
//! The library renders without a window; the program `burnish` puts one in front of it.
//!
//! ```
//! use burnish::brdf::{Model, Roughness};
//! use burnish::progressive::{Params, render};
//! use burnish::scene::builtin;
//! use std::sync::Arc;
//!
//! let (builder, report) = builtin::default_scene()?;
//! assert!(report.warnings.is_empty());
//! let scene = Arc::new(builder.build());
//! let params = Params { model: Model::Beckmann, size: [64, 48], ..Params::new(scene) }
//!     .with_roughness(Roughness::from_alpha(0.2)?);
//! let snapshot = render(params, 8, 0)?; // 8 passes on all cores
//! let picture = snapshot.mean(); // linear radiance, rows from the top
//! assert_eq!(picture.pixels.len(), 64 * 48);
//! println!("relative error about {:.0} %", 100.0 * snapshot.error.unwrap().relative.value);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The way of the data
//!
//! file → [`scene::read`] (checked values and a report with line numbers) → [`scene::SceneBuilder`]
//! (world units, f64) → [`scene::Scene`] (recentred, f32, with its tree) → [`progressive::Session`]
//! (parameters in, snapshots out) → [`trace`] (seed, pixel, pass → radiance) → [`film`] (sums) →
//! [`progressive::Snapshot`] → [`picture`] or the window. Arrows point one way. For whoever changes
//! it, [`architecture`] says what is where and why.
//!
//! # Dictionary
//!
//! | word | meaning |
//! | --- | --- |
//! | `wo`, `wi` | directions to the viewer and to the light, unit, both leaving the surface |
//! | `wm` | microfacet normal |
//! | `ng`, `ns` | geometric and shading normal |
//! | `f` | BRDF value in 1/sr, without the cosine |
//! | `beta` | throughput of a path |
//! | `pdf` | density in 1/sr, unless the name says area |
//! | `a_p`, `alpha` | Phong exponent and roughness, `alpha = sqrt(2 / (a_p + 2))` |
//! | pass | one sample in every pixel |
//! | replicate | one of a few independent randomisations that passes are assigned to in turn |
//! | epoch | the time between two changes of parameters |
//! | erratum | one mistake of the source report, the document that this project began with, made on purpose |
//!
//! Radiance is in W/(m² sr) per channel, linear Rec. 709. World space is right-handed with Z up.
//! BRDFs see local directions only, z being the shading normal, bent where it is seen from behind. Surfaces are opaque and two-sided.
//!
//! # What is not modelled
//!
//! Textures, volumes, transmission, spectra, subsurface light, multiple scattering between
//! microfacets. Files that ask for them are read with a warning.

#[cfg(doc)]
#[doc = include_str!("ARCHITECTURE.md")]
pub mod architecture {}
pub mod brdf;
pub mod film;
pub mod geometry;
pub mod limits;
pub mod math;
pub mod measure;
pub mod picture;
pub mod plain;
pub mod progressive;
pub mod scene;
pub mod trace;

/// The README's code, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
