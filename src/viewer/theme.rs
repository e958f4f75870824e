//! Colours, spacing and type, and the few widgets that egui does not have.

use egui::collapsing_header::CollapsingState;
use egui::{
    Button, Color32, Context, CornerRadius, FontFamily, FontId, Margin, Rect, Response,
    Role, Sense, Shape, Stroke, StrokeKind, Style, TextStyle, Ui, Vec2, Visuals, WidgetInfo, pos2,
    vec2,
};

/// Width of the side panel in points.
pub(super) const PANEL: f32 = 304.0;
/// Between things that belong together, and between groups.
pub(super) const GAP: f32 = 8.0;
pub(super) const GROUP: f32 = 16.0;
const RADIUS: CornerRadius = CornerRadius::same(4);
/// Height of a line, and width of the column of names.
const ROW: f32 = 24.0;
const LABELS: f32 = 72.0;

/// The one accent, a polished bronze; on dark ground and on light.
fn accent(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0xd6, 0x9b, 0x5c) } else { Color32::from_rgb(0x8a, 0x56, 0x20) }
}

/// The ground on which the picture is judged: neutral, of middle lightness.
pub(super) fn surround(visuals: &Visuals) -> Color32 {
    Color32::from_gray(if visuals.dark_mode { 0x50 } else { 0x9a })
}

/// For what is beside the point.
fn weak(ui: &Ui) -> Color32 {
    ui.visuals().weak_text_color()
}

/// For warnings.
pub(super) fn accent_of(visuals: &Visuals) -> Color32 {
    accent(visuals.dark_mode)
}

/// Sets up both themes.
pub(super) fn install(ctx: &Context) {
    ctx.set_style_of(egui::Theme::Dark, style(true));
    ctx.set_style_of(egui::Theme::Light, style(false));
    // The window's own zoom keys would change what Ctrl-plus and Ctrl-minus mean; keep them.
}

fn style(dark: bool) -> Style {
    let mut style = Style { visuals: visuals(dark), ..Style::default() };
    let font = |size, family| FontId::new(size, family);
    style.text_styles = [
        (TextStyle::Small, font(11.0, FontFamily::Proportional)),
        (TextStyle::Body, font(13.0, FontFamily::Proportional)),
        (TextStyle::Button, font(13.0, FontFamily::Proportional)),
        (TextStyle::Heading, font(16.0, FontFamily::Proportional)),
        (TextStyle::Monospace, font(12.0, FontFamily::Monospace)),
    ]
    .into();
    style.drag_value_text_style = TextStyle::Monospace;
    style.animation_time = 0.1;
    style.explanation_tooltips = false;
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(GAP, GAP);
    spacing.button_padding = vec2(8.0, 4.0);
    spacing.interact_size = vec2(40.0, ROW);
    spacing.slider_rail_height = 4.0;
    spacing.icon_width = 16.0;
    spacing.indent = 16.0;
    spacing.tooltip_width = 320.0;
    spacing.window_margin = Margin::same(16);
    style.interaction.tooltip_delay = 0.4;
    style.interaction.selectable_labels = false;
    style
}

fn visuals(dark: bool) -> Visuals {
    let grey = Color32::from_gray;
    let mut v = if dark { Visuals::dark() } else { Visuals::light() };
    let accent = accent(dark);
    // From the ground upwards: panel, lines, fields, fields under the pointer, text.
    let [panel, line, field, hover, press, weak, text, strong] = if dark {
        [0x22, 0x38, 0x34, 0x40, 0x2c, 0x98, 0xd0, 0xf4].map(grey)
    } else {
        [0xf2, 0xd4, 0xe2, 0xd6, 0xc8, 0x60, 0x2c, 0x08].map(grey)
    };
    v.panel_fill = panel;
    v.window_fill = panel;
    v.window_stroke = Stroke::new(1.0, line);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = RADIUS;
    v.extreme_bg_color = if dark { grey(0x18) } else { grey(0xff) };
    v.faint_bg_color = field;
    v.weak_text_color = Some(weak);
    v.hyperlink_color = accent;
    v.warn_fg_color = accent;
    v.error_fg_color = if dark {
        Color32::from_rgb(0xff, 0x6b, 0x60)
    } else {
        Color32::from_rgb(0xb8, 0x1c, 0x14)
    };
    v.selection.bg_fill = if dark {
        Color32::from_rgb(0x86, 0x5a, 0x2c)
    } else {
        Color32::from_rgb(0x96, 0x60, 0x2a)
    };
    // Also the frame of the field that is typed into.
    v.selection.stroke = Stroke::new(1.0, accent);
    v.text_cursor.stroke = Stroke::new(2.0, accent);
    v.slider_trailing_fill = true;
    v.handle_shape = egui::style::HandleShape::Circle;
    let w = &mut v.widgets;
    for (state, fill, stroke, text) in [
        (&mut w.noninteractive, panel, line, text),
        (&mut w.inactive, field, Color32::TRANSPARENT, text),
        (&mut w.hovered, hover, Color32::TRANSPARENT, strong),
        (&mut w.active, press, accent, strong),
        (&mut w.open, hover, Color32::TRANSPARENT, strong),
    ] {
        state.weak_bg_fill = fill;
        state.bg_fill = fill;
        state.bg_stroke = Stroke::new(1.0, stroke);
        state.fg_stroke = Stroke::new(1.0, text);
        state.corner_radius = RADIUS;
        state.expansion = 0.0;
    }
    v
}

