//! Light transport: from (seed, pixel, pass) to radiance.
//!
//! [`Tracer::sample`] follows one path from the camera: at each surface it asks a light
//! explicitly and samples the BRDF, and weighs the two ways of finding the same light against
//! each other (Veach 1997), so that every light counts exactly once. Nothing is clamped.

mod light;
mod reference;

use crate::brdf::Lobes;
use crate::geometry::Stack;
use crate::math::Rgb;
use crate::scene::{Camera, CameraRays, Material, Scene};
use light::Lights;
use std::sync::Arc;

/// Longest path, a safety net: roulette ends paths long before unless the scene gains energy.
/// Paths that it ends are counted, for they are a bias.
pub const DEPTH_CAP: u32 = 1000;

/// How light is found at a surface. All three have the same mean; they differ in noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// Both ways below, weighed against each other.
    #[default]
    Mis,
    /// Only by asking a light explicitly.
    LightOnly,
    /// Only by meeting a light with a direction sampled from the BRDF.
    BsdfOnly,
}

impl Strategy {
    /// All of them.
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
            Strategy::LightOnly => "light only",
            Strategy::BsdfOnly => "BSDF only",
        }
    }
}

/// A scene made ready for tracing with given materials, camera and picture size.
#[derive(Debug)]
pub struct Tracer {
    scene: Arc<Scene>,
    surfaces: Vec<Surface>,
    lights: Lights,
    camera: CameraRays,
    seed: u64,
    max_depth: u32,
    strategy: Strategy,
}

#[derive(Clone, Copy, Debug)]
struct Surface {
    lobes: Lobes,
    emission: Rgb,
    emits: bool,
    reflects: bool,
}

/// A worker's own memory: the traversal stack and what it has counted.
#[derive(Clone, Debug)]
pub struct Scratch {
    stack: Stack,
    /// Rays traced.
    pub rays: u64,
    /// Paths ended by [`DEPTH_CAP`].
    pub capped: u64,
}

impl Tracer {
    /// `materials` stand in for the scene's own, the same number in the same order. `max_depth`
    /// is the largest number of scattering events between camera and light.
    pub fn new(
        scene: Arc<Scene>,
        materials: &[Material],
        camera: &Camera,
        size: [u32; 2],
        seed: u64,
        max_depth: Option<u32>,
        strategy: Strategy,
    ) -> Tracer {
        let surfaces = materials.iter().map(Surface::new).collect();
        Tracer {
            surfaces,
            lights: Lights::new(&scene, materials),
            camera: CameraRays::new(camera, scene.placement(), size),
            seed,
            max_depth: max_depth.unwrap_or(u32::MAX),
            strategy,
            scene,
        }
    }

    /// Memory for one worker.
    pub fn scratch(&self) -> Scratch {
        Scratch { stack: self.scene.bvh().stack(), rays: 0, capped: 0 }
    }
}

impl Surface {
    fn new(material: &Material) -> Surface {
        let lobes = Lobes {
            kd: material.kd.into(),
            ks: material.ks.into(),
            width: material.roughness.into(),
        };
        Surface {
            lobes,
            emission: material.emission.into(),
            emits: material.emits(),
            reflects: !(lobes.kd.is_black() && lobes.ks.is_black()),
        }
    }
}
