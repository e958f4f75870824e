//! The error over time: what is drawn and told of it, and how it leaves the window.

use super::*;
use crate::viewer::document::errors::Curve;
use crate::viewer::document::goal::{Goal, Stop};
use burnish::measure::error::{Pair, REL_RMSE, Reference};
use burnish::picture::{read_exr, write};
use burnish::progressive::{StopRule, render};
use egui::{ColorImage, OutputCommand, ViewportCommand};
use egui_kittest::kittest::NodeT;
use std::sync::Arc;

impl Desk {
    fn open_errors(&mut self) {
        // By its key, as lobes and pixel.
        self.key(Key::G);
        self.until_labelled("estimated");
    }

    /// Frame after frame until a label with this text is there.
    fn until_labelled(&mut self, text: &str) {
        let start = Instant::now();
        while self.harness.query_all_by_label_contains(text).next().is_none() {
            assert!(start.elapsed() < PATIENCE, "never told: {text}");
            std::thread::sleep(Duration::from_millis(2));
            self.harness.step();
        }
    }

    /// Renders to a number of passes while the window has input, so that it looks often.
    fn watch(&mut self, passes: u64) {
        // By way of every power of two: each of them is seen, however seldom the window has its turn.
        let powers = (0..).map(|power| 1 << power).take_while(|&power| power < passes);
        for limit in powers.chain([passes]) {
            self.document(|d| d.set_limit(limit));
            let start = Instant::now();
            let is_done = |app: &App| {
                let current = app.render.as_ref().and_then(|r| r.current());
                current.is_some_and(|s| s.state == State::Done && s.passes >= limit)
            };
            while !is_done(self.app()) {
                assert!(start.elapsed() < PATIENCE, "never {limit} passes");
                self.look();
            }
        }
        assert_eq!(self.newest().passes, passes);
        self.harness.run_ok();
    }

    /// One frame, with a pointer that moves.
    fn look(&mut self) {
        std::thread::sleep(Duration::from_millis(2));
        self.harness.hover_at(egui::pos2(2.0, 2.0));
        self.harness.step();
    }

    fn curve(&self) -> &Curve {
        let told = self.app().render.as_ref().unwrap().applied();
        self.doc().errors.of(told).expect("no curve")
    }

    fn seconds(&self) -> Vec<f64> {
        self.curve().estimated.points().iter().map(|p| p.seconds).collect()
    }

    /// The shapes that were drawn within the plot: of lines their points.
    fn lines_in_plot(&self) -> Vec<(Vec<Pos2>, Color32)> {
        let plot = self.harness.get_by_label("Error curves").rect();
        let mut lines = Vec::new();
        for clipped in &self.harness.output().shapes {
            if let egui::Shape::Path(path) = &clipped.shape
                && plot.contains(clipped.clip_rect.center())
                && let egui::epaint::ColorMode::Solid(colour) = path.stroke.color
            {
                lines.push((path.points.clone(), colour));
            }
        }
        lines
    }