/// How much the chosen one of a row of buttons stands out.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// In the accent colour: for the one choice that matters most.
    Strong,
    /// A lighter grey.
    Quiet,
}

/// A row of buttons of which one is chosen, over the whole width. Each entry: its words, its
/// tooltip, whether it can be chosen. Returns the one that was pressed.
pub(super) fn segmented(
    ui: &mut Ui,
    weight: Weight,
    chosen: usize,
    entries: &[(&str, String, bool)],
) -> Option<usize> {
    let mut pressed = None;
    let count = entries.len().max(1) as f32;
    let width = (ui.available_width() - (count - 1.0)) / count;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        ui.spacing_mut().button_padding.x = 4.0;
        match weight {
            Weight::Strong => ui.visuals_mut().selection.stroke.color = Color32::WHITE,
            Weight::Quiet => quiet_choice(ui),
        }
        for (i, (words, tip, enabled)) in entries.iter().enumerate() {
            let round = |on: bool| if on { 4 } else { 0 };
            let (first, last) = (round(i == 0), round(i + 1 == entries.len()));
            let radius = CornerRadius { nw: first, sw: first, ne: last, se: last };
            let button = Button::selectable(i == chosen, *words)
                .frame_when_inactive(true)
                .corner_radius(radius)
                .min_size(vec2(width, ROW))
                .truncate();
            let layout = egui::Layout::centered_and_justified(egui::Direction::LeftToRight);
            let response = ui
                .allocate_ui_with_layout(vec2(width, ROW), layout, |ui| {
                    ui.add_enabled(*enabled, button)
                })
                .inner
                .on_hover_text(tip)
                .on_disabled_hover_text(tip);
            if response.clicked() {
                pressed = Some(i);
            }
        }
    });
    pressed
}

/// Draws what is chosen in a lighter grey from here on, instead of in the accent.
pub(super) fn quiet_choice(ui: &mut Ui) {
    let (ground, text) = quiet(ui.visuals().dark_mode);
    let selection = &mut ui.visuals_mut().selection;
    (selection.bg_fill, selection.stroke.color) = (ground, text);
}

fn quiet(dark: bool) -> (Color32, Color32) {
    let (ground, text) = if dark { (0x56, 0xff) } else { (0xb8, 0x00) };
    (Color32::from_gray(ground), Color32::from_gray(text))
}

/// A line of the panel: a name in a column of its own, and what belongs to it.
pub(super) fn field<R>(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    body: impl FnOnce(&mut Ui, egui::Id) -> R,
) -> R {
    ui.horizontal(|ui| {
        let left = ui.cursor().left();
        let mut label = ui.label(name);
        if !tip.is_empty() {
            label = label.on_hover_text(tip);
        }
        ui.add_space((LABELS - (ui.cursor().left() - left)).max(0.0));
        body(ui, label.id)
    })
    .inner
}

/// Buttons of equal width over the whole width.
pub(super) fn button_row<'a>(
    ui: &mut Ui,
    buttons: impl ExactSizeIterator<Item = (&'a str, String)>,
) -> Option<usize> {
    let mut pressed = None;
    let count = buttons.len().max(1) as f32;
    let gap = ui.spacing().item_spacing.x;
    let width = (ui.available_width() - gap * (count - 1.0)) / count;
    ui.horizontal(|ui| {
        for (i, (words, tip)) in buttons.enumerate() {
            let button = Button::new(words).min_size(vec2(width, ROW));
            if ui.add_sized(vec2(width, ROW), button).on_hover_text(tip).clicked() {
                pressed = Some(i);
            }
        }
    });
    pressed
}

/// Width of a label's text in points.
pub(super) fn text_width(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE).size().x
}

/// A word at the right of a section's header.
pub(super) struct Badge {
    pub(super) text: String,
    /// In the colour of warnings.
    pub(super) warns: bool,
}

