//! The texts and models of the shipped scenes.

/// A shipped scene, one of [`EXAMPLES`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// Lower-case name, as the command line takes it; that of its file in `assets/scenes`.
    pub name: &'static str,
    /// As a person writes it.
    pub title: &'static str,
    /// What it shows.
    pub shows: &'static str,
    pub(super) text: &'static [u8],
    /// The models, by the names under which the scene refers to them.
    pub(super) models: &'static [(&'static str, &'static [u8])],
}

/// The bytes of files in `assets/scenes`, by name.
macro_rules! files {
    ($($name:literal),*) => {
        &[$(($name, include_bytes!(concat!("../../assets/scenes/", $name)))),*]
    };
}

/// All of them, the default scene first. A static: a constant would be in the binary once for every crate that names it.
pub static EXAMPLES: [Example; 8] = [
    Example {
        name: "default",
        title: "Brass knot",
        shows: "a knot of satin brass, steel and lacquer: where the three models differ most",
        text: include_bytes!("../../assets/scenes/default.scn"),
        models: files!["knot.ply", "softbox.ply"],
    },
    Example {
        name: "shell",
        title: "Shell on a table",
        shows: "a seashell, a mirror ball and two letters on a lacquered table",
        text: include_bytes!("../../assets/scenes/shell.scn"),
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
        shows: "copper, lacquer and plastic from polished to rough: switch the models and watch",
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
        shows: "386,280 triangles under three glazes: knobs by the hundred, each with its highlight",
        text: include_bytes!("../../assets/scenes/urchin.scn"),
        models: files!["urchin.ply"],
    },
];

impl Example {
    /// The one of this name.
    pub fn named(name: &str) -> Option<&'static Example> {
        EXAMPLES.iter().find(|e| e.name.eq_ignore_ascii_case(name))
    }

    /// What to look for in it, one line: its text's `caption`. All have one, which a test holds.
    pub fn caption(&self) -> Option<&'static str> {
        let lines = str::from_utf8(self.text).ok()?.lines();
        lines.filter_map(|line| line.trim().strip_prefix("caption ")).next_back().map(str::trim)
    }
}

/// A model of a shipped scene. A shipped scene that was edited and saved elsewhere finds its models
/// by this.
pub(super) fn model(name: &str) -> Option<&'static [u8]> {
    let models = EXAMPLES.iter().flat_map(|example| example.models);
    models.into_iter().find(|(known, _)| *known == name).map(|(_, bytes)| *bytes)
}
