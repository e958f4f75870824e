//! The true error: the distance of the picture from a reference that was chosen.

use crate::viewer::document::comparison::{Comparison, Frozen};
use crate::viewer::document::errors::Curves;
use crate::viewer::jobs::background::Background;
use crate::viewer::picture::difference::same_picture;
use crate::viewer::style::labels::{self, Control};
use crate::viewer::style::numbers::percent;
use crate::viewer::style::widgets::{self, Weight};
use burnish::measure::error::{Pair, REL_RMSE, Reference};
use burnish::progressive::{Params, Snapshot, State};
use egui::{Context, Ui};

/// The reference that the picture is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Against {
    Nothing,
    Tag,
    File,
}

impl Against {
    pub(crate) const ALL: [Against; 3] = [Against::Nothing, Against::Tag, Against::File];

    pub(crate) fn control(self) -> Control {
        match self {
            Against::Nothing => labels::AGAINST_NOTHING,
            Against::Tag => labels::AGAINST_TAG,
            Against::File => labels::AGAINST_FILE,
        }
    }
}

/// Pictures are held against the reference this often at most, in seconds, and only after this much
/// more time of tracing: the workers want the cores.
const PAUSE: f64 = 0.5;
const MORE: f64 = 1.07;

pub(super) struct Distances {
    /// The choice; a file, if there is one, where nothing was chosen.
    chosen: Option<Against>,
    reference: Option<Frozen>,
    /// Counts the references.
    number: u64,
    found: Background<Question, Answer>,
    /// The last question, and when it was asked, in egui's seconds.
    asked: Option<(Question, f64)>,
}

#[derive(Clone)]
struct Question {
    params: Params,
    picture: Snapshot,
    reference: Snapshot,
    number: u64,
}

impl PartialEq for Question {
    fn eq(&self, o: &Question) -> bool {
        self.number == o.number
            && self.params == o.params
            && self.picture.seconds == o.picture.seconds
            && same_picture(&self.picture, &o.picture)
    }
}

struct Answer {
    params: Params,
    seconds: f64,
    passes: u64,
    /// The reference's number.
    number: u64,
    /// The relative error, or why there is none.
    distance: Result<f64, String>,
}

/// A few hundredths of a second for a million pixels.
fn answer(question: &Question) -> Answer {
    let Question { params, picture, reference, number } = question;
    let distance = distance(picture, reference);
    let (seconds, passes) = (picture.seconds, picture.passes);
    Answer { params: params.clone(), seconds, passes, number: *number, distance }
}

/// `sqrt(mean((x - r)^2 / (r^2 + 0.01)))`, nothing subtracted: the reference's own noise is in it.
fn distance(picture: &Snapshot, reference: &Snapshot) -> Result<f64, String> {
    let reference = Reference::known(reference.mean());
    let mean = picture.mean();
    Pair::new(&mean, &reference).map(|pair| REL_RMSE.of(&pair)).map_err(|e| e.to_string())
}

impl Default for Distances {
    fn default() -> Distances {
        let found = Background::new(answer);
        Distances { chosen: None, reference: None, number: 0, found, asked: None }
    }
}

impl Distances {
    /// Whether there is something that pictures are held against.
    pub(super) fn is_chosen(&self) -> bool {
        self.reference.is_some()
    }

    /// Draws the choice, and follows it.
    pub(super) fn choose(&mut self, ui: &mut Ui, comparison: &Comparison) {
        let there = [true, comparison.tag.is_some(), comparison.file.is_some()];
        let default = if there[2] { Against::File } else { Against::Nothing };
        let place = |a: Against| Against::ALL.iter().position(|&b| a == b).unwrap_or(0);
        let mut chosen = self.chosen.filter(|&a| there[place(a)]).unwrap_or(default);
        let entries = Against::ALL.map(|a| {
            let Control { name, tip } = a.control();
            (name, tip.to_owned(), there[place(a)])
        });
        widgets::field(ui, &labels::AGAINST, |ui, _| {
            if let Some(i) = widgets::segmented(ui, Weight::Quiet, place(chosen), &entries) {
                chosen = Against::ALL[i];
                self.chosen = Some(chosen);
            }
        });
        self.reference = match chosen {
            Against::Nothing => None,
            Against::Tag => comparison.tag.clone(),
            Against::File => comparison.file.clone(),
        };
    }

