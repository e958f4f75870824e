//! The proofs: a model at a roughness against its own laws.
//!
//! [`prove`] takes the very functions that render, and compares them with formulas and integrals
//! that share nothing with them: [`reference`](mod@reference) writes the model as the textbook has
//! it, in double precision, and [`quadrature`] integrates it without a random number. Each
//! [`Proof`] is a figure and the bound that it must keep.
//!
//! Where samples decide, seeds are fixed, and two bounds are kept at once: the difference must be
//! small ([how small](EFFECT) stands beside it), and it must not be too unlikely for chance. One
//! test in 2e7 would fail a right program ([`CHANCE`]); some 50 are made of a subject and under
//! 2,000 in the whole set, so that a false alarm comes in less than one run of 1e4.
//!
//! That the proofs can fail is proved in turn: each [`Erratum`] that biases a picture is
//! [found](finds) by a proof known beforehand.

mod code;
mod formulas;
pub mod quadrature;
pub mod reference;
mod sampling;
mod scenes;
mod statistics;

pub use sampling::{BATCHES, sampled_albedo};

use crate::brdf::{Alpha, Erratum, Model, Normals, Roughness};
use crate::progressive::ParamsError;
use crate::scene::{CameraError, MaterialError, ShapeError};
use code::Code;
use thiserror::Error;

/// Least chance of a difference that is taken for chance.
pub const CHANCE: f64 = 5e-8;
/// Largest difference of an albedo, whatever its chance.
pub const EFFECT: f64 = 1e-3;

/// What is put to the proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subject {
    /// Which D and G.
    pub model: Model,
    /// How rough.
    pub roughness: Roughness,
    /// How normals are drawn.
    pub normals: Normals,
    /// A mistake made on purpose.
    pub erratum: Option<Erratum>,
}

impl Subject {
    /// The model as it renders.
    pub fn new(model: Model, roughness: Roughness) -> Subject {
        Subject { model, roughness, normals: Normals::Visible, erratum: None }
    }
}

/// How much is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Under a second: for a window.
    Quick,
    /// Some ten times the samples.
    Full,
}

/// One line of the table: a figure against its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    /// In a few words.
    pub name: &'static str,
    /// What is claimed.
    pub says: &'static str,
    /// What was found.
    pub figure: f64,
    /// What it must keep.
    pub bound: Bound,
}

/// On which side of a number a figure must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// For differences and counts.
    AtMost(f64),
    /// For chances.
    AtLeast(f64),
}

impl Proof {
    fn at_most(name: &'static str, says: &'static str, figure: f64, bound: f64) -> Proof {
        Proof { name, says, figure, bound: Bound::AtMost(bound) }
    }

    /// Of the chance that right code would differ so much.
    fn by_chance(name: &'static str, says: &'static str, chance: f64) -> Proof {
        Proof { name, says, figure: chance, bound: Bound::AtLeast(CHANCE) }
    }

    /// Whether the figure keeps its bound. What is not a number does not.
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::AtMost(most) => self.figure <= most,
            Bound::AtLeast(least) => self.figure >= least,
        }
    }
}

/// Why a proof could not be tried.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CheckError {
    /// Its picture could not be rendered.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// Its material cannot be.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// Its shape cannot be.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Its camera cannot be.
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// All proofs of a subject, in the order in which they are to be read. `threads` worker threads
/// render (0 for one a core); the figures do not depend on them.
pub fn prove(subject: Subject, effort: Effort, threads: usize) -> Result<Vec<Proof>, CheckError> {
    let mut work = ProofWork {
        subject,
        code: Code::of(subject.model, subject.normals, subject.erratum),
        roughness: subject.roughness.into(),
        full: effort == Effort::Full,
        threads,
        strange: 0,
        proofs: Vec::new(),
    };
    formulas::prove(&mut work);
    sampling::prove(&mut work);
    scenes::prove(&mut work)?;
    let says = "samples and pixels that are not finite or below 0";
    let strange = work.strange as f64;
    work.add(Proof::at_most("numbers", says, strange, 0.0));
    Ok(work.proofs)
}

/// The proof that finds this mistake, for one that a picture suffers from; `None` for a mistake
/// that costs only noise.
pub fn finds(erratum: Erratum) -> Option<&'static str> {
    match erratum {
        Erratum::GgxGSum => Some("limits of G"),
        Erratum::GgxDAlpha => Some("normalisation of D"),
        Erratum::BeckmannLog10 | Erratum::PhongExponent => Some("samples against density"),
        Erratum::BelowHorizon => Some("nothing below the horizon"),
        Erratum::LobeFramePole => Some("frame"),
        Erratum::DoubleDirect | Erratum::ShadowTolerance | Erratum::FirstAndLastLight => {
            Some("light met and asked")
        }
        Erratum::ClampSamples | Erratum::FixedEpsilon => Some("white furnace"),
        Erratum::ConstantLobeChoice => None,
    }
}

/// What the proofs share.
struct ProofWork {
    subject: Subject,
    code: Code,
    roughness: Alpha,
    full: bool,
    threads: usize,
    /// Numbers met that are not finite, or below 0.
    strange: u64,
    proofs: Vec<Proof>,
}

impl ProofWork {
    fn add(&mut self, proof: Proof) {
        self.proofs.push(proof);
    }
}
