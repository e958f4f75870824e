//! A diffuse plane under an emitter: the radiance that leaves the origin is `rho L F`, where F is the
//! form factor of the emitter. Only direct light, so that a small piece of the plane will do; the eye
//! is nearer than the emitter.

use super::ExactError;
use super::stage::{ASIDE, ExactStage, Where, diffuse, emitter, plane, quad, rectangle, viewer};
use crate::measure::site::Site;
use glam::DVec3;
use serde::Deserialize;

/// A scene with the plane in it, and the eye at a quarter of the distance `near` of the emitter.
struct Lit {
    site: Site,
    at: Where,
    near: f64,
}

impl Lit {
    fn new(rho: f64, near: f64, at: Where) -> Result<Lit, ExactError> {
        let mut site = at.site("plane and lamp");
        let grey = diffuse(&mut site, rho, 0.0)?;
        plane(&mut site, 0.25 * near, grey)?;
        Ok(Lit { site, at, near })
    }

    fn stage(self) -> Result<ExactStage, ExactError> {
        Ok(self.at.stage(self.site, viewer(ASIDE, 0.25 * self.near)?)?.depth(1))
    }
}

/// A sphere at `distance`, `beta_deg` from the normal; the horizon may cut it.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneSphere {
    pub radius: f64,
    pub distance: f64,
    pub beta_deg: f64,
    pub rho: f64,
    pub radiance: f64,
}

impl PlaneSphere {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let gap = self.distance - self.radius;
        let mut lit = Lit::new(self.rho, gap, at)?;
        let (sin, cos) = self.beta_deg.to_radians().sin_cos();
        let emitter = emitter(&mut lit.site, self.radiance)?;
        let centre = DVec3::new(sin, 0.0, cos) * self.distance;
        lit.site.sphere(centre, self.radius, emitter)?;
        if gap < 1e-3 * self.radius {
            // So small a gap is told from none only around the middle of the scene, where single
            // precision is finest: a black speck below puts the origin there.
            let black = diffuse(&mut lit.site, 0.0, 0.0)?;
            let low = DVec3::NEG_Z * (self.distance + self.radius);
            let size = 1e-3 * self.radius;
            rectangle(&mut lit.site, low, [DVec3::X * size, DVec3::Y * size], black)?;
        }
        lit.stage()
    }
}

/// A rectangle at this height, parallel to the plane.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneRect {
    pub x: [f64; 2],
    pub y: [f64; 2],
    pub height: f64,
    pub rho: f64,
    pub radiance: f64,
}

impl PlaneRect {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let mut lit = Lit::new(self.rho, self.height, at)?;
        let emitter = emitter(&mut lit.site, self.radiance)?;
        let ([x0, x1], [y0, y1]) = (self.x, self.y);
        let corners =
            [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| DVec3::new(x, y, self.height));
        quad(&mut lit.site, corners, emitter)?;
        lit.stage()
    }
}

/// A disc over the origin, parallel to the plane: the base of a cylinder, whose side is not seen
/// from below.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneDisk {
    pub radius: f64,
    pub height: f64,
    /// How far its middle is from being above the origin: less than the radius.
    #[serde(default)]
    pub aside: f64,
    pub rho: f64,
    pub radiance: f64,
}

impl PlaneDisk {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let mut lit = Lit::new(self.rho, self.height, at)?;
        let emitter = emitter(&mut lit.site, self.radiance)?;
        let thickness = DVec3::Z * (0.1 * self.radius);
        let base = DVec3::new(0.8 * self.aside, -0.6 * self.aside, self.height);
        lit.site.cylinder(base, thickness, self.radius, emitter)?;
        lit.stage()
    }
}

/// Any rectangle; the horizon may cut it.
#[derive(Debug, Deserialize)]
pub(super) struct PlaneQuad {
    pub vertices: [[f64; 3]; 4],
    pub rho: f64,
    pub radiance: f64,
}

impl PlaneQuad {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let corners = self.vertices.map(DVec3::from_array);
        let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize();
        let mut lit = Lit::new(self.rho, normal.dot(corners[0]).abs(), at)?;
        let emitter = emitter(&mut lit.site, self.radiance)?;
        quad(&mut lit.site, corners, emitter)?;
        lit.stage()
    }
}