    /// Has the picture held against the reference, and notes what came of it.
    pub(super) fn ask(
        &mut self,
        ctx: &Context,
        params: &Params,
        newest: Option<&Snapshot>,
        curves: &mut Curves,
    ) {
        let Some(reference) = self.reference.as_ref().map(|r| r.snapshot.clone()) else {
            if self.asked.take().is_some() {
                self.number += 1;
                curves.forget_truth();
            }
            return;
        };
        let before = self.asked.as_ref().map(|(asked, _)| &asked.reference);
        if before.is_some_and(|before| !same_picture(before, &reference)) {
            self.asked = None;
            self.number += 1;
            curves.forget_truth();
        }
        if let Some(picture) = newest.filter(|s| s.passes > 0) {
            let (params, picture, number) = (params.clone(), picture.clone(), self.number);
            self.pace(ctx, Question { params, picture, reference, number });
        }
        let Some((asked, _)) = &self.asked else { return };
        let Some((answer, _)) = self.found.ask(ctx, asked) else { return };
        if let (Ok(distance), true) = (&answer.distance, answer.number == self.number) {
            curves.note_truth(&answer.params, answer.seconds, answer.passes, *distance);
        }
    }

    /// Asks this next, if it is time.
    fn pace(&mut self, ctx: &Context, question: Question) {
        let now = ctx.input(|i| i.time);
        let Some((asked, at)) = &self.asked else {
            self.asked = Some((question, now));
            return;
        };
        if *asked == question {
            return;
        }
        let same = asked.params == question.params;
        let rests = question.picture.state != State::Running;
        let more = question.picture.seconds >= MORE * asked.picture.seconds
            || question.picture.seconds < asked.picture.seconds;
        if now - at < PAUSE {
            ctx.request_repaint_after_secs((PAUSE - (now - at)).max(0.01) as f32);
        } else if !same || rests || more {
            self.asked = Some((question, now));
        }
    }

    /// Describes the origin of the numbers.
    pub(super) fn words(&self) -> String {
        let Some(Frozen { name, snapshot, noise, .. }) = &self.reference else {
            return "Estimated by the picture itself, from the spread of its 4 independent \
                    replicates."
                .to_owned();
        };
        let last = self.found.last().filter(|answer| answer.number == self.number);
        if let Some(Err(why)) = last.map(|answer| &answer.distance) {
            return format!("No true error against {name}: {why}.");
        }
        let noise = match noise {
            Some(noise) => format!("its own error, {}, is included", percent(*noise)),
            None => "its own error is unknown, and included".to_owned(),
        };
        match snapshot.counts.paths {
            0 => format!("True error against {name}; {noise}."),
            _ => format!("True error against the tag ({name}); {noise}, what both share is not."),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::picture::frozen::snapshot;
    use burnish::picture::Picture;

    #[test]
    fn the_distance_is_by_the_formula_of_the_estimate() {
        let of = |pixels: [[f32; 3]; 2]| {
            snapshot(&Picture { width: 2, height: 1, pixels: pixels.to_vec() })
        };
        let picture = of([[1.1; 3], [0.0, 0.2, 0.0]]);
        let reference = of([[1.0; 3], [0.0, 0.1, 0.0]]);
        let expected = ((3.0 * 0.01 / 1.01 + 0.01 / 0.02) / 6.0f64).sqrt();
        let found = distance(&picture, &reference).unwrap();
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        let wide = snapshot(&Picture::black(3, 1));
        assert!(distance(&picture, &wide).unwrap_err().contains("3x1"));
    }
}
