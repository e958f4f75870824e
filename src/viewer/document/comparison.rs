//! The choice of two pictures to compare, and of their layout.

use crate::viewer::style::numbers::digits;
use burnish::brdf::Model;
use burnish::measure::match_roughness::Criterion;
use burnish::progressive::Snapshot;
use std::path::PathBuf;

/// Layout of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// One left of a bar, the other right of it.
    Wipe,
    SideBySide,
    /// The first; the second while a key is held.
    Flip,
    /// Where the second is brighter or darker by more than noise.
    Difference,
}

impl Layout {
    pub(crate) const ALL: [Layout; 4] =
        [Layout::Wipe, Layout::SideBySide, Layout::Flip, Layout::Difference];

    pub(crate) fn title(self) -> &'static str {
        match self {
            Layout::Wipe => "Wipe",
            Layout::SideBySide => "Side",
            Layout::Flip => "Flip",
            Layout::Difference => "Diff",
        }
    }

    pub(crate) fn tip(self) -> &'static str {
        match self {
            Layout::Wipe => {
                "The first picture left of a bar, the second right of it. Drag the bar."
            }
            Layout::SideBySide => "The two beside each other.",
            Layout::Flip => "The first picture; the second while X is held.",
            Layout::Difference => {
                "Colour where the second picture is brighter or darker than the first by more than \
                 noise explains (95 %, corrected for the number of pixels), grey elsewhere."
            }
        }
    }
}

/// The first of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum First {
    /// The picture being traced.
    Shown,
    Tag,
    File,
}

impl First {
    pub(crate) const ALL: [First; 3] = [First::Shown, First::Tag, First::File];

    pub(crate) fn title(self) -> &'static str {
        match self {
            First::Shown => "Shown",
            First::Tag => "Tag",
            First::File => "File",
        }
    }

    pub(crate) fn tip(self) -> &'static str {
        match self {
            First::Shown => "What is being traced, as the controls above have it.",
            First::Tag => "The picture as it was when it was tagged (T).",
            First::File => "An OpenEXR picture: open one by Ctrl-O, or drop it on the window.",
        }
    }
}

/// The second of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    /// The picture being traced, with another model.
    Model(Model),
    /// The picture being traced, with another roughness of the materials that the slider speaks of.
    Roughness,
    Tag,
    File,
}

impl Second {
    pub(crate) const ALL: [Second; 6] = [
        Second::Model(Model::Phong),
        Second::Model(Model::Beckmann),
        Second::Model(Model::Ggx),
        Second::Roughness,
        Second::Tag,
        Second::File,
    ];

    pub(crate) fn title(self) -> &'static str {
        match self {
            Second::Model(model) => model.title(),
            Second::Roughness => "Other alpha",
            Second::Tag => First::Tag.title(),
            Second::File => First::File.title(),
        }
    }
}

/// A picture that does not change any more.
#[derive(Clone)]
pub(crate) struct Frozen {
    pub(crate) name: String,
    pub(crate) snapshot: Snapshot,
    /// The file that can be gone on with, if it is such a one.
    pub(crate) resumable: Option<PathBuf>,
    /// Its own relative error, as far as it is known.
    pub(crate) noise: Option<f64>,
}

/// All that the section "Compare" sets. It stays the same from scene to scene.
#[derive(Clone)]
pub(crate) struct Comparison {
    pub(crate) on: bool,
    pub(crate) layout: Layout,
    pub(crate) first: First,
    pub(crate) second: Second,
    pub(crate) tag: Option<Frozen>,
    pub(crate) file: Option<Frozen>,
    /// The property that is equal where the second has another model; the alphas themselves if none.
    pub(crate) criterion: Option<Criterion>,
    /// The other alpha, where the second has another roughness.
    pub(crate) alpha: f64,
}

impl Default for Comparison {
    fn default() -> Comparison {
        Comparison {
            on: false,
            layout: Layout::Wipe,
            first: First::Shown,
            second: Second::Model(Model::Beckmann),
            tag: None,
            file: None,
            criterion: None,
            alpha: 0.1,
        }
    }
}

impl Comparison {
    /// Takes a picture that others are to be compared with.
    pub(crate) fn take_tag(&mut self, name: String, snapshot: Snapshot) {
        let noise = snapshot.error.map(|e| e.relative.value);
        self.tag = Some(Frozen { name, snapshot, resumable: None, noise });
    }

    /// Compares with this picture from now on.
    pub(crate) fn take_file(&mut self, frozen: Frozen) {
        self.file = Some(frozen);
        (self.on, self.second) = (true, Second::File);
        if self.first == First::File {
            self.first = First::Shown;
        }
    }

    /// Whether a difference takes the picture's place.
    pub(crate) fn is_difference(&self) -> bool {
        self.on && self.layout == Layout::Difference
    }

    /// The first picture, where that is not the one being traced.
    pub(crate) fn first_frozen(&self) -> Option<&Frozen> {
        match self.first {
            _ if !self.on => None,
            First::Shown => None,
            First::Tag => self.tag.as_ref(),
            First::File => self.file.as_ref(),
        }
    }

    /// The second picture, where that is not traced.
    pub(crate) fn second_frozen(&self) -> Option<&Frozen> {
        match self.second {
            Second::Model(_) | Second::Roughness => None,
            Second::Tag => self.tag.as_ref(),
            Second::File => self.file.as_ref(),
        }
    }

    /// Names of the two.
    pub(crate) fn names(&self, shown: Model) -> [String; 2] {
        let model = shown.title();
        let frozen = |f: Option<&Frozen>| f.map_or("none yet".to_owned(), |f| f.name.clone());
        let first = match self.first {
            First::Shown if self.second == Second::Roughness => format!("{model}, as it is"),
            First::Shown => model.to_owned(),
            First::Tag => format!("Tag: {}", frozen(self.tag.as_ref())),
            First::File => frozen(self.file.as_ref()),
        };
        let second = match self.second {
            Second::Model(model) => model.title().to_owned(),
            Second::Roughness => format!("{model}, alpha {}", digits(self.alpha, 4)),
            Second::Tag => format!("Tag: {}", frozen(self.tag.as_ref())),
            Second::File => frozen(self.file.as_ref()),
        };
        [first, second]
    }
}
