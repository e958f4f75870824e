//! Scenes that are part of the program itself.

use super::read::{Memory, ReadError, read_scn};
use super::{Report, SceneBuilder};

/// A shipped scene, one of [`EXAMPLES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// Lower-case name, as the command line takes it; that of its file in `assets/scenes`.
    pub name: &'static str,
    /// As a person writes it.
    pub title: &'static str,
    /// What it shows.
    pub shows: &'static str,
    text: &'static [u8],
    /// The models, by the names under which the scene refers to them.
    models: &'static [(&'static str, &'static [u8])],
}

/// The bytes of files in `assets/scenes`, by name.
macro_rules! files {
    ($($name:literal),*) => {
        &[$(($name, include_bytes!(concat!("../../assets/scenes/", $name)))),*]
    };
}

/// All of them, the default scene first.
pub const EXAMPLES: [Example; 7] = [
    Example {
        name: "default",
        title: "A wentletrap",
        shows: "a seashell, a mirror ball and two letters on a lacquered table",
        text: include_bytes!("../../assets/scenes/default.scn"),
        models: files!["letter-x.ply", "letter-y.ply", "wentletrap.ply"],
    },
    Example {
        name: "cornell",
        title: "Cornell box",
        shows: "walls that colour each other; all diffuse, as measured in 1985",
        text: include_bytes!("../../assets/scenes/cornell.scn"),
        models: files![
            "cornell-white.ply",
            "cornell-red.ply",
            "cornell-green.ply",
            "cornell-lamp.ply"
        ],
    },
    Example {
        name: "plates",
        title: "Four plates",
        shows: "four roughnesses under four lamp sizes: why two ways to find light are weighed",
        text: include_bytes!("../../assets/scenes/plates.scn"),
        models: files!["plate.ply"],
    },
    Example {
        name: "gallery",
        title: "Gallery",
        shows: "copper, lacquer and plastic from polished to rough: go through the models",
        text: include_bytes!("../../assets/scenes/gallery.scn"),
        models: &[],
    },
    Example {
        name: "furnace",
        title: "White furnace",
        shows: "light 1 from everywhere: what gives all of it back vanishes, darker loses light",
        text: include_bytes!("../../assets/scenes/furnace.scn"),
        models: &[],
    },
    Example {
        name: "lights",
        title: "Two hundred lights",
        shows: "a hall with bulbs of many colours and powers: which one is asked for light matters",
        text: include_bytes!("../../assets/scenes/lights.scn"),
        models: &[],
    },
    Example {
        name: "urchin",
        title: "Sea urchins",
        shows: "610,500 triangles under three glazes: knobs by the hundred, each with its highlight",
        text: include_bytes!("../../assets/scenes/urchin.scn"),
        models: files!["urchin.ply"],
    },
];

impl Example {
    /// The one of this name.
    pub fn named(name: &str) -> Option<&'static Example> {
        EXAMPLES.iter().find(|e| e.name == name)
    }

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

/// A model of a shipped scene. A shipped scene that was edited and saved elsewhere finds its models
/// by this.
pub(super) fn model(name: &str) -> Option<&'static [u8]> {
    let models = EXAMPLES.iter().flat_map(|example| example.models);
    models.into_iter().find(|(known, _)| *known == name).map(|(_, bytes)| *bytes)
}

/// A room with a lacquered table, and on it a seashell, a mirror ball and the letters X and Y.
pub fn default_scene() -> Result<(SceneBuilder, Report), ReadError> {
    EXAMPLES[0].read()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Report;

    #[test]
    fn all_read_without_a_remark() {
        for example in EXAMPLES {
            let (builder, report) = example.read().unwrap();
            assert_eq!(report, Report::default(), "{}", example.name);
            assert!(builder.is_lit() && builder.camera.is_some(), "{}", example.name);
            assert_eq!(Example::named(example.name), Some(&example));
        }
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