/// A section of the side panel under a header that opens and closes it, with a count or a word
/// at its right.
pub(super) fn section<R>(
    ui: &mut Ui,
    id: impl std::hash::Hash + std::fmt::Debug,
    title: &str,
    badge: Option<Badge>,
    open: bool,
    body: impl FnOnce(&mut Ui) -> R,
) -> Option<R> {
    let id = ui.make_persistent_id(id);
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, open);
    rule(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    if response.clicked() {
        state.toggle(ui);
    }
    let openness = state.openness(ui.ctx());
    let colour = match response.hovered() {
        true => accent_of(ui.visuals()),
        false => ui.visuals().strong_text_color(),
    };
    let painter = ui.painter();
    arrow(painter, pos2(rect.left() + 5.0, rect.center().y), openness, colour);
    let font = TextStyle::Body.resolve(ui.style());
    let at = pos2(rect.left() + 16.0, rect.center().y);
    painter.text(at, egui::Align2::LEFT_CENTER, title, font, colour);
    if let Some(badge) = &badge {
        let font = TextStyle::Monospace.resolve(ui.style());
        // Above the figures of the lines below, which stand within their buttons' padding.
        let at = rect.right_center() - vec2(GAP, 0.0);
        let colour = if badge.warns { accent_of(ui.visuals()) } else { weak(ui) };
        painter.text(at, egui::Align2::RIGHT_CENTER, &badge.text, font, colour);
    }
    if response.has_focus() {
        focus_frame(ui, rect);
    }
    response.widget_info(|| WidgetInfo::labeled(Role::Button, ui.is_enabled(), title));
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_expanded(state.is_open());
        if let Some(badge) = &badge {
            node.set_value(badge.text.as_str());
        }
    });
    state.show_body_unindented(ui, body).map(|r| r.inner)
}

fn arrow(painter: &egui::Painter, centre: egui::Pos2, openness: f32, colour: Color32) {
    let turn = egui::emath::Rot2::from_angle(openness * std::f32::consts::FRAC_PI_2);
    let corners = [vec2(-2.0, -4.0), vec2(3.0, 0.0), vec2(-2.0, 4.0)].map(|v| centre + turn * v);
    painter.add(Shape::line(corners.to_vec(), Stroke::new(1.5, colour)));
}

/// A line across the panel between two groups.
pub(super) fn rule(ui: &mut Ui) {
    ui.add(egui::Separator::default().spacing(GAP));
}

/// A square of colour: linear Rec. 709 in 0..=1, or a radiance scaled to its largest channel.
pub(super) fn swatch(ui: &mut Ui, linear: [f32; 3]) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(12.0), Sense::hover());
    let colour = egui::Rgba::from_rgb(linear[0], linear[1], linear[2]);
    let line = Stroke::new(1.0, weak(ui).gamma_multiply(0.5));
    ui.painter().rect(rect, CornerRadius::same(2), colour, line, StrokeKind::Inside);
    response
}

/// Where the keyboard is.
pub(super) fn focus_frame(ui: &Ui, rect: Rect) {
    let stroke = Stroke::new(1.0, accent_of(ui.visuals()));
    ui.painter().rect_stroke(rect, RADIUS, stroke, StrokeKind::Inside);
}

/// The space a file that is being dragged over the window would drop into.
pub(super) fn drop_target(ui: &Ui, rect: Rect) {
    let rect = rect.shrink(GROUP);
    let veil = ui.visuals().panel_fill.gamma_multiply(0.85);
    let stroke = Stroke::new(2.0, accent_of(ui.visuals()));
    ui.painter().rect(rect, CornerRadius::same(8), veil, stroke, StrokeKind::Inside);
    let font = TextStyle::Heading.resolve(ui.style());
    let colour = ui.visuals().strong_text_color();
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, "Drop to open", font, colour);
}

/// A number with this many significant digits and no trailing noise: 98.63, 0.1414, 1.25e6.
pub(super) fn digits(value: f64, significant: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&exponent) {
        return format!("{value:.*e}", significant - 1);
    }
    let decimals = (significant as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones() {
        for (value, text) in [
            (0.0, "0"),
            (0.141421, "0.1414"),
            (98.0, "98.00"),
            (1234.56, "1235"),
            (123456.0, "123456"),
            (1e-4, "0.0001000"),
            (2e8 - 2.0, "2.000e8"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(digits(value, 4), text);
        }
    }

    #[test]
    fn text_stands_out_from_every_ground() {
        // WCAG 2: at least 4.5 for small text.
        let luminance = |c: Color32| {
            let [r, g, b, _] = egui::Rgba::from(c).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let contrast = |a: Color32, b: Color32| {
            let (a, b) = (luminance(a), luminance(b));
            (a.max(b) + 0.05) / (a.min(b) + 0.05)
        };
        for dark in [true, false] {
            let v = visuals(dark);
            let weak = v.weak_text_color.unwrap();
            for (what, text, ground) in [
                ("text", v.text_color(), v.panel_fill),
                ("weak", weak, v.panel_fill),
                ("warning", v.warn_fg_color, v.panel_fill),
                ("error", v.error_fg_color, v.panel_fill),
                ("button", v.widgets.inactive.text_color(), v.widgets.inactive.bg_fill),
                ("hovered", v.widgets.hovered.text_color(), v.widgets.hovered.bg_fill),
                ("pressed", v.widgets.active.text_color(), v.widgets.active.bg_fill),
                ("chosen", Color32::WHITE, v.selection.bg_fill),
                ("quietly chosen", quiet(dark).1, quiet(dark).0),
            ] {
                let ratio = contrast(text, ground);
                assert!(
                    ratio >= 4.5,
                    "{what} ({}): {ratio:.2}",
                    if dark { "dark" } else { "light" }
                );
            }
        }
    }
}
