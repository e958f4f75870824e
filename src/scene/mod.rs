//! What is rendered: a validated, read-only scene.
//!
//! A [`SceneBuilder`] collects shapes in world units and f64. Building recentres them to their
//! bounding box and rescales them to about unit size before anything becomes f32, so that
//! precision does not depend on where or how large a scene is. Radiance does not change under
//! that map; [`Placement`] converts points for those who ask.

mod builder;
pub mod builtin;
mod camera;
mod coinciding;
mod crop;
mod doubles;
mod examples;
mod first_hit;
mod framing;
mod material;
mod mesh;
mod normals;
pub mod presets;
mod rays;
pub mod read;
mod report;
mod source;
mod stage;
mod up;
mod weld;
pub mod write;

pub use builder::{MeshCounts, SceneBuilder, ShapeError};
pub use camera::{Camera, CameraError};
pub use coinciding::Coinciding;
pub use crop::{Crop, CropError};
pub use first_hit::FirstHit;
pub use material::{Material, MaterialError, MaterialId};
pub use mesh::{MAX_COORDINATE, Mesh, Smooth};
pub use normals::NormalCounts;
pub use rays::CameraRays;
pub use report::{Place, Report, Warning};
pub use source::{Source, SourceFile};
pub use stage::{ModelStage, StageError, StageLight};
pub use up::Axis;

use crate::geometry::{Bvh, Geometry, PrimitiveRange, Stack};
use crate::math::simd::Isa;
use glam::DVec3;

/// A scene as the tracer sees it: every index in range, every number finite.
#[derive(Debug)]
pub struct Scene {
    name: String,
    caption: Option<String>,
    source: Source,
    screen: [u32; 2],
    camera: Camera,
    environment: [f32; 3],
    materials: Vec<Material>,
    geometry: Geometry,
    bvh: Bvh,
    isa: Isa,
    surfaces: Vec<Light>,
    placement: Placement,
    bounds: [DVec3; 2],
    focus: Option<[DVec3; 2]>,
    counts: SceneCounts,
}

/// Primitives that came in as one shape; a light when its material emits.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Which primitives.
    pub shape: PrimitiveRange,
    /// Whose emission.
    pub material: MaterialId,
}

/// How much a scene holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneCounts {
    /// Triangles, boxes included (twelve each).
    pub triangles: usize,
    /// Exact spheres.
    pub spheres: usize,
    /// Exact capped cylinders.
    pub cylinders: usize,
    /// Shapes left out because another is in the same place.
    pub duplicates: usize,
}

impl Scene {
    /// Name of the file or built-in scene.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// What to look for in it, one line, where its file says so.
    pub fn caption(&self) -> Option<&str> {
        self.caption.as_deref()
    }
    /// The files that it was read from.
    pub fn source(&self) -> &Source {
        &self.source
    }
    /// Width and height in pixels that the file asks for.
    pub fn screen(&self) -> [u32; 2] {
        self.screen
    }
    /// The file's camera, or one that frames the scene.
    pub fn camera(&self) -> Camera {
        self.camera
    }
    /// Uniform radiance of every direction that hits nothing.
    pub fn environment(&self) -> [f32; 3] {
        self.environment
    }
    /// The materials as read.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }
    /// The shapes in local units.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }
    /// The tree over the shapes.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }
    /// The instruction set that rays and samples are traced with: the widest that this processor
    /// has, unless another was set.
    pub fn isa(&self) -> Isa {
        self.isa
    }
    /// Traces with another instruction set from now on: for tests and comparisons, the hits are
    /// the same bits. Stacks made before keep theirs.
    pub fn set_isa(&mut self, isa: Isa) {
        self.isa = isa;
    }
    /// Memory for rays through this scene's tree.
    pub fn stack(&self) -> Stack {
        self.bvh.stack(self.isa)
    }
    /// Every shape that would be a light of its own if its material emitted.
    pub fn surfaces(&self) -> &[Light] {
        &self.surfaces
    }
    /// From world units to the units of [`Scene::geometry`].
    pub fn placement(&self) -> Placement {
        self.placement
    }
    /// Lowest and highest corner in world units.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }
    /// Lowest and highest corner in world units of what there is to look at: of a model alone without
    /// its stage, elsewhere of all.
    pub fn focus(&self) -> [DVec3; 2] {
        self.focus.unwrap_or(self.bounds)
    }
    /// The stage that a model without lights was put on; its materials are the last ones.
    pub fn stage(&self) -> Option<ModelStage> {
        self.focus.and_then(|[low, high]| ModelStage::around(low, high))
    }
    /// The material seen at a point of the picture, in pixels from its top left corner; `None`
    /// where nothing is hit.
    pub fn pick(&self, camera: &Camera, size: [u32; 2], pixel: [f32; 2]) -> Option<MaterialId> {
        let ray = CameraRays::new(camera, self.placement, size).ray(pixel[0], pixel[1]);
        let mut stack = self.stack();
        let hit = self.bvh.closest(&self.geometry, &ray, f32::INFINITY, &mut stack)?;
        Some(self.geometry.material(hit.primitive))
    }
    /// How much it holds.
    pub fn counts(&self) -> SceneCounts {
        self.counts
    }
}

/// The map from world units to the tracer's: `(p - centre) * scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    centre: DVec3,
    scale: f64,
}

impl Placement {
    /// Takes the box `[low, high]` to one centred at the origin with half-extent about 1. The
    /// scale is a power of two, so that a scene and its double give the same bits.
    pub fn fitting(low: DVec3, high: DVec3) -> Placement {
        let half = ((high - low) * 0.5).max_element().max(f64::MIN_POSITIVE);
        Placement { centre: (low + high) * 0.5, scale: (-half.log2().ceil()).exp2() }
    }
    /// World to local.
    pub fn to_local(&self, p: DVec3) -> DVec3 {
        (p - self.centre) * self.scale
    }
    /// Local to world.
    pub fn to_world(&self, p: DVec3) -> DVec3 {
        p / self.scale + self.centre
    }
    /// Local units in one world unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }
}
