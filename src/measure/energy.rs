//! What a model does to energy, for those who render with it.
//!
//! The models are left as they are, and three things follow. With F = 1 a lobe loses what bounces
//! twice between facets. The diffuse part is not reduced by F, so that a bright material reflects
//! more than arrives, most at grazing angles. And Phong's lobe alone gains where it is rough and
//! seen at grazing, for its D and Beckmann's G do not belong together.
//!
//! Nearly every painted surface exceeds 1 by a little in a sliver at grazing, where a picture hardly
//! shows it; to be told so of each would only teach not to read. A material is named where it
//! matters: when it exceeds 1 on average over all angles, for then a closed room of it has no finite
//! answer. Those that exceed 1 at grazing alone share one line, with the one that does so most.

use super::check::quadrature::{Albedo, QuadratureGrid, albedo, cosine_mean};
use super::check::reference::ReferenceBrdf;
use crate::brdf::{Model, Roughness};
use crate::scene::{Material, MaterialId};
use std::collections::HashMap;
use std::fmt;

/// How much of what arrives from everywhere alike the lobe of a model reflects.
#[derive(Clone, Debug)]
pub struct LobeEnergy {
    /// At angles from the normal to a cosine of [`LobeEnergy::GRAZING`].
    angles: Vec<Albedo>,
    /// Over the hemisphere, weighed with the cosine.
    mean: Albedo,
}

/// What a whole material reflects, its most reflecting channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reflected {
    /// At the angle where it is most.
    pub most: f64,
    /// On average over the hemisphere, weighed with the cosine: how much light a bounce leaves.
    pub mean: f64,
}

impl LobeEnergy {
    /// The least cosine looked at.
    pub const GRAZING: f64 = 1e-4;
    /// Angles of the mean.
    const ANGLES: usize = 16;

    /// By quadrature, in a few milliseconds: means within 5e-5, single angles within 2e-4. The most
    /// reflecting angle may lie between two that are looked at, which hides up to 0.003.
    pub fn of(model: Model, roughness: Roughness) -> LobeEnergy {
        let lobe = ReferenceBrdf::new(model, roughness);
        let at = |cos| albedo(&lobe, cos, QuadratureGrid::QUICK);
        // Sharp lobes reflect most within a narrow range at grazing, somewhere.
        let steps = (0..=20).map(|i| Self::GRAZING.powf(f64::from(i) / 20.0));
        let mut angles: Vec<Albedo> = steps.map(at).collect();
        let mean = cosine_mean(Self::ANGLES, |cos| {
            angles.push(at(cos));
            angles[angles.len() - 1]
        });
        LobeEnergy { angles, mean }
    }

    /// The share of light that is lost on average with F = 1, by bouncing between facets more than
    /// once. Below 0 for a gain.
    pub fn loss(&self) -> f64 {
        1.0 - self.mean.white
    }

    /// What the lobe alone reflects with F = 1 at the angle where it is most.
    pub fn most(&self) -> f64 {
        self.angles.iter().fold(0.0, |most: f64, a| most.max(a.white))
    }

    /// Of one channel of a material.
    pub fn reflected(&self, kd: f64, ks: f64) -> Reflected {
        let most = self.angles.iter().fold(0.0, |most: f64, a| most.max(a.of(kd, ks)));
        Reflected { most, mean: self.mean.of(kd, ks) }
    }
}

/// Something to be told about the energy of a scene, in a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// A material that reflects more than arrives on average.
    Grows {
        /// Its name.
        name: String,
        /// How rough it is.
        roughness: Roughness,
        /// How much it reflects.
        reflected: Reflected,
    },
    /// Materials that reflect more than arrives at grazing angles alone.
    AtGrazing {
        /// How many.
        count: usize,
        /// The one that does so most.
        name: String,
        /// How much it reflects.
        reflected: Reflected,
    },
    /// A lobe that reflects more than arrives by itself.
    Lobe {
        /// The roughest one.
        roughness: Roughness,
        /// How much it reflects with F = 1 at the angle where it is most.
        most: f64,
    },
}

