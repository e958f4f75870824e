//! Everything that a picture depends on.

use crate::brdf::{Erratum, Model, Normals, Roughness};
use crate::film::Film;
use crate::limits::{PICTURE_SIDE, TooLarge, fits};
use crate::math::sobol::REPLICATES;
use crate::scene::{Camera, Material, Scene};
use crate::trace::{Integrator, Method, ReuseGroup, Strategy, Tracer};
use std::sync::Arc;
use thiserror::Error;

/// Largest number of passes.
pub(super) const MAX_PASSES: u64 = 1 << 32;

/// Everything that the pixels depend on: two renders of equal `Params` and passes have the same
/// bits, on any number of threads. A change of any field starts a new epoch.
#[derive(Clone, Debug)]
pub struct Params {
    /// Shapes, lights and the tree; shared, never copied.
    pub scene: Arc<Scene>,
    /// The scene's materials, possibly edited: the same number in the same order.
    pub materials: Arc<Vec<Material>>,
    /// Where from.
    pub camera: Camera,
    /// Width and height in pixels, each in 1..=[`Params::MAX_SIDE`].
    pub size: [u32; 2],
    /// Which D and G.
    pub model: Model,
    /// Picks one of 2^64 independent pictures.
    pub seed: u64,
    /// At most this many scattering events (at least 1) between camera and light; `None` for no
    /// limit but Russian roulette and a counted safety cap.
    pub max_depth: Option<u32>,
    /// How light is found.
    pub strategy: Strategy,
    /// How Beckmann's and GGX's microfacet normals are drawn.
    pub normals: Normals,
    /// A mistake made on purpose, to see what it does.
    pub erratum: Option<Erratum>,
    /// Trace one path at a time with the reference tracer, even where the engine could. Other
    /// strategies, other normals and mistakes are its work anyway.
    pub reference: bool,
    /// How many neighbouring paths share what they find; `None` for as many as a
    /// selection of the group finds best. Where the reference tracer works none do.
    pub group: Option<ReuseGroup>,
    /// Whether every pixel gets the same number of samples. Otherwise, after the first 16 passes, a
    /// pass is one sample a pixel on the mean only, and more where the picture is noisier.
    pub uniform: bool,
    /// The number of the first pass: 0 but where a picture is rendered in parts, each of which has some of
    /// the passes. A multiple of 4, so that every part is assigned to the replicates in the same turn, of at
    /// most [`Session::MAX_PASSES`](super::Session::MAX_PASSES); only where passes are uniform can it be
    /// another than 0.
    pub first_pass: u64,
}

/// Parameters that cannot be rendered.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ParamsError {
    /// A side of no pixels or too many.
    #[error("the picture must be from 1x1 to {max}x{max} pixels, not {0}x{1}", max = Params::MAX_SIDE)]
    Size(u32, u32),
    /// There is no memory for the sums and the picture.
    #[error(transparent)]
    Memory(#[from] TooLarge),
    /// Another number of materials than the scene has.
    #[error("the scene has {expected} materials, not {found}")]
    Materials {
        /// Materials in the scene.
        expected: usize,
        /// Materials given.
        found: usize,
    },
    /// `max_depth` of 0.
    #[error("the depth limit must be at least 1 scattering event")]
    Depth,
    /// A first pass that parts cannot begin with.
    #[error("the first pass must be 0 or, where passes are uniform, a multiple of {REPLICATES} up to {max}, not {0}",
            max = MAX_PASSES)]
    FirstPass(u64),
    /// The worker threads could not be started.
    #[error("could not start {threads} worker threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

impl Params {
    /// Largest width and height.
    pub const MAX_SIDE: u32 = PICTURE_SIDE;

    /// The scene as it is: its camera, its size, its materials, GGX, seed 0, no depth limit.
    pub fn new(scene: Arc<Scene>) -> Params {
        Params {
            materials: Arc::new(scene.materials().to_vec()),
            camera: scene.camera(),
            size: scene.screen(),
            model: Model::Ggx,
            seed: 0,
            max_depth: None,
            strategy: Strategy::Mis,
            normals: Normals::Visible,
            erratum: None,
            reference: false,
            group: None,
            uniform: false,
            first_pass: 0,
            scene,
        }
    }

