//! Two pictures against each other: which, how they are laid out, and what is to be told of their
//! difference.

use crate::viewer::document::Document;
use crate::viewer::jobs::background::Background;
use crate::viewer::keys::{self, Action};
use crate::viewer::picture::difference::{self, Answer, Question};
use crate::viewer::style::labels;
use crate::viewer::style::number_field::{NumberField, Written};
use crate::viewer::style::numbers::{digits, percent};
use crate::viewer::style::theme;
use crate::viewer::style::widgets::{self, Weight};
use burnish::brdf::{Model, Roughness};
use burnish::measure::match_roughness::{Criterion, Match, match_roughness};
use burnish::progressive::{Params, Snapshot};
use egui::{ComboBox, Ui};
use std::path::PathBuf;
use std::sync::Arc;

/// How two pictures are laid out.
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
    /// What is being traced.
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
    /// The same with another model.
    Model(Model),
    /// The same with another roughness of what the slider speaks of.
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

pub(crate) struct Compare {
    pub(crate) on: bool,
    pub(crate) layout: Layout,
    pub(crate) first: First,
    pub(crate) second: Second,
    pub(crate) tag: Option<Frozen>,
    pub(crate) file: Option<Frozen>,
    /// What is to be equal where the second has another model; the alphas themselves if none.
    pub(crate) criterion: Option<Criterion>,
    /// The other alpha.
    alpha: f64,
    matching: Background<Matching, Vec<(Roughness, Option<Match>)>>,
    difference: Background<Question, Answer>,
    /// Whether it was on when last drawn: its section opens with it.
    was_on: bool,
    /// What was last to be compared, and when, in egui's seconds.
    asked: Option<(Question, f64)>,
}

/// Pictures that are being traced are compared this often, in seconds: the workers want the cores.
const PAUSE: f64 = 1.0;

/// Which roughnesses are to be matched.
#[derive(Clone, Debug, PartialEq)]
struct Matching {
    from: Model,
    to: Model,
    criterion: Criterion,
    /// Different ones, in the order of the materials.
    roughnesses: Vec<Roughness>,
}

impl Compare {
    pub(crate) fn new() -> Compare {
        let matching = |m: &Matching| {
            let one = |&r: &Roughness| (r, match_roughness((m.from, r), m.to, m.criterion));
            m.roughnesses.iter().map(one).collect()
        };
        Compare {
            on: false,
            layout: Layout::Wipe,
            first: First::Shown,
            second: Second::Model(Model::Beckmann),
            tag: None,
            file: None,
            criterion: None,
            alpha: 0.1,
            matching: Background::new(matching),
            difference: Background::new(difference::compare),
            was_on: false,
            asked: None,
        }
    }

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

    /// What is to be traced beside the picture of the document, if that is what is compared.
    pub(crate) fn beside(&mut self, ctx: &egui::Context, document: &Document) -> Option<Params> {
        if !self.on {
            return None;
        }
        let params = &document.params;
        match self.second {
            Second::Model(model) => {
                let mut other = Params { model, ..params.clone() };
                for (from, to) in self.matched(ctx, document).unwrap_or_default() {
                    for material in Arc::make_mut(&mut other.materials) {
                        if material.roughness == from
                            && let Some(to) = to
                        {
                            material.roughness = to.roughness;
                        }
                    }
                }
                Some(other)
            }
            Second::Roughness => {
                let roughness = Roughness::from_alpha(self.alpha).ok()?;
                Some(document.with_roughness(roughness))
            }
            Second::Tag | Second::File => None,
        }
    }

    /// The matches of the roughnesses that there are, once they are found.
    fn matched(
        &mut self,
        ctx: &egui::Context,
        document: &Document,
    ) -> Option<Vec<(Roughness, Option<Match>)>> {
        let (Second::Model(to), Some(criterion)) = (self.second, self.criterion) else {
            return None;
        };
        let mut roughnesses: Vec<Roughness> = Vec::new();
        for material in document.params.materials.iter().filter(|m| m.ks != [0.0; 3]) {
            if !roughnesses.contains(&material.roughness) {
                roughnesses.push(material.roughness);
            }
        }
        let question = Matching { from: document.params.model, to, criterion, roughnesses };
        let (answer, current) = self.matching.ask(ctx, &question)?;
        current.then(|| answer.clone())
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

    /// What the two are called.
    pub(crate) fn names(&self, document: &Document) -> [String; 2] {
        let model = document.params.model.title();
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

    /// The newest comparison of the two, and whether it is of these very snapshots.
    pub(crate) fn compared(
        &mut self,
        ctx: &egui::Context,
        document: &Document,
        first: &Snapshot,
        second: &Snapshot,
    ) -> Option<&Answer> {
        let tone = document.tone;
        let question = Question { first: first.clone(), second: second.clone(), tone };
        let now = ctx.input(|i| i.time);
        let same_pictures = |q: &Question| {
            let epochs = |q: &Question| [q.first.epoch, q.second.epoch];
            epochs(q) == epochs(&question) && q.tone == tone
        };
        let waits = self.asked.as_ref().is_some_and(|(asked, at)| {
            *asked != question && same_pictures(asked) && now - at < PAUSE
        });
        if waits {
            ctx.request_repaint_after_secs(PAUSE as f32);
        } else if self.asked.as_ref().is_none_or(|(asked, _)| *asked != question) {
            self.asked = Some((question, now));
        }
        let (asked, _) = self.asked.as_ref()?;
        self.difference.ask(ctx, asked).map(|(answer, _)| answer)
    }

    /// Draws the section.
    pub(crate) fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        let badge = self.on.then(|| widgets::Badge { text: "on".to_owned(), warns: false });
        if std::mem::replace(&mut self.was_on, self.on) != self.on && self.on {
            widgets::open_section(ui, "compare");
        }
        widgets::section(ui, "compare", "Compare", badge, false, |ui| {
            self.layouts(ui);
            self.pictures(ui);
            if let Second::Model(model) = self.second {
                self.criterion(ui, document, model);
            }
            let buttons = [Action::Tag, Action::Browse];
            let entries =
                buttons.map(|a| (keys::binding(a).name, keys::tooltip(ui.ctx(), a), true));
            if let Some(i) = widgets::button_row(ui, &entries) {
                actions.push(buttons[i]);
            }
            if self.file.as_ref().is_some_and(|file| file.resumable.is_some()) {
                let entry = (labels::RESUME.name, labels::RESUME.tip.to_owned(), true);
                if widgets::button_row(ui, &[entry]).is_some() {
                    actions.push(Action::Resume);
                }
            }
            self.verdict(ui);
        });
    }

    fn layouts(&mut self, ui: &mut Ui) {
        let place = Layout::ALL.iter().position(|&l| l == self.layout).unwrap_or(0);
        let chosen = if self.on { place + 1 } else { 0 };
        let off = (labels::COMPARE_OFF.name, labels::COMPARE_OFF.tip.to_owned(), true);
        let entries: Vec<_> = std::iter::once(off)
            .chain(Layout::ALL.map(|l| (l.title(), l.tip().to_owned(), true)))
            .collect();
        match widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
            Some(0) => self.on = false,
            Some(i) => (self.on, self.layout) = (true, Layout::ALL[i - 1]),
            None => {}
        }
    }

