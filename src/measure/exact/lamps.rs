//! A diffuse plane under a lamp: the radiance that leaves the origin is `rho L F`, where F is the
//! form factor of the lamp. Only direct light, so that a small piece of the plane will do; the eye
//! is nearer than the lamp.

use super::ExactError;
use super::stage::{ASIDE, Stage, diffuse, lamp, plane, quad, rectangle, viewer};
use crate::scene::SceneBuilder;
use glam::DVec3;
use serde::Deserialize;

/// A scene with the plane in it, and the eye at a quarter of the distance `near` of the lamp.
struct Lit {
    builder: SceneBuilder,
    near: f64,
}

impl Lit {
    fn new(rho: f64, near: f64) -> Result<Lit, ExactError> {
        let mut builder = SceneBuilder::new("plane and lamp");
        let grey = diffuse(&mut builder, rho, 0.0)?;
        plane(&mut builder, 0.25 * near, grey)?;
        Ok(Lit { builder, near })
    }

    fn stage(self) -> Result<Stage, ExactError> {
        Ok(Stage::new(self.builder, viewer(ASIDE, 0.25 * self.near)?).depth(1))
    }
}

/// A sphere at `distance`, `beta_deg` from the normal; the horizon may cut it.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneSphere {
    radius: f64,
    distance: f64,
    beta_deg: f64,
    rho: f64,
    radiance: f64,
}

impl PlaneSphere {
    pub(super) fn stage(&self) -> Result<Stage, ExactError> {
        let gap = self.distance - self.radius;
        let mut lit = Lit::new(self.rho, gap)?;
        let (sin, cos) = self.beta_deg.to_radians().sin_cos();
        let lamp = lamp(&mut lit.builder, self.radiance)?;
        let centre = DVec3::new(sin, 0.0, cos) * self.distance;
        lit.builder.sphere(centre, self.radius, lamp)?;
        if gap < 1e-3 * self.radius {
            // So small a gap is told from none only around the middle of the scene, where single
            // precision is finest: a black speck below puts the origin there.
            let black = diffuse(&mut lit.builder, 0.0, 0.0)?;
            let low = DVec3::NEG_Z * (self.distance + self.radius);
            let size = 1e-3 * self.radius;
            rectangle(&mut lit.builder, low, [DVec3::X * size, DVec3::Y * size], black)?;
        }
        lit.stage()
    }
}

/// A rectangle at this height, parallel to the plane.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneRect {
    x: [f64; 2],
    y: [f64; 2],
    height: f64,
    rho: f64,
    radiance: f64,
}

impl PlaneRect {
    pub(super) fn stage(&self) -> Result<Stage, ExactError> {
        let mut lit = Lit::new(self.rho, self.height)?;
        let lamp = lamp(&mut lit.builder, self.radiance)?;
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        let corners =
            [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| DVec3::new(x, y, self.height));
        quad(&mut lit.builder, corners, lamp)?;
        lit.stage()
    }
}

/// A disc above the origin, parallel to the plane: the base of a cylinder, whose side is not seen
/// from below.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneDisk {
    radius: f64,
    height: f64,
    rho: f64,
    radiance: f64,
}

impl PlaneDisk {
    pub(super) fn stage(&self) -> Result<Stage, ExactError> {
        let mut lit = Lit::new(self.rho, self.height)?;
        let lamp = lamp(&mut lit.builder, self.radiance)?;
        let thickness = DVec3::Z * (0.1 * self.radius);
        lit.builder.cylinder(DVec3::Z * self.height, thickness, self.radius, lamp)?;
        lit.stage()
    }
}

/// Any rectangle; the horizon may cut it.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneQuad {
    vertices: [[f64; 3]; 4],
    rho: f64,
    radiance: f64,
}

impl PlaneQuad {
    pub(super) fn stage(&self) -> Result<Stage, ExactError> {
        let corners = self.vertices.map(DVec3::from_array);
        let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize();
        let mut lit = Lit::new(self.rho, normal.dot(corners[0]).abs())?;
        let lamp = lamp(&mut lit.builder, self.radiance)?;
        quad(&mut lit.builder, corners, lamp)?;
        lit.stage()
    }
}