    /// The same with every material this rough.
    pub fn with_roughness(mut self, roughness: Roughness) -> Params {
        for material in Arc::make_mut(&mut self.materials) {
            material.roughness = roughness;
        }
        self
    }

    /// How light is sampled.
    pub fn method(&self) -> Method {
        let Params { strategy, normals, erratum, reference, .. } = *self;
        Method { strategy, normals, erratum, reference }
    }

    /// What traces a sample of any pixel and pass of these.
    pub fn tracer(&self) -> Tracer {
        Tracer::new(
            self.scene.clone(),
            &self.materials,
            &self.camera,
            self.size,
            Integrator {
                seed: self.seed,
                max_depth: self.max_depth,
                model: self.model,
                method: self.method(),
            },
        )
    }

    /// Whether these can be rendered.
    pub fn check(&self) -> Result<(), ParamsError> {
        let [w, h] = self.size;
        let side = 1..=Self::MAX_SIDE;
        if !side.contains(&w) || !side.contains(&h) {
            return Err(ParamsError::Size(w, h));
        }
        let (expected, found) = (self.scene.materials().len(), self.materials.len());
        if expected != found {
            return Err(ParamsError::Materials { expected, found });
        }
        if self.max_depth == Some(0) {
            return Err(ParamsError::Depth);
        }
        let first = self.first_pass;
        let possible = first.is_multiple_of(REPLICATES as u64) && first <= MAX_PASSES;
        if first > 0 && !(self.uniform && possible) {
            return Err(ParamsError::FirstPass(first));
        }
        Ok(())
    }

    /// The exponent of the [quantum](Film::quantum) of the sums: by the brightest emission of
    /// materials and sky.
    pub(super) fn quantum(&self) -> i32 {
        Film::quantum(self.brightest())
    }

    fn brightest(&self) -> f32 {
        let emissions = self.materials.iter().map(|material| material.emission);
        let all = emissions.chain([self.scene.environment()]).flatten();
        all.filter(|x| x.is_finite()).fold(0.0, f32::max)
    }

    /// Bytes of memory that a picture of these takes as it begins.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes_after(1)
    }

    /// Bytes of memory that a picture of these takes after so many passes: sums of all replicates, a
    /// pass's samples, the mean and error shown, and when it is written the whole mean and what becomes
    /// of it. Where passes have no end that is known it is what it takes as it begins.
    pub(super) fn bytes_after(&self, passes: u64) -> u64 {
        const REST: u64 = 5 * size_of::<[f32; 3]>() as u64;
        let passes = if passes < MAX_PASSES { passes } else { 1 };
        let pixel = Film::pixel_bytes(self.brightest(), passes) + REST;
        u64::from(self.size[0]) * u64::from(self.size[1]) * pixel
    }

    /// Whether there is memory for so many passes of the picture, where one of `held` pixels has its own
    /// already and so many bytes are spare.
    pub(super) fn fit(&self, passes: u64, held: [u32; 2], spare: u64) -> Result<(), ParamsError> {
        let held = Params { size: held, ..self.clone() }.bytes_after(passes) + spare;
        let need = self.bytes_after(passes).saturating_sub(held);
        let [w, h] = self.size;
        if need > 0 {
            fits(need, || format!("a picture of {w}x{h} pixels"))?;
        }
        Ok(())
    }
}

impl PartialEq for Params {
    /// Equal parameters give equal pixels. Scenes are compared by identity.
    fn eq(&self, o: &Params) -> bool {
        Arc::ptr_eq(&self.scene, &o.scene)
            && self.materials == o.materials
            && self.camera == o.camera
            && self.size == o.size
            && self.model == o.model
            && self.seed == o.seed
            && self.max_depth == o.max_depth
            && self.method() == o.method()
            && self.group == o.group
            && self.uniform == o.uniform
            && self.first_pass == o.first_pass
    }
}
