//! Light that goes to and fro: closed rooms, and two plates that face each other.

use super::ExactError;
use super::glossy::Finish;
use super::quantity::number_in;
use super::stage::{ASIDE, ExactStage, POINT, Where, diffuse, mesh, of_albedo, rectangle};
use crate::scene::Camera;
use glam::{DQuat, DVec3};
use serde::Deserialize;
use std::f64::consts::TAU;

/// A closed room whose walls all emit and reflect alike: every direction carries
/// `emission / (1 - rho)`, or the sum's first terms where the depth is limited. By turns a sphere
/// and a box.
#[derive(Debug, Deserialize)]
pub(super) struct Furnace {
    pub rho: f64,
    pub emission: f64,
}

impl Furnace {
    pub(super) fn stage(&self, quantity: &str, at: Where) -> Result<ExactStage, ExactError> {
        let mut site = at.site("furnace");
        let wall = diffuse(&mut site, self.rho, self.emission)?;
        let eye = DVec3::new(0.1, 0.2, -0.3);
        let camera = Camera::look_at(eye, eye + DVec3::X, 0.5)?;
        if quantity == "radiance" {
            site.sphere(DVec3::ZERO, 1.0, wall)?;
            return Ok(at.stage(site, camera)?.bounded(of_albedo(self.rho)));
        }
        let depth = number_in(quantity, "depth_")? as u32;
        match depth % 2 {
            0 => site.sphere(DVec3::ZERO, 1.0, wall)?,
            _ => site.block(DVec3::ZERO, DVec3::ONE, DQuat::IDENTITY, wall)?,
        }
        Ok(at.stage(site, camera)?.depth(depth).bounded(of_albedo(self.rho)))
    }
}

/// Two unit squares at this height over each other; the lower one emits. Black surroundings.
#[derive(Debug, Deserialize)]
pub(super) struct ParallelPlanes {
    pub height: f64,
    pub albedo: [f64; 2],
    pub emission: f64,
}

impl ParallelPlanes {
    pub(super) fn stage(&self, quantity: &str, at: Where) -> Result<ExactStage, ExactError> {
        let mut site = at.site("plates");
        let lower = diffuse(&mut site, self.albedo[0], self.emission)?;
        let upper = diffuse(&mut site, self.albedo[1], 0.0)?;
        let edges = [DVec3::X * 0.5, DVec3::Y * 0.5];
        let top = DVec3::Z * self.height;
        rectangle(&mut site, DVec3::ZERO, edges, lower)?;
        rectangle(&mut site, top, edges, upper)?;
        let middle = match quantity {
            "plate1" => DVec3::ZERO,
            "plate2" => top,
            _ => return Err(ExactError::Quantity(quantity.to_owned())),
        };
        let eye = DVec3::new(0.1, 0.05, 0.5) * self.height;
        at.stage(site, Camera::look_at(eye, middle, POINT)?)
    }
}

/// A sphere of this radius within the unit sphere: albedo and emission of the inner one's outside
/// and of the outer one's inside.
#[derive(Debug, Deserialize)]
pub(super) struct Concentric {
    pub radius: f64,
    pub inner: [f64; 2],
    pub outer: [f64; 2],
}

impl Concentric {
    pub(super) fn stage(&self, quantity: &str, at: Where) -> Result<ExactStage, ExactError> {
        let mut site = at.site("concentric");
        let inner = diffuse(&mut site, self.inner[0], self.inner[1])?;
        let outer = diffuse(&mut site, self.outer[0], self.outer[1])?;
        site.sphere(DVec3::ZERO, self.radius, inner)?;
        site.sphere(DVec3::ZERO, 1.0, outer)?;
        let eye = ASIDE * (0.5 * (1.0 + self.radius));
        let target = match quantity {
            "inner" => DVec3::ZERO,
            "outer" => 2.0 * eye,
            _ => return Err(ExactError::Quantity(quantity.to_owned())),
        };
        let camera = Camera::look_at(eye, target, 1e-3)?;
        Ok(at.stage(site, camera)?.bounded(of_albedo(self.outer[0])))
    }
}

/// A sphere, diffuse inside, of whose wall a cap with this fraction of the area emits.
#[derive(Debug, Deserialize)]
pub(super) struct Integrating {
    pub rho: f64,
    pub fraction: f64,
    pub emission: f64,
}

