//! Light transport: from (seed, pixel, pass) to radiance.
//!
//! [`Tracer::sample`] follows one path from the camera: at each surface it samples a light
//! explicitly and samples the BRDF, and weighs the two ways of finding the same light against
//! each other (Veach 1997), so that every light counts exactly once. Nothing is clamped.
//! [`Tracer::sample_each`] does the same for hundreds of paths side by side, as many at a time as a
//! register holds: with the same random numbers, by other orders of the same sums.

mod by_model;
mod highlights;
mod lights;
mod pixel_groups;
mod reference;
mod roulette;
mod wavefront;

use crate::brdf::{BrdfParams, Erratum, Model, Normals};
use crate::geometry::Stack;
use crate::math::{Rgb, Simd};
use crate::scene::{Camera, CameraRays, Material, Scene};
use highlights::Highlights;
use lights::Lights;
pub use pixel_groups::{Contribution, PixelBatch, PixelGrouping, ReuseGroup, group_cell};
pub use reference::{Escape, PathRecord, PathVertex};
use std::sync::Arc;
pub use wavefront::{BatchOptions, FirstHits};
use wavefront::{PathBatch, Tables};

/// Longest path, a safety net: roulette ends paths long before unless the scene gains energy.
/// Paths that it ends are counted, for they are a bias.
pub const DEPTH_CAP: u32 = 1000;
/// Largest throughput of a path, far above what any scene has that gives back no more light than it
/// gets: in a closed room of more it grows without end, and so would the sums. Paths that reach it
/// end there and are counted as well. With the brightest of emitters products stay below 1e31, of 3e38.
pub const THROUGHPUT_CAP: f32 = 1e12;

/// How light is found at a surface. All three have the same mean; they differ in noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// Both ways below, weighed against each other.
    #[default]
    Mis,
    /// Only by sampling a light explicitly.
    LightOnly,
    /// Only by hitting a light with a direction sampled from the BRDF.
    BsdfOnly,
}

impl Strategy {
    /// All of them, the default first.
    pub const ALL: [Strategy; 3] = [Strategy::Mis, Strategy::LightOnly, Strategy::BsdfOnly];

    /// Lower-case name, as the command line takes it.
    pub fn name(self) -> &'static str {
        match self {
            Strategy::Mis => "mis",
            Strategy::LightOnly => "light",
            Strategy::BsdfOnly => "bsdf",
        }
    }

    /// As a person writes it.
    pub fn title(self) -> &'static str {
        match self {
            Strategy::Mis => "MIS",
            Strategy::LightOnly => "Light sampling",
            Strategy::BsdfOnly => "BRDF sampling",
        }
    }

    /// Weight of a light hit by a direction of density `pdf`, which light sampling would have found with
    /// density `other`.
    #[inline(always)]
    fn w_bsdf(self, pdf: f32, other: f32) -> f32 {
        match self {
            Strategy::Mis => power_heuristic(pdf, other),
            Strategy::LightOnly => 0.0,
            Strategy::BsdfOnly => 1.0,
        }
    }

    /// Weight of a light sampled with density `pdf`, which sampling the BRDF would have hit with
    /// density `other`.
    #[inline(always)]
    fn w_light(self, pdf: f32, other: f32) -> f32 {
        match self {
            Strategy::Mis => power_heuristic(pdf, other),
            Strategy::LightOnly => 1.0,
            Strategy::BsdfOnly => 0.0,
        }
    }
}

/// The weight of a direction found with density `a` that another strategy finds with density `b`.
/// The two weights of a pair sum to 1.
#[inline(always)]
fn power_heuristic<L: Simd>(a: L, b: L) -> L {
    let ratio = b / a;
    L::splat(1.0) / (L::splat(1.0) + ratio * ratio)
}

/// How light is sampled, and with which mistake if any.
///
/// The engine has one method: light is found in both ways, normals are visible, nothing is wrong.
/// Everything else is for comparison and runs through the reference tracer, one path at a time, so
/// so that the wavefront tracer has no such branches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Method {
    /// How light is found.
    pub strategy: Strategy,
    /// How Beckmann's and GGX's microfacet normals are drawn.
    pub normals: Normals,
    /// A mistake made on purpose.
    pub erratum: Option<Erratum>,
    /// One path at a time, whatever the method.
    pub reference: bool,
}

impl Method {
    /// Whether the reference tracer makes no exception for it. An erratum about another model is
    /// none, and Phong has one way to draw normals only.
    fn is_correct(&self, model: Model) -> bool {
        let normals = self.normals == Normals::Visible || model == Model::Phong;
        normals && !self.erratum.is_some_and(|e| e.concerns(model))
    }

    /// Whether it is what the engine does.
    fn is_the_engines(&self, model: Model) -> bool {
        self.is_correct(model) && self.strategy == Strategy::Mis && !self.reference
    }
}

/// What is traced of a scene, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Integrator {
    /// Picks one of 2^64 independent pictures.
    pub seed: u64,
    /// Largest number of scattering events between camera and light; `None` for no limit.
    pub max_depth: Option<u32>,
    /// Which D and G.
    pub model: Model,
    /// How light is sampled.
    pub method: Method,
}

/// A scene made ready for tracing with given materials, camera and picture size.
#[derive(Debug)]
pub struct Tracer {
    scene: Arc<Scene>,
    surfaces: Vec<Surface>,
    lights: Lights,
    highlights: Highlights,
    tables: Tables,
    camera: CameraRays,
    seed: u64,
    max_depth: u32,
    model: Model,
    method: Method,
}

