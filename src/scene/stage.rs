//! What a model is shown on that brings neither light nor camera: a ground, two area lights and a dim
//! surround.
//!
//! All of it is in the words of the `.scn` format, so that a model on its stage can be written down.

use super::{MAX_COORDINATE, Material, MaterialError, SceneBuilder, ShapeError};
use glam::DVec3;
use thiserror::Error;

/// The stage around a model whose bounding box is known. Lengths are in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelStage {
    /// Middle of the model's bounding box.
    pub centre: DVec3,
    /// Half the diagonal of the box, the unit of all that follows.
    pub radius: f64,
    /// Lowest point of the model.
    pub floor: f64,
}

/// A sphere that lights the stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageLight {
    /// What the window calls it.
    pub name: &'static str,
    /// Its middle.
    pub centre: DVec3,
    /// Its radius.
    pub radius: f64,
    /// Its radiance in W/(m² sr).
    pub radiance: [f64; 3],
}

/// A stage that could not be put up.
#[derive(Debug, Error)]
pub enum StageError {
    /// Never for a stage that [`ModelStage::around`] gave.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Never: the materials are constants.
    #[error(transparent)]
    Material(#[from] MaterialError),
}

/// Radius of the ground: [`Camera::framing`](super::Camera::framing) sees nothing beyond it.
const GROUND: f64 = 60.0;
const THICKNESS: f64 = 0.5;
/// The ground lies lower than the model, by a fifth of a pixel or so: surfaces of both would share a
/// place otherwise.
const GAP: f64 = 1e-3;

impl ModelStage {
    /// Radiance of every direction that hits nothing, W/(m² sr).
    pub const SURROUND: [f32; 3] = [0.22, 0.23, 0.25];
    /// Materials that a stage adds to its model's: ground, key light, rim light.
    pub const MATERIALS: usize = 3;

    /// The stage around this box; `None` for a box so large or small that its stage would be out of
    /// reach of coordinates.
    pub fn around(low: DVec3, high: DVec3) -> Option<ModelStage> {
        let (centre, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
        let reach = centre.abs().max_element() + 2.0 * GROUND * radius;
        let seen = radius > 1e-9 * centre.abs().max_element() && radius > 1e-15;
        (reach <= MAX_COORDINATE && seen).then_some(ModelStage { centre, radius, floor: low.z })
    }

    /// The key light, in front on the left, and the rim light, behind on the right.
    pub fn lights(&self) -> [StageLight; 2] {
        let at = |x: f64, y: f64, z: f64, distance: f64| {
            self.centre + DVec3::new(x, y, z).normalize() * (distance * self.radius)
        };
        [
            StageLight {
                name: "Key light",
                centre: at(-0.75, -0.85, 1.2, 2.7),
                radius: 0.55 * self.radius,
                radiance: [21.0, 19.8, 18.0],
            },
            StageLight {
                name: "Rim light",
                centre: at(1.0, 0.9, 0.85, 2.5),
                radius: 0.4 * self.radius,
                radiance: [14.0, 16.0, 19.0],
            },
        ]
    }

    /// The ground, a cylinder: its base, axis and radius.
    pub fn ground(&self) -> (DVec3, DVec3, f64) {
        let top = DVec3::new(self.centre.x, self.centre.y, self.floor - GAP * self.radius);
        let axis = DVec3::new(0.0, 0.0, THICKNESS * self.radius);
        (top - axis, axis, GROUND * self.radius)
    }

    /// Adds ground, lights and surround to a scene, with a material each.
    pub fn put_up(&self, builder: &mut SceneBuilder) -> Result<(), StageError> {
        let (base, axis, radius) = self.ground();
        let ground = Material::reflecting("Ground", [0.30, 0.29, 0.28], [0.0; 3], 1.0)?;
        let ground = builder.material(ground);
        builder.cylinder(base, axis, radius, ground)?;
        for light in self.lights() {
            let material = builder.material(Material::light(light.name, light.radiance)?);
            builder.sphere(light.centre, light.radius, material)?;
        }
        builder.environment = Self::SURROUND;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_stands_free_between_ground_and_lights() {
        let (low, high) = (DVec3::new(-3.0, 1.0, 7.0), DVec3::new(-1.0, 9.0, 8.0));
        let stage = ModelStage::around(low, high).unwrap();
        let (base, axis, radius) = stage.ground();
        let top = (base + axis).z;
        assert!(top < low.z && low.z - top < 2e-3 * stage.radius);
        assert!(radius > 10.0 * stage.radius);
        let camera = crate::scene::Camera::framing(low, high, 4.0 / 3.0);
        for light in stage.lights() {
            let off = (light.centre - stage.centre).length();
            assert!(off > stage.radius + light.radius, "{}", light.name);
            assert!(light.centre.z - light.radius > top && light.centre.z > high.z, "{light:?}");
            // Out of the picture: beside the pyramid that the camera sees, or behind it.
            let [x, _, back] = camera.axes();
            let seen = light.centre - camera.eye;
            let (aside, ahead) = (seen.dot(x).abs() - light.radius, -seen.dot(back));
            assert!(ahead < 0.0 || aside > ahead * camera.ry * 4.0 / 3.0, "{}", light.name);
        }
    }

    #[test]
    fn there_is_none_out_of_reach_or_around_nothing() {
        for (low, high) in [
            (DVec3::splat(-1e18), DVec3::splat(1e18)),
            (DVec3::splat(1e17), DVec3::splat(1.1e17)),
            (DVec3::ONE, DVec3::ONE),
            (DVec3::splat(f64::NAN), DVec3::ONE),
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
        ] {
            assert_eq!(ModelStage::around(low, high), None, "{low} {high}");
        }
        assert!(ModelStage::around(DVec3::ZERO, DVec3::new(1e15, 1e15, 0.0)).is_some());
    }

    #[test]
    fn it_adds_what_it_says() {
        let mut builder = SceneBuilder::new("m");
        ModelStage::around(DVec3::ZERO, DVec3::ONE).unwrap().put_up(&mut builder).unwrap();
        assert_eq!((builder.shapes(), builder.materials().len()), (3, ModelStage::MATERIALS));
        assert_eq!(builder.environment, ModelStage::SURROUND);
        assert!(builder.is_lit());
    }
}
