//! Scenes that are part of the program itself.

pub use super::examples::{EXAMPLES, Example};

use super::read::{Memory, ReadError, read_scn};
use super::{Report, SceneBuilder};

impl Example {
    /// Reads it with the reader that reads every other scene. A test holds that this succeeds
    /// without a warning; the error is there all the same, so that nothing here needs to panic.
    pub fn read(&self) -> Result<(SceneBuilder, Report), ReadError> {
        let path = format!("{}.scn", self.name);
        let (mut builder, report) = read_scn(self.text, path.as_ref(), &Memory(self.models))?;
        builder.name = self.title.to_owned();
        builder.source.example = Some(self.name);
        Ok((builder, report))
    }
}

/// A closed room with a dark, satin floor, and on it a knot of satin brass and two balls.
pub fn default_scene() -> Result<(SceneBuilder, Report), ReadError> {
    EXAMPLES[0].read()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Kind;
    use crate::scene::{Light, Material};

    #[test]
    fn all_read_without_a_remark_but_on_their_normals() {
        for example in &EXAMPLES {
            let (builder, report) = example.read().unwrap();
            assert!(report.warnings.is_empty(), "{}: {report:?}", example.name);
            assert!(report.notes.iter().all(|note| note.starts_with("normals: ")), "{report:?}");
            assert!(builder.is_lit() && builder.camera.is_some(), "{}", example.name);
            assert_eq!(builder.caption.as_deref(), example.caption(), "{}", example.name);
            let words = example.caption().unwrap().split_whitespace().count();
            assert!((5..=30).contains(&words), "{}: {words} words", example.name);
            assert_eq!(Example::named(example.name), Some(example));
            assert_eq!(Example::named(&example.name.to_uppercase()), Some(example));
        }
    }

    #[test]
    fn names_and_titles_are_told_apart() {
        for (i, a) in EXAMPLES.iter().enumerate() {
            assert!(a.name.bytes().all(|b| b.is_ascii_lowercase()), "{}", a.name);
            for b in &EXAMPLES[..i] {
                assert!(a.name != b.name && a.title != b.title && a.shows != b.shows);
            }
        }
        assert_eq!(Example::named("DEFAULT").map(|e| e.name), Some("default"));
        assert_eq!(Example::named("no such scene"), None);
    }

    #[test]
    fn each_shows_what_it_says() {
        let scene = |name: &str| Example::named(name).unwrap().read().unwrap().0.build();
        let gallery = scene("gallery");
        // Three rows of seven, and two lamps.
        assert_eq!(gallery.counts().spheres, 3 * 7 + 2);

        let furnace = scene("furnace");
        assert_eq!(furnace.environment(), [1.0; 3]);
        assert!(furnace.materials().iter().all(|m| !m.emits()), "no other light");
        let lossless =
            |m: &Material| m.kd.iter().zip(m.ks).all(|(kd, ks)| (kd + ks - 1.0).abs() < 1e-6);
        assert_eq!(furnace.materials().iter().filter(|m| lossless(m)).count(), 3 * 5 + 1);

        let lights = scene("lights");
        let power = |light: &Light| -> f32 {
            let Kind::Sphere(i) = lights.geometry().kind(light.shape.first) else { return 0.0 };
            let radius = lights.geometry().spheres[i].radius;
            lights.materials()[light.material as usize].emission.iter().sum::<f32>()
                * radius.powi(2)
        };
        let powers: Vec<f32> = lights.surfaces().iter().map(power).filter(|&p| p > 0.0).collect();
        let weakest = powers.iter().copied().fold(f32::INFINITY, f32::min);
        let strongest = powers.iter().copied().fold(0.0, f32::max);
        assert_eq!(powers.len(), 200);
        assert!((140.0..160.0).contains(&(strongest / weakest)), "{}", strongest / weakest);

        let urchin = scene("urchin").counts();
        assert!(urchin.triangles > 3 * 120_000, "{urchin:?}");
        assert_eq!(urchin.duplicates, 0);
    }

    #[test]
    fn no_surface_gives_back_more_than_it_gets() {
        // Exact for a constant reflectance; the Fresnel term adds at grazing angles, at most 1/21
        // of the hemisphere's light.
        let read = |name: &str| Example::named(name).unwrap().read().unwrap().0;
        for material in ["default", "shell"].iter().flat_map(|n| read(n).materials().to_vec()) {
            for (kd, ks) in material.kd.iter().zip(material.ks) {
                let specular = if material.ks == [0.0; 3] { 0.0 } else { ks + (1.0 - ks) / 21.0 };
                assert!(kd + specular <= 1.0, "{}", material.name);
            }
        }
    }

    #[test]
    fn camera_and_lights_are_inside_a_closed_room() {
        for (name, spheres) in [("default", 4), ("shell", 7)] {
            let scene = Example::named(name).unwrap().read().unwrap().0.build();
            let counts = scene.counts();
            assert_eq!((counts.duplicates, counts.spheres), (0, spheres), "{name}");
            let [low, high] = scene.bounds();
            let eye = scene.camera().eye;
            assert!(low.cmplt(eye).all() && eye.cmplt(high).all(), "{eye} in {low} .. {high}");
            assert_eq!(scene.environment(), [0.0; 3]);
        }
    }
}