#[derive(Clone, Copy, Debug)]
struct Surface {
    params: BrdfParams,
    emission: Rgb,
    emits: bool,
    reflects: bool,
}

/// A worker's own memory: the traversal stack and what it has counted.
#[derive(Clone, Debug)]
pub struct Scratch {
    stack: Stack,
    batch: Box<PathBatch>,
    /// Rays traced.
    pub rays: u64,
    /// Paths ended by [`DEPTH_CAP`] or [`THROUGHPUT_CAP`].
    pub capped: u64,
    /// What the engine has done.
    pub counts: RayCounts,
}

/// What the engine does with a batch, in this order but for going round from shading to tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Camera rays.
    Start,
    /// What rays hit: the nearest surface, fetched.
    Trace,
    /// Scattering: emission, light samples, directions to go on.
    Shade,
    /// Shadow rays: whether sampled lights are visible.
    Shadow,
    /// Visibility between primary and reuse vertices.
    Visibility,
    /// Light gathered from reuse vertices at primary ones.
    Gather,
}

impl Stage {
    /// All of them.
    pub const ALL: [Stage; 6] =
        [Stage::Start, Stage::Trace, Stage::Shade, Stage::Shadow, Stage::Visibility, Stage::Gather];

    /// Lower-case name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Start => "start",
            Stage::Trace => "trace",
            Stage::Shade => "shade",
            Stage::Shadow => "shadow",
            Stage::Visibility => "visibility",
            Stage::Gather => "gather",
        }
    }
}

/// Is told when a stage is over, and how many members of the batch had part in it.
pub type Watch<'a> = &'a mut dyn FnMut(Stage, usize);

/// What the engine has done, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Rays for which the nearest surface was looked for, from the camera or a surface; each was
    /// then shaded.
    pub nearest: u64,
    /// Rays towards lights.
    pub shadow_rays: u64,
    /// Pairs of first and reuse vertices of paths that share.
    pub pairs: u64,
    /// Evaluations of a specular lobe for those.
    pub glossy: u64,
    /// Rays between those that were traced.
    pub visibility_rays: u64,
    /// Spheres, cylinders and parts of the tree that these were held against.
    pub visibility_tests: u64,
    /// Of those, the ones that went through the tree.
    pub pair_rays: u64,
    /// Rays of other kinds that went through the tree: that hit its box, or for which the quick test
    /// of the large quads could not tell.
    pub tree_rays: u64,
}

impl RayCounts {
    /// What it costs, in about nanoseconds of one thread, in a scene of `primitives` primitives. The prices
    /// are those by which the processor seconds of `burnish render SCENE --group N --passes 64`, N of 16, 32
    /// and 64, are told best in twelve scenes; only their ratios matter. What is done once for each reuse vertex is part of the price of rays towards lights.
    pub fn work(&self, primitives: usize) -> f64 {
        let depth = (primitives.max(1) as f64).powf(0.25);
        let prices = [
            (self.nearest, 41.0),
            (self.shadow_rays, 44.0),
            (self.pairs, 3.0),
            (self.glossy, 1.1),
            (self.visibility_tests, 0.4),
            (self.pair_rays, 4.8 * depth),
            (self.tree_rays, 6.8 * depth),
        ];
        prices.iter().map(|&(count, price)| count as f64 * price).sum()
    }
}

impl Tracer {
    /// `materials` stand in for the scene's own, the same number in the same order.
    pub fn new(
        scene: Arc<Scene>,
        materials: &[Material],
        camera: &Camera,
        size: [u32; 2],
        Integrator { seed, max_depth, model, method }: Integrator,
    ) -> Tracer {
        let surfaces = materials.iter().map(Surface::new).collect();
        let equally = method.erratum == Some(Erratum::FirstAndLastLight);
        let lights = Lights::new(&scene, materials, equally);
        Tracer {
            surfaces,
            highlights: Highlights::new(&scene, materials, &lights),
            lights,
            tables: Tables::new(materials),
            camera: CameraRays::new(camera, scene.placement(), size),
            seed,
            max_depth: max_depth.unwrap_or(u32::MAX),
            model,
            method,
            scene,
        }
    }

    /// Whether paths can share what they find: where the engine works, and a path may be scattered
    /// twice.
    pub fn shares(&self) -> bool {
        self.is_the_engines() && self.max_depth > 1
    }

    /// About how many bytes of memory it holds beside the scene's: what was made of lights and
    /// materials.
    pub fn bytes(&self) -> usize {
        // A material's record in the tables and for the reference tracer.
        self.lights.bytes() + self.surfaces.len() * 2 * size_of::<Surface>()
    }

    /// Whether the engine traces it.
    fn is_the_engines(&self) -> bool {
        self.method.is_the_engines(self.model)
    }

    /// Memory for one worker.
    pub fn scratch(&self) -> Scratch {
        let stack = self.scene.stack();
        let counts = RayCounts::default();
        Scratch { stack, batch: Box::default(), rays: 0, capped: 0, counts }
    }
}

impl Surface {
    fn new(material: &Material) -> Surface {
        let params = BrdfParams {
            kd: material.kd.into(),
            ks: material.ks.into(),
            roughness: material.roughness.into(),
        };
        Surface {
            params,
            emission: material.emission.into(),
            emits: material.emits(),
            reflects: !(params.kd.is_black() && params.ks.is_black()),
        }
    }
}