/// Gains below this are not told: half a per cent, about what the largest angle is known to.
const TELL_FROM: f64 = 1.005;

/// A mean is known to 5e-5: a perfect mirror is no gain.
const GROWS_FROM: f64 = 1.0 + 1e-4;

/// What there is to tell of these materials under a model, the gravest first. Some milliseconds for
/// each roughness among them.
pub fn remarks(materials: &[Material], model: Model) -> Vec<Remark> {
    let mut lobes: HashMap<u64, LobeEnergy> = HashMap::new();
    let (mut growing, mut grazing) = (Vec::new(), Vec::new());
    let mut gaining: Option<(Roughness, f64)> = None;
    for (id, material) in materials.iter().enumerate() {
        if material.ks.iter().all(|&ks| ks == 0.0) {
            continue;
        }
        let roughness = material.roughness;
        let lobe = lobes
            .entry(roughness.alpha().to_bits())
            .or_insert_with(|| LobeEnergy::of(model, roughness));
        let reflected = of_material(lobe, material);
        if reflected.mean > GROWS_FROM {
            growing.push((id as MaterialId, reflected));
        } else if reflected.most > TELL_FROM {
            grazing.push((id as MaterialId, reflected));
        }
        if lobe.most() > TELL_FROM && gaining.is_none_or(|(_, most)| lobe.most() > most) {
            gaining = Some((roughness, lobe.most()));
        }
    }
    growing.sort_by(|a, b| b.1.mean.total_cmp(&a.1.mean));
    let material = |id: MaterialId| &materials[id as usize];
    let mut remarks: Vec<Remark> = growing
        .iter()
        .map(|&(id, reflected)| Remark::Grows {
            name: material(id).name.clone(),
            roughness: material(id).roughness,
            reflected,
        })
        .collect();
    if let Some(&(id, reflected)) = grazing.iter().max_by(|a, b| a.1.most.total_cmp(&b.1.most)) {
        let (count, name) = (grazing.len(), material(id).name.clone());
        remarks.push(Remark::AtGrazing { count, name, reflected });
    }
    remarks.extend(gaining.map(|(roughness, most)| Remark::Lobe { roughness, most }));
    remarks
}

/// The most of its channels.
fn of_material(lobe: &LobeEnergy, material: &Material) -> Reflected {
    let channels = [0, 1, 2].map(|c| {
        let (kd, ks) = (f64::from(material.kd[c]), f64::from(material.ks[c]));
        lobe.reflected(kd, ks)
    });
    channels.into_iter().fold(Reflected::default(), |most, channel| Reflected {
        most: most.most.max(channel.most),
        mean: most.mean.max(channel.mean),
    })
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Remark::Grows { name, roughness, reflected: Reflected { most, mean } } => write!(
                f,
                "\"{name}\" reflects {mean:.3} of what arrives on average, up to {most:.2} at \
                 grazing angles (alpha {}): a closed room of it has no finite answer",
                rounded(roughness.alpha())
            ),
            Remark::AtGrazing { count, name, reflected } => {
                let most = reflected.most;
                match count {
                    1 => write!(f, "\"{name}\" reflects up to {most:.2}")?,
                    n => write!(f, "{n} materials reflect up to {most:.2} (\"{name}\")")?,
                }
                write!(f, " of what arrives, at grazing angles alone")
            }
            Remark::Lobe { roughness, most } => write!(
                f,
                "Phong's lobe gains by itself at grazing angles, up to {most:.2} with F = 1 (a_p {}): \
                 its D and Beckmann's G do not belong together",
                rounded(roughness.exponent())
            ),
        }
    }
}

/// Three digits or so.
fn rounded(x: f64) -> f64 {
    let scale = 10f64.powf(2.0 - x.abs().max(1e-30).log10().floor());
    (x * scale).round() / scale
}