    fn copied(&self) -> Option<String> {
        self.harness.output().platform_output.commands.iter().find_map(|c| match c {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    }
}

#[test]
fn the_curve_is_what_the_snapshots_told_and_pauses_are_not_in_it() {
    let mut desk = Desk::done(1);
    desk.watch(512);
    let newest = *desk.curve().estimated.newest().unwrap();
    let told = desk.newest().error.unwrap().relative;
    assert_eq!((newest.passes, newest.error, newest.limits), (512, told.value, told.interval));
    assert_eq!(newest.seconds, desk.newest().seconds);
    let before = desk.seconds();
    assert!(before.windows(2).all(|s| s[0] < s[1]) && before.len() >= 4, "{before:?}");
    // The clock of the picture stands still while nothing is traced.
    std::thread::sleep(Duration::from_millis(50));
    let resumed = Instant::now();
    desk.watch(600);
    let most = resumed.elapsed().as_secs_f64();
    let after = desk.seconds();
    let (last, then) = (before.last().unwrap(), after.last().unwrap());
    assert!(then > last && then - last <= most, "{last} {then}, {most}");
    // From the first pass again: the curve too.
    desk.key(Key::R);
    desk.watch(600);
    assert!(desk.seconds()[0] < *last, "{:?}", desk.seconds());
    assert!(desk.seconds().windows(2).all(|s| s[0] < s[1]));
}

#[test]
fn a_kept_picture_s_curve_goes_on_and_the_others_are_in_the_plot() {
    let mut desk = Desk::done(1);
    desk.watch(512);
    let ggx = desk.seconds();
    desk.key(Key::Num1);
    desk.watch(512);
    let phong = desk.seconds();
    desk.key(Key::Num3);
    desk.watch(1024);
    let more = desk.seconds();
    assert!(more.len() >= ggx.len() && more[0] == ggx[0] && more.last() > ggx.last());
    desk.key(Key::Num1);
    desk.harness.run_ok();
    assert_eq!(desk.seconds()[0], phong[0], "as it was left");
    desk.watch(1024);
    // Another roughness beside them.
    desk.type_into("alpha", "0.4");
    desk.watch(1024);
    desk.open_errors();
    for label in ["Phong 0.400", "Beckmann 0.400", "GGX 0.400", "Phong 0.063 to 0.20"] {
        assert!(desk.harness.query_by_label(label).is_some(), "{label}");
    }
    // Lines of different colours that fall from left to right, over the whole width.
    let plot = desk.harness.get_by_label("Error curves").rect();
    let lines = desk.lines_in_plot();
    let long: Vec<_> = lines.iter().filter(|(points, _)| points.len() > 4).collect();
    let colours: std::collections::HashSet<Color32> = long.iter().map(|(_, c)| *c).collect();
    assert!(long.len() >= 3 && colours.len() >= 3, "{} {}", long.len(), colours.len());
    for (points, _) in &long {
        let (first, last) = (points[0], points[points.len() - 1]);
        assert!(plot.contains(first) && plot.contains(last));
        assert!(points.windows(2).all(|p| p[0].x < p[1].x) && last.y > first.y, "{points:?}");
    }
}

#[test]
fn values_are_told_at_the_pointer_and_by_the_arrow_keys() {
    let mut desk = Desk::done(1);
    desk.watch(512);
    desk.open_errors();
    desk.harness.get_by_label("newest");
    let newest = percent_of(&desk);
    assert!(desk.harness.query_all_by_label(&newest).next().is_some(), "{newest}");
    let plot = desk.harness.get_by_label("Error curves").rect();
    desk.harness.hover_at(plot.center());
    desk.harness.run_ok();
    assert!(desk.harness.query_by_label("newest").is_none());
    let words = |desk: &Desk| -> String {
        let node = desk.harness.get_by_label_contains("after ");
        node.value().or(node.accesskit_node().label()).unwrap_or_default()
    };
    let seconds = |words: String| -> f64 {
        assert!(words.ends_with(" s"), "{words}");
        words.split(' ').nth(1).unwrap().parse().unwrap()
    };
    // The time is told to three digits, the error of the exact one.
    let at_pointer = seconds(words(&desk));
    let expected = 100.0 * desk.curve().estimated.at(at_pointer).expect("beside the curve");
    let figures: Vec<f64> = desk
        .harness
        .query_all_by_label_contains(" %")
        .filter_map(|n| n.value().unwrap_or_default().trim_end_matches(" %").parse().ok())
        .collect();
    let near = |found: &f64| (found / expected - 1.0).abs() < 0.05;
    assert!(figures.iter().any(near), "{expected}: {figures:?}");
    desk.harness.hover_at(egui::pos2(1.0, 1.0));
    desk.harness.run_ok();
    desk.harness.get_by_label("newest");
    desk.harness.get_by_label("Error curves").focus();
    desk.harness.run_ok();
    let middle = seconds(words(&desk));
    desk.key(Key::ArrowRight);
    desk.harness.run_ok();
    let right = seconds(words(&desk));
    assert!(right > middle, "{right} {middle}");
}

fn percent_of(desk: &Desk) -> String {
    let error = desk.newest().error.unwrap();
    let words = crate::viewer::style::numbers::percent(error.relative.value);
    if error.reliable { words } else { format!("{words} ?") }
}

/// Against a reference file the true error is that of the library's measure, and the estimate's
/// interval is about it.
#[test]
fn with_a_reference_the_true_error_is_told_too() {
    let mut desk = Desk::done(64);
    let params = burnish::progressive::Params { seed: 77, ..desk.doc().params.clone() };
    let reference = render(params, 4096, 0).unwrap().mean();
    let path = desk.folder.path().join("reference.exr");
    write(&path, &reference, Default::default()).unwrap();
    desk.open_errors();
    assert!(desk.curve().truth.points().is_empty(), "there is no reference yet");
    desk.harness.get_by_label("traced");
    let ctx = desk.harness.ctx.clone();
    desk.harness.state_mut().as_mut().unwrap().load(&ctx, Source::File(path.clone()), false);
    desk.until("the file", |app| app.doc().comparison.file.is_some());
    desk.key(Key::C);
    let has_truth = |app: &App| {
        let told = app.render.as_ref().unwrap().applied();
        app.doc().errors.of(told).is_some_and(|c| c.truth.newest().is_some())
    };
    desk.until("a true error", has_truth);
    desk.until_labelled("True error against reference.exr; its own error is unknown, and included");
    let found = *desk.curve().truth.newest().unwrap();
    let reference = Reference::known(read_exr(&path).unwrap());
    let mean = desk.newest().mean();
    let expected = REL_RMSE.of(&Pair::new(&mean, &reference).unwrap());
    assert_eq!((found.passes, found.error), (64, expected));
    assert_eq!(found.seconds, desk.newest().seconds);
    let interval = desk.newest().error.unwrap().relative.interval;
    assert!(
        interval.low * 0.8 < expected && expected < interval.high * 1.25,
        "{interval:?} {expected}"
    );
    desk.harness.get_by_label("true");
    // More passes are held against it too, and another picture is.
    desk.document(|d| d.set_limit(256));
    desk.until_done(256);
    desk.until("more of it", |app| {
        let told = app.render.as_ref().unwrap().applied();
        let curve = app.doc().errors.of(told).unwrap();
        curve.truth.newest().is_some_and(|p| p.passes == 256)
    });
    let points = desk.curve().truth.points();
    assert!(points.len() >= 2 && points.last().unwrap().error < points[0].error, "{points:?}");
    // None again: nothing is left of it.
    desk.click("None");
    desk.harness.run_ok();
    assert!(desk.curve().truth.points().is_empty());
    desk.harness.get_by_label("traced");
}

#[test]
fn a_tag_and_a_picture_of_another_size_as_reference_are_told_as_what_they_are() {
    let mut desk = Desk::done(40);
    let own = crate::viewer::style::numbers::percent(desk.newest().error.unwrap().relative.value);
    desk.key(Key::S);
    desk.until("snapshot", |app| app.notice.as_ref().is_some_and(|n| n.text.starts_with("Wrote")));
    desk.key(Key::T);
    desk.document(|d| d.params.seed = 3);
    desk.until_done(40);
    desk.open_errors();
    desk.click_role_within("Tag", "Reference");
    let told = format!("True error against the tag (GGX, 40 passes); its own error, {own}");
    desk.until_labelled(&told);
    // A snapshot tells its own error.
    let path = desk.folder.path().join("out").join("two_ggx_0001.exr");
    let ctx = desk.harness.ctx.clone();
    desk.harness.state_mut().as_mut().unwrap().load(&ctx, Source::File(path), false);
    desk.until("the file", |app| app.doc().comparison.file.is_some());
    desk.click_role_within("File", "Reference");
    desk.until_labelled(&format!("True error against two_ggx_0001.exr; its own error, {own}"));
    let path = desk.folder.path().join("small.exr");
    write(&path, &burnish::picture::Picture::black(8, 8), Default::default()).unwrap();
    let ctx = desk.harness.ctx.clone();
    desk.harness.state_mut().as_mut().unwrap().load(&ctx, Source::File(path), false);
    desk.until("the file", |app| {
        app.doc().comparison.file.as_ref().is_some_and(|f| f.name == "small.exr")
    });
    desk.until_labelled("No true error against small.exr: the picture has 64x48 pixels");
}

impl Desk {
    /// The button of that name in the line of the field.
    fn click_role_within(&mut self, name: &str, field: &str) {
        self.harness.run_ok();
        let line = self.harness.get_by_label(field).rect();
        self.harness
            .query_all_by_role_and_label(Role::Button, name)
            .find(|node| (node.rect().center().y - line.center().y).abs() < 8.0)
            .expect("no such button there")
            .click_accesskit();
        self.harness.run_ok();
    }
}

#[test]
fn the_curves_are_copied_as_a_table_and_written_as_svg_and_png() {
    let mut desk = Desk::done(40);
    desk.key(Key::Num2);
    desk.until_done(40);
    desk.open_errors();
    desk.click("Copy CSV");
    let table = desk.copied().expect("nothing on the clipboard");
    let expected = {
        let told = desk.app().render.as_ref().unwrap().applied();
        let curves = desk.doc().errors.of_view(told);
        assert_eq!(curves.len(), 2);
        curves.iter().map(|c| c.estimated.points().len()).sum::<usize>()
    };
    assert_eq!(table.lines().count(), 1 + expected);
    assert!(
        table.lines().nth(1).unwrap().starts_with("\"Beckmann 0.063 to 0.20\",estimated,"),
        "{table}"
    );
    desk.click("Save SVG");
    desk.until("plot", |app| app.notice.as_ref().is_some_and(|n| n.text.starts_with("Wrote")));
    assert_eq!(desk.files(), ["errors_two_0001.svg"]);
    let path = desk.folder.path().join("out/errors_two_0001.svg");
    let svg = std::fs::read_to_string(path).unwrap();
    for part in [
        "<svg",
        "Beckmann 0.063",
        "GGX 0.063",
        "seconds of tracing",
        "95 % limits",
        "#D55E00",
        "#009E73",
    ] {
        assert!(svg.contains(part), "{part}: {svg}");
    }
    desk.click("Save PNG");
    let plot = desk.harness.get_by_label("Error curves").rect();
    let viewport = &desk.harness.output().viewport_output[&egui::ViewportId::ROOT];
    let callback = viewport.commands.iter().find_map(|c| match c {
        ViewportCommand::Screenshot(callback) => Some(callback.clone()),
        _ => None,
    });
    let image = ColorImage::filled([1280, 1600], Color32::from_rgb(10, 200, 30));
    callback.expect("no picture of the window asked for").complete(Arc::new(image));
    desk.until("picture", |app| app.notice.as_ref().is_some_and(|n| n.text.contains(".png")));
    let written = image::open(desk.folder.path().join("out/errors_two_0001.png")).unwrap();
    assert_eq!(written.height(), plot.height().round() as u32);
}

/// What is told ahead is about what comes: of twelve pictures nine of ten forecasts from an eighth of the passes on,
/// and those from half of them on, and the time is told of it.
#[test]
fn the_time_that_an_error_takes_is_foreseen() {
    let all: Vec<Foreseen> = (0..12).map(foreseen).collect();
    for (part, least, most) in [(8, 0.4, 2.5), (2, 0.65, 1.6)] {
        let mut ratios: Vec<f64> = all.iter().flat_map(|one| one.ratios(part)).collect();
        ratios.sort_by(f64::total_cmp);
        assert!(ratios.len() >= 36);
        let [low, middle, high] = [1, 10, 18].map(|part| ratios[ratios.len() * part / 20]);
        assert!(low > least && high < most, "from 1/{part}: {low} to {high}");
        assert!((0.8..1.35).contains(&middle), "from 1/{part}: {middle} on the mean");
    }
    let sure = |one: &Foreseen| one.words.iter().any(|w| w.ends_with(" s"));
    assert!(all.iter().any(sure), "then it is: {:?}", all[0].words);
}

/// The passes after which something was foreseen, and what; and where the picture ended.
struct Foreseen {
    told: Vec<(u64, u64)>,
    end: u64,
    /// What the status line had of it.
    words: Vec<String>,
}

impl Foreseen {
    /// What was foreseen from this part of the passes on, over what came.
    fn ratios(&self, part: u64) -> impl Iterator<Item = f64> + '_ {
        let late = self.told.iter().filter(move |(passes, _)| passes * part >= self.end);
        late.map(|(_, found)| *found as f64 / self.end as f64)
    }
}

fn foreseen(seed: u64) -> Foreseen {
    let mut desk = Desk::done(1);
    desk.document(|d| d.params.seed = seed);
    desk.document(|d| d.goal = Goal { stop: Stop::Error, error: 0.0015, ..Goal::default() });
    let start = Instant::now();
    let mut foreseen: Vec<(u64, u64)> = Vec::new();
    let mut words = Vec::new();
    desk.harness.step();
    while !desk.app().render.as_ref().unwrap().is_done() {
        assert!(start.elapsed() < PATIENCE, "{foreseen:?}");
        desk.look();
        let (outlook, newest) = {
            let render = desk.app().render.as_ref().unwrap();
            (render.outlook(&desk.doc().errors), render.newest.clone().unwrap())
        };
        words.push(desk.doc().goal.ahead(&newest, outlook));
        if let (Some(trend), Some(error)) = (outlook.trend, newest.error)
            && let Some(end) = trend.end(StopRule { wanted: 0.0015 }, outlook.look, &error)
        {
            foreseen.push((newest.passes, end));
        }
    }
    let end = desk.newest().passes;
    assert!(end >= 128, "{end}: {foreseen:?}");
    assert!(words.iter().any(|w| w == "0.15 % in -"), "at first nothing is known: {words:?}");
    Foreseen { told: foreseen, end, words }
}
