//! The light that makes up a pixel: by scattering events, by technique, and sample by sample.

use super::heading;
use crate::viewer::style::labels;
use crate::viewer::style::numbers::digits;
use crate::viewer::style::theme;
use burnish::progressive::{LogHistogram, PixelReport, ProbeEstimate, Technique};
use burnish::trace::ReuseGroup;
use egui::{Align2, CornerRadius, Rect, Sense, TextStyle, Ui, pos2, vec2};

/// Steps a decade of the histogram, and its height in points.
const STEPS: usize = 8;
const HISTOGRAM: f32 = 88.0;
/// Widths of the columns of figures at the right, in points.
const COLUMNS: [f32; 3] = [72.0, 64.0, 44.0];

pub(super) fn draw(ui: &mut Ui, report: &PixelReport) {
    heading(ui, "Light by scattering events", labels::BY_EVENT_TIP);
    let rows = report.by_event.iter().enumerate().map(|(i, part)| {
        let name = match i {
            0 => "seen directly".to_owned(),
            1 => "once".to_owned(),
            i if i + 1 == PixelReport::EVENTS => format!("{i} and more"),
            i => format!("{i} times"),
        };
        (name, part)
    });
    parts(ui, rows, report);
    heading(ui, "Light by technique", labels::BY_TECHNIQUE_TIP);
    let named = Technique::ALL.into_iter().zip(&report.by_technique);
    parts(ui, named.map(|(t, part)| (t.title().to_owned(), part)), report);
    heading(ui, "Samples by luminance", labels::HISTOGRAM_TIP);
    histogram(ui, report);
    sharing(ui, report);
}

/// A table: name, luminance with its interval, share of the whole.
fn parts<'a>(
    ui: &mut Ui,
    rows: impl Iterator<Item = (String, &'a ProbeEstimate)>,
    report: &'a PixelReport,
) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        line(ui, "", ["luminance", "\u{b1} 95 %", "share"], None);
        let whole = report.total.luminance.value;
        for (name, part) in rows {
            row(ui, &name, part, whole);
        }
        row(ui, "all", &report.total, whole);
    });
}

fn row(ui: &mut Ui, name: &str, part: &ProbeEstimate, whole: f64) {
    let figure = part.luminance;
    let share = if whole > 0.0 { figure.value / whole } else { 0.0 };
    let figures = [
        digits(figure.value, 3),
        digits(figure.interval.high - figure.value, 2),
        format!("{:.0} %", 100.0 * share),
    ];
    let rgb = part
        .rgb
        .map(|f| format!("{} \u{b1} {}", digits(f.value, 3), digits(f.interval.high - f.value, 2)));
    let response = line(ui, name, figures.each_ref().map(String::as_str), Some(share));
    response.on_hover_text(format!("{name}, RGB in W/(m\u{b2} sr):\n{}", rgb.join("\n")));
}

/// One line of the table, with a bar behind it as long as the share; the head without.
fn line(ui: &mut Ui, name: &str, figures: [&str; 3], share: Option<f64>) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::hover());
    let (small, body, mono) = (TextStyle::Small, TextStyle::Body, TextStyle::Monospace);
    let [small, body, mono] = [small, body, mono].map(|s| s.resolve(ui.style()));
    let painter = ui.painter();
    let (weak, text) = (theme::weak(ui), ui.visuals().text_color());
    if let Some(share) = share {
        let width = rect.width() * share.clamp(0.0, 1.0) as f32;
        let bar = Rect::from_min_size(rect.min, vec2(width, rect.height() - 1.0));
        painter.rect_filled(bar, CornerRadius::same(2), ui.visuals().faint_bg_color);
    }
    let head = share.is_none();
    let at = rect.left_center() + vec2(4.0, 0.0);
    painter.text(at, Align2::LEFT_CENTER, name, body, text);
    let mut right = rect.right() - 4.0;
    for (figure, width) in figures.into_iter().zip(COLUMNS).rev() {
        let at = pos2(right, rect.center().y);
        let (font, colour) = if head { (small.clone(), weak) } else { (mono.clone(), text) };
        painter.text(at, Align2::RIGHT_CENTER, figure, font, colour);
        right -= width;
    }
    let words = format!("{name} {}", figures.join(" "));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, words.trim()));
    response
}

