//! The scene that is shown when none is named, part of the program itself.

use super::read::{Memory, ReadError, read_scn};
use super::{Report, SceneBuilder};

/// The files of `assets/scenes`, by the names under which the scene refers to its models.
const SCENE: &[u8] = include_bytes!("../../assets/scenes/default.scn");
const MODELS: [(&str, &[u8]); 3] = [
    ("letter-x.ply", include_bytes!("../../assets/scenes/letter-x.ply")),
    ("letter-y.ply", include_bytes!("../../assets/scenes/letter-y.ply")),
    ("wentletrap.ply", include_bytes!("../../assets/scenes/wentletrap.ply")),
];

/// A room with a lacquered table, and on it a seashell, a mirror ball and the letters X and Y.
///
/// It is read by the reader that reads every other scene. A test holds that this succeeds without
/// a warning; the error is there all the same, so that nothing here needs to panic.
pub fn default_scene() -> Result<(SceneBuilder, Report), ReadError> {
    let (mut builder, report) = read_scn(SCENE, "default.scn".as_ref(), &Memory(&MODELS))?;
    builder.name = "A wentletrap".to_owned();
    Ok((builder, report))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Report;

    #[test]
    fn reads_without_a_remark() {
        let (builder, report) = default_scene().unwrap();
        assert_eq!(report, Report::default());
        assert!(builder.is_lit());
        assert!(builder.camera.is_some());
        assert_eq!(builder.screen, [640, 480]);
    }

    #[test]
    fn no_surface_gives_back_more_than_it_gets() {
        // Exact for a constant reflectance; the Fresnel term adds at grazing angles, at most 1/21
        // of the hemisphere's light.
        for material in default_scene().unwrap().0.materials() {
            for (kd, ks) in material.kd.iter().zip(material.ks) {
                let specular = if material.ks == [0.0; 3] { 0.0 } else { ks + (1.0 - ks) / 21.0 };
                assert!(kd + specular <= 1.0, "{}", material.name);
            }
        }
    }

    #[test]
    fn camera_and_lights_are_inside_a_closed_room() {
        let scene = default_scene().unwrap().0.build();
        let counts = scene.counts();
        assert_eq!((counts.duplicates, counts.spheres), (0, 7));
        let [low, high] = scene.bounds();
        let eye = scene.camera().eye;
        assert!(low.cmplt(eye).all() && eye.cmplt(high).all(), "{eye} in {low} .. {high}");
        assert_eq!(scene.environment(), [0.0; 3]);
    }
}
