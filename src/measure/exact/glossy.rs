//! The BRDF itself, seen under a dome, an emitter, and an emitter where a mirror would show it.

use super::ExactError;
use super::stage::{ASIDE, ExactStage, Where, emitter, plane, rectangle, viewer};
use crate::brdf::{Model, Roughness};
use crate::measure::site::Site;
use crate::scene::{Camera, Material, MaterialId};
use glam::DVec3;
use serde::{Deserialize, Deserializer, de::Error};
use std::f64::consts::FRAC_PI_4;

/// A grey surface: `param` is Phong's exponent or the others' alpha.
#[derive(Debug, Deserialize)]
pub(super) struct Finish {
    #[serde(deserialize_with = "model")]
    pub model: Model,
    pub param: f64,
    pub kd: f64,
    pub ks: f64,
}

fn model<'de, D: Deserializer<'de>>(from: D) -> Result<Model, D::Error> {
    let name = String::deserialize(from)?;
    let found = Model::ALL.into_iter().find(|m| m.name() == name);
    found.ok_or_else(|| D::Error::custom(format!("no model is called {name}")))
}

impl Finish {
    pub(super) fn material(
        &self,
        site: &mut Site,
        emission: f64,
    ) -> Result<MaterialId, ExactError> {
        let roughness = self.roughness()?;
        let surface = Material::reflecting("surface", [self.kd; 3], [self.ks; 3], 0.0)?;
        let surface = surface.emitting([emission; 3])?;
        Ok(site.material(Material { roughness, ..surface }))
    }

    pub(super) fn roughness(&self) -> Result<Roughness, ExactError> {
        Ok(match self.model {
            Model::Phong => Roughness::from_exponent(self.param)?,
            Model::Beckmann | Model::Ggx => Roughness::from_alpha(self.param)?,
        })
    }

    /// The plane z = 0 of this finish, and room for emitters no nearer than `near`.
    fn plane(&self, near: f64, at: Where) -> Result<Site, ExactError> {
        let mut site = at.site("glossy plane");
        let surface = self.material(&mut site, 0.0)?;
        plane(&mut site, 0.25 * near, surface)?;
        Ok(site)
    }

    /// Direct light on that plane, seen at the cosine `mu`, azimuth 0.
    fn seen(&self, site: Site, mu: f64, near: f64, at: Where) -> Result<ExactStage, ExactError> {
        let wo = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
        Ok(at.stage(site, viewer(wo, 0.25 * near)?)?.model(self.model).depth(1))
    }
}

/// The plane under a white sky: its directional albedo.
#[derive(Debug, Deserialize)]
pub(super) struct Dome {
    #[serde(flatten)]
    pub finish: Finish,
    pub mu: f64,
}

impl Dome {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let mut site = self.finish.plane(4.0, at)?;
        site.builder.environment = [1.0; 3];
        self.finish.seen(site, self.mu, 4.0, at)
    }
}

/// A ball under a white sky: the mean over its disc. The camera is far away instead of
/// orthographic; the picture is the square around the disc, of which the rest shows the sky.
#[derive(Debug, Deserialize)]
pub(super) struct Ball {
    #[serde(flatten)]
    pub finish: Finish,
}

impl Ball {
    /// In radii. The points seen crowd towards the middle by at most 1 / AWAY².
    const AWAY: f64 = 256.0;

    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let mut site = at.site("ball");
        let surface = self.finish.material(&mut site, 0.0)?;
        site.sphere(DVec3::ZERO, 1.0, surface)?;
        site.builder.environment = [1.0; 3];
        let reach = 1.0 / (Self::AWAY * Self::AWAY - 1.0).sqrt();
        let camera = Camera::look_at(ASIDE * Self::AWAY, DVec3::ZERO, reach)?;
        // So far away a ray's place is known to AWAY rounding errors.
        let bound = 1.0 / (Self::AWAY * Self::AWAY) + Self::AWAY * f32::EPSILON as f64;
        let mut stage = at.stage(site, camera)?.model(self.finish.model).bounded(bound);
        stage.params.size = [64, 64];
        stage.params.max_depth = Some(1);
        Ok(ExactStage { share: FRAC_PI_4, rest: 1.0 - FRAC_PI_4, ..stage })
    }
}

/// A rectangle of half-edges 0.5 and 0.4 in x and y, about where a mirror would show it.
#[derive(Debug, Deserialize)]
pub(super) struct SpecRect {
    #[serde(flatten)]
    pub finish: Finish,
    pub mu: f64,
    pub centre: [f64; 3],
    pub radiance: f64,
}

impl SpecRect {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let centre = DVec3::from_array(self.centre);
        let mut site = self.finish.plane(centre.z, at)?;
        let emitter = emitter(&mut site, self.radiance)?;
        rectangle(&mut site, centre, [DVec3::X * 0.5, DVec3::Y * 0.4], emitter)?;
        self.finish.seen(site, self.mu, centre.z, at)
    }
}

/// A sphere at `distance`, polar angle `beta` and azimuth `phi`.
#[derive(Debug, Deserialize)]
pub(super) struct SpecSphere {
    #[serde(flatten)]
    pub finish: Finish,
    pub mu: f64,
    pub distance: f64,
    pub radius: f64,
    pub beta: f64,
    pub phi: f64,
    pub radiance: f64,
}

impl SpecSphere {
    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let near = self.distance - self.radius;
        let mut site = self.finish.plane(near, at)?;
        let emitter = emitter(&mut site, self.radiance)?;
        let ((sin, cos), (sin_phi, cos_phi)) = (self.beta.sin_cos(), self.phi.sin_cos());
        let towards = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
        site.sphere(towards * self.distance, self.radius, emitter)?;
        self.finish.seen(site, self.mu, near, at)
    }
}

/// Of the square that [`Mirror`] shows.
const HEIGHT: f64 = 2.0;

/// Kd = 0, Ks = 0.5, and a square of half-edge 0.5 and radiance 1 at height 2, where a mirror would
/// show it.
#[derive(Debug, Deserialize)]
pub(super) struct Mirror {
    #[serde(deserialize_with = "model")]
    pub model: Model,
    pub param: f64,
    pub mu: f64,
}

impl Mirror {
    pub(super) fn finish(&self) -> Finish {
        Finish { model: self.model, param: self.param, kd: 0.0, ks: 0.5 }
    }

    /// The middle of the square.
    pub(super) fn centre(&self) -> DVec3 {
        let aside = (1.0 - self.mu * self.mu).sqrt() * HEIGHT / self.mu;
        DVec3::new(-aside, 0.0, HEIGHT)
    }

    pub(super) fn stage(&self, at: Where) -> Result<ExactStage, ExactError> {
        let finish = self.finish();
        let mut site = finish.plane(HEIGHT, at)?;
        let emitter = emitter(&mut site, 1.0)?;
        rectangle(&mut site, self.centre(), [DVec3::X * 0.5, DVec3::Y * 0.5], emitter)?;
        finish.seen(site, self.mu, HEIGHT, at)
    }
}