impl Integrating {
    /// Length of the facets' edges, about. Shorter ones would stand before the wall by less than
    /// single precision tells; as it is, by an eighth of its square.
    const EDGE: f64 = 0.01;
    /// How far before its place on the sphere the cap stands, but for its rim.
    const BEFORE: f64 = 5e-5;

    pub(super) fn stage(&self, quantity: &str, at: Where) -> Result<ExactStage, ExactError> {
        let mut site = at.site("integrating sphere");
        let wall = diffuse(&mut site, self.rho, 0.0)?;
        let cap = diffuse(&mut site, self.rho, self.emission)?;
        site.sphere(DVec3::ZERO, 1.0, wall)?;
        let (positions, triangles) = self.facets(Self::BEFORE);
        mesh(&mut site, positions, triangles, cap)?;
        // Emitters shine from both sides. What the cap's back gives off would be reflected to and
        // fro before the wall, a hundred times as bright as the cap, and come out under the rim's
        // chords: so there is a black cloth behind, sewn to the rim.
        let black = diffuse(&mut site, 0.0, 0.0)?;
        let (positions, triangles) = self.facets(0.5 * Self::BEFORE);
        mesh(&mut site, positions, triangles, black)?;
        let target = match quantity {
            "wall" => ASIDE * DVec3::new(1.0, 1.0, -1.0),
            "cap" => DVec3::new(0.2 * self.half_angle(), 0.0, 1.0),
            _ => return Err(ExactError::Quantity(quantity.to_owned())),
        };
        let bound = 0.25 * Self::EDGE * Self::EDGE + Self::BEFORE;
        let camera = Camera::look_at(DVec3::ZERO, target, 1e-3)?;
        Ok(at.stage(site, camera)?.bounded(of_albedo(self.rho) + bound))
    }

    fn half_angle(&self) -> f64 {
        (1.0 - 2.0 * self.fraction).acos()
    }

    /// The cap in facets that hide the wall behind: the rim's corners on the sphere, the others
    /// `before` it. All that other walls see of it is its rim, so that is what has to be right: as a
    /// polygon it is a little wider than the circle, by as much as makes the areas equal.
    fn facets(&self, before: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let rings = (self.half_angle() / Self::EDGE).ceil() as u32;
        let sectors = (self.half_angle().sin() * TAU / Self::EDGE).ceil() as u32;
        let wedge = TAU / sectors as f64;
        let wider = (wedge / wedge.sin()).sqrt();
        let mut positions = vec![DVec3::Z * (1.0 - before)];
        let mut triangles = Vec::new();
        for ring in 1..=rings {
            let theta = wider * self.half_angle() * ring as f64 / rings as f64;
            let radius = if ring == rings { 1.0 } else { 1.0 - before };
            let first = positions.len() as u32;
            for sector in 0..sectors {
                let (sin, cos) = (wedge * sector as f64).sin_cos();
                let (across, along) = theta.sin_cos();
                positions.push(DVec3::new(across * cos, across * sin, along) * radius);
                let next = (sector + 1) % sectors;
                let (c, d) = (first + sector, first + next);
                if ring == 1 {
                    triangles.push([0, c, d]);
                } else {
                    let (a, b) = (c - sectors, d - sectors);
                    triangles.extend([[a, c, d], [a, d, b]]);
                }
            }
        }
        (positions, triangles)
    }
}

/// A sphere with a glossy inside that emits 1, seen from where the wall shows itself at the cosine
/// in the quantity's name: a chord meets the wall at the same angle at both ends, and at the widest
/// one where the eye looks across its own radius.
#[derive(Debug, Deserialize)]
pub(super) struct Cavity {
    #[serde(flatten)]
    pub finish: Finish,
}

impl Cavity {
    pub(super) fn stage(&self, quantity: &str, at: Where) -> Result<ExactStage, ExactError> {
        let mu = number_in(quantity, "mu_")?;
        let mut site = at.site("cavity");
        let wall = self.finish.material(&mut site, 1.0)?;
        site.sphere(DVec3::ZERO, 1.0, wall)?;
        let eye = DVec3::X * (1.0 - mu * mu).sqrt();
        let camera = Camera::look_at(eye, eye + DVec3::new(0.0, 0.8, 0.6), POINT)?;
        Ok(at.stage(site, camera)?.model(self.finish.model))
    }
}
