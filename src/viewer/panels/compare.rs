//! The section "Compare": which two pictures, how they are laid out, and what is found of their difference.

use crate::viewer::document::Document;
use crate::viewer::document::comparison::{Comparison, First, Layout, Second};
use crate::viewer::jobs::background::Background;
use crate::viewer::keys::{self, Action};
use crate::viewer::panels::Panel;
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
use std::sync::Arc;

pub(crate) struct Compare {
    matching: Background<Matching, Vec<(Roughness, Option<Match>)>>,
    difference: Background<Question, Answer>,
    /// Whether it was on when last drawn: its section opens with it.
    was_on: bool,
    /// The last question, and when it was asked, in egui's seconds.
    asked: Option<(Question, f64)>,
}

/// Pictures that are being traced are compared this often, in seconds: the workers want the cores.
const PAUSE: f64 = 1.0;

/// Roughnesses to be matched.
#[derive(Clone, Debug, PartialEq)]
struct Matching {
    from: Model,
    to: Model,
    criterion: Criterion,
    /// Different ones, in the order of the materials.
    roughnesses: Vec<Roughness>,
}

impl Default for Compare {
    fn default() -> Compare {
        let matching = |m: &Matching| {
            let one = |&r: &Roughness| (r, match_roughness((m.from, r), m.to, m.criterion));
            m.roughnesses.iter().map(one).collect()
        };
        Compare {
            matching: Background::new(matching),
            difference: Background::new(difference::compare),
            was_on: false,
            asked: None,
        }
    }
}

impl Compare {
    /// Parameters to be traced beside those of the document, if such two are compared.
    pub(crate) fn beside(&mut self, ctx: &egui::Context, document: &Document) -> Option<Params> {
        let Comparison { on, second, alpha, .. } = document.comparison;
        if !on {
            return None;
        }
        let params = &document.params;
        match second {
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
                let roughness = Roughness::from_alpha(alpha).ok()?;
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
        let Comparison { second, criterion, .. } = document.comparison;
        let (Second::Model(to), Some(criterion)) = (second, criterion) else { return None };
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

    fn criterion(&mut self, ui: &mut Ui, document: &mut Document, model: Model) {
        criterion_menu(ui, &mut document.comparison.criterion);
        if document.comparison.criterion.is_none() || model == document.params.model {
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

    /// Draws the verdict on the difference.
    fn verdict(&self, ui: &mut Ui) {
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

impl Panel for Compare {
    fn ui(&mut self, ui: &mut Ui, document: &mut Document, actions: &mut Vec<Action>) {
        let on = document.comparison.on;
        let badge = on.then(|| widgets::Badge { text: "on".to_owned(), warns: false });
        if std::mem::replace(&mut self.was_on, on) != on && on {
            widgets::open_section(ui, "compare");
        }
        widgets::section(ui, "compare", "Compare", badge, false, |ui| {
            layouts(ui, &mut document.comparison);
            pictures(ui, &mut document.comparison);
            if let Second::Model(model) = document.comparison.second {
                self.criterion(ui, document, model);
            }
            let buttons = [Action::Tag, Action::Browse];
            let entries =
                buttons.map(|a| (keys::binding(a).name, keys::tooltip(ui.ctx(), a), true));
            if let Some(i) = widgets::button_row(ui, &entries) {
                actions.push(buttons[i]);
            }
            if document.comparison.file.as_ref().is_some_and(|file| file.resumable.is_some()) {
                let entry = (labels::RESUME.name, labels::RESUME.tip.to_owned(), true);
                if widgets::button_row(ui, &[entry]).is_some() {
                    actions.push(Action::Resume);
                }
            }
            if document.comparison.on {
                self.verdict(ui);
            }
        });
    }
}

fn layouts(ui: &mut Ui, comparison: &mut Comparison) {
    let place = Layout::ALL.iter().position(|&l| l == comparison.layout).unwrap_or(0);
    let chosen = if comparison.on { place + 1 } else { 0 };
    let off = (labels::COMPARE_OFF.name, labels::COMPARE_OFF.tip.to_owned(), true);
    let entries: Vec<_> = std::iter::once(off)
        .chain(Layout::ALL.map(|l| (l.title(), l.tip().to_owned(), true)))
        .collect();
    match widgets::segmented(ui, Weight::Quiet, chosen, &entries) {
        Some(0) => comparison.on = false,
        Some(i) => (comparison.on, comparison.layout) = (true, Layout::ALL[i - 1]),
        None => {}
    }
}

fn pictures(ui: &mut Ui, comparison: &mut Comparison) {
    let there = [true, comparison.tag.is_some(), comparison.file.is_some()];
    let chosen = First::ALL.iter().position(|&f| f == comparison.first).unwrap_or(0);
    let pressed = widgets::field(ui, &labels::FIRST, |ui, _| {
        let entries = [0, 1, 2].map(|i: usize| {
            let first = First::ALL[i];
            (first.title(), first.tip().to_owned(), there[i])
        });
        widgets::segmented(ui, Weight::Quiet, chosen, &entries)
    });
    if let Some(i) = pressed {
        comparison.first = First::ALL[i];
    }
    widgets::field(ui, &labels::SECOND, |ui, label| {
        let other = comparison.second == Second::Roughness;
        let width = ui.available_width() - if other { 88.0 } else { 0.0 };
        let menu = ComboBox::from_id_salt("second")
            .width(width)
            .selected_text(comparison.second.title())
            .show_ui(ui, |ui| {
                theme::quiet_choice(ui);
                for second in Second::ALL {
                    let there = match second {
                        Second::Tag => there[1],
                        Second::File => there[2],
                        Second::Model(_) | Second::Roughness => true,
                    };
                    ui.add_enabled_ui(there, |ui| {
                        ui.selectable_value(&mut comparison.second, second, second.title());
                    });
                }
            });
        menu.response.labelled_by(label).on_hover_text(labels::SECOND.tip);
        if other {
            let field = NumberField {
                name: labels::OTHER_ALPHA.name,
                range: Roughness::ALPHA,
                speed: 0.01 * comparison.alpha,
                written: Written::Digits(4),
                unit: "",
                prefix: "",
                size: egui::vec2(80.0, ui.spacing().interact_size.y),
            };
            field
                .ui(ui, &mut comparison.alpha)
                .accessible_name(labels::OTHER_ALPHA.name)
                .on_hover_text(labels::OTHER_ALPHA.tip);
        }
    });
}

fn criterion_menu(ui: &mut Ui, chosen: &mut Option<Criterion>) {
    widgets::field(ui, &labels::MATCH, |ui, label| {
        let title = chosen.map_or(labels::SAME_ALPHA, Criterion::title);
        let menu = ComboBox::from_id_salt("match")
            .width(ui.available_width())
            .selected_text(title)
            .show_ui(ui, |ui| {
                theme::quiet_choice(ui);
                ui.selectable_value(chosen, None, labels::SAME_ALPHA);
                for criterion in Criterion::ALL {
                    let title = criterion.title();
                    ui.selectable_value(chosen, Some(criterion), title);
                }
            });
        menu.response.labelled_by(label).on_hover_text(labels::MATCH.tip);
    });
}