    fn pictures(&mut self, ui: &mut Ui) {
        let there = [true, self.tag.is_some(), self.file.is_some()];
        let chosen = First::ALL.iter().position(|&f| f == self.first).unwrap_or(0);
        let pressed = widgets::field(ui, &labels::FIRST, |ui, _| {
            let entries = [0, 1, 2].map(|i: usize| {
                let first = First::ALL[i];
                (first.title(), first.tip().to_owned(), there[i])
            });
            widgets::segmented(ui, Weight::Quiet, chosen, &entries)
        });
        if let Some(i) = pressed {
            self.first = First::ALL[i];
        }
        widgets::field(ui, &labels::SECOND, |ui, label| {
            let other = self.second == Second::Roughness;
            let width = ui.available_width() - if other { 88.0 } else { 0.0 };
            let menu = ComboBox::from_id_salt("second")
                .width(width)
                .selected_text(self.second.title())
                .show_ui(ui, |ui| {
                    theme::quiet_choice(ui);
                    for second in Second::ALL {
                        let there = match second {
                            Second::Tag => there[1],
                            Second::File => there[2],
                            Second::Model(_) | Second::Roughness => true,
                        };
                        ui.add_enabled_ui(there, |ui| {
                            ui.selectable_value(&mut self.second, second, second.title());
                        });
                    }
                });
            menu.response.labelled_by(label).on_hover_text(labels::SECOND.tip);
            if other {
                let field = NumberField {
                    name: labels::OTHER_ALPHA.name,
                    range: Roughness::ALPHA,
                    speed: 0.01 * self.alpha,
                    written: Written::Digits(4),
                    unit: "",
                    prefix: "",
                    size: egui::vec2(80.0, ui.spacing().interact_size.y),
                };
                field
                    .ui(ui, &mut self.alpha)
                    .accessible_name(labels::OTHER_ALPHA.name)
                    .on_hover_text(labels::OTHER_ALPHA.tip);
            }
        });
    }

    fn criterion(&mut self, ui: &mut Ui, document: &Document, model: Model) {
        widgets::field(ui, &labels::MATCH, |ui, label| {
            let title = self.criterion.map_or(labels::SAME_ALPHA, Criterion::title);
            let menu = ComboBox::from_id_salt("match")
                .width(ui.available_width())
                .selected_text(title)
                .show_ui(ui, |ui| {
                    theme::quiet_choice(ui);
                    ui.selectable_value(&mut self.criterion, None, labels::SAME_ALPHA);
                    for criterion in Criterion::ALL {
                        let title = criterion.title();
                        ui.selectable_value(&mut self.criterion, Some(criterion), title);
                    }
                });
            menu.response.labelled_by(label).on_hover_text(labels::MATCH.tip);
        });
        if self.criterion.is_none() || model == document.params.model {
            return;
        }
        let Some(matched) = self.matched(ui.ctx(), document) else {
            ui.weak("Being matched\u{2026}");
            return;
        };
        const LINES: usize = 3;
        for (from, to) in matched.iter().take(LINES) {
            let words = match to {
                Some(to) => format!(
                    "alpha {} as {}: {} remains",
                    digits(from.alpha(), 3),
                    digits(to.roughness.alpha(), 3),
                    percent(to.remains)
                ),
                None => format!("alpha {}: {} is never so", digits(from.alpha(), 3), model.title()),
            };
            ui.weak(words).on_hover_text(labels::REMAINS);
        }
        if matched.len() > LINES {
            ui.weak(format!("and {} more", matched.len() - LINES));
        }
    }

    /// What was found of the difference.
    fn verdict(&self, ui: &mut Ui) {
        if !self.on {
            return;
        }
        let Some(answer) = self.difference.last() else { return };
        match &answer.verdict {
            Ok(verdict) => {
                ui.label(verdict.as_str()).on_hover_text(labels::VERDICT);
            }
            Err(why) => {
                ui.label(why.as_str());
            }
        }
    }
}