fn histogram(ui: &mut Ui, report: &PixelReport) {
    let size = vec2(ui.available_width(), HISTOGRAM);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let found = LogHistogram::new(&report.luminances, STEPS);
    let words = format!("{} of {} samples are black", found.rest, report.samples);
    response.on_hover_text(format!("{}\n{words}.", labels::HISTOGRAM_TIP));
    let (font, weak) = (TextStyle::Small.resolve(ui.style()), theme::weak(ui));
    let painter = ui.painter_at(rect);
    let top = rect.left_top();
    painter.text(top, Align2::LEFT_TOP, words, font.clone(), weak);
    let place = Rect::from_min_max(rect.min + vec2(0.0, 16.0), rect.max - vec2(0.0, 16.0));
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    painter.hline(place.x_range(), place.bottom(), line);
    let most = found.counts.iter().copied().max().unwrap_or(0).max(1);
    let width = place.width() / found.counts.len().max(1) as f32;
    let colour = ui.visuals().widgets.noninteractive.fg_stroke.color.gamma_multiply(0.7);
    for (i, &count) in found.counts.iter().enumerate() {
        let height = place.height() * count as f32 / most as f32;
        let left = place.left() + width * i as f32;
        let min = pos2(left + 0.5, place.bottom() - height);
        let bar = Rect::from_min_max(min, pos2(left + width - 0.5, place.bottom()));
        painter.rect_filled(bar, CornerRadius::ZERO, colour);
    }
    let [low, high] = found.decades;
    let at = |log: f64| {
        let share = (log - f64::from(low)) / f64::from((high - low).max(1));
        place.left() + place.width() * share.clamp(0.0, 1.0) as f32
    };
    let every = ((high - low) / 6).max(1);
    for decade in (low..=high).filter(|d| (d - low) % every == 0) {
        let align = match decade {
            d if d == low => Align2::LEFT_TOP,
            d if d == high => Align2::RIGHT_TOP,
            _ => Align2::CENTER_TOP,
        };
        let words = match decade {
            -2..=3 => digits(10f64.powi(decade), 1),
            d => format!("1e{d}"),
        };
        painter.text(
            pos2(at(decade.into()), place.bottom() + 3.0),
            align,
            words,
            font.clone(),
            weak,
        );
    }
    let mean = report.total.luminance.value;
    if mean > 0.0 && high > low {
        let accent = theme::accent_of(ui.visuals());
        let x = at(mean.log10());
        painter.vline(x, place.y_range(), egui::Stroke::new(1.0, accent));
        let words = format!("mean {}", digits(mean, 3));
        painter.text(rect.right_top(), Align2::RIGHT_TOP, words, font, accent);
    }
}

/// Describes how the picture's own samples differ from these.
fn sharing(ui: &mut Ui, report: &PixelReport) {
    let picture = &report.picture;
    let words = match (picture.group, picture.samples.get(picture.own)) {
        (ReuseGroup::None, _) | (_, None) => {
            "These are the pixel's own samples; the picture shares none either.".to_owned()
        }
        (group, Some(own)) => {
            let [whole, shared] = [own.whole, own.shared].map(|c| f64::from(c.luminance()));
            format!(
                "These are the pixel's own samples. The picture's have the same mean, but share \
                 what groups of {} paths find: its first here, replayed, is {}, of which {} came \
                 by its neighbours.",
                group.paths(),
                digits(whole, 3),
                digits(shared, 3),
            )
        }
    };
    ui.add(egui::Label::new(egui::RichText::new(words).small().weak()).wrap());
}
