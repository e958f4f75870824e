//! The few widgets that egui does not have, or not so.

use crate::viewer::style::labels::Control;
use crate::viewer::style::theme;
use egui::collapsing_header::CollapsingState;
use egui::{
    Align, Button, Color32, CornerRadius, Layout, Rect, RectAlign, Response, RichText, Role, Sense,
    Shape, Stroke, StrokeKind, TextStyle, Tooltip, Ui, Vec2, WidgetInfo, pos2, vec2,
};

/// Emphasis of the chosen one of a row of buttons.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    /// In the accent colour: for the one choice that matters most.
    Strong,
    /// A lighter grey.
    Quiet,
}

/// A row of buttons of which one is chosen, over the whole width. Each entry: its words, its
/// tooltip, whether it can be chosen. Returns the one that was pressed.
pub(crate) fn segmented(
    ui: &mut Ui,
    weight: Weight,
    chosen: usize,
    entries: &[(&str, String, bool)],
) -> Option<usize> {
    let mut pressed = None;
    let count = entries.len().max(1) as f32;
    let room = ui.available_width() - (count - 1.0);
    // Of one width, unless words are too long for that.
    let needed: Vec<f32> = entries.iter().map(|(words, ..)| text_width(ui, words) + 8.0).collect();
    let equal = needed.iter().all(|&width| width <= room / count);
    let spare = (room - needed.iter().sum::<f32>()) / count;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 1.0;
        ui.spacing_mut().button_padding.x = 4.0;
        match weight {
            Weight::Strong => ui.visuals_mut().selection.stroke.color = Color32::WHITE,
            Weight::Quiet => theme::quiet_choice(ui),
        }
        for (i, (words, tip, enabled)) in entries.iter().enumerate() {
            let width = if equal { room / count } else { (needed[i] + spare).max(8.0) };
            let round = |on: bool| if on { 4 } else { 0 };
            let (first, last) = (round(i == 0), round(i + 1 == entries.len()));
            let radius = CornerRadius { nw: first, sw: first, ne: last, se: last };
            let button = Button::selectable(i == chosen, *words)
                .frame_when_inactive(true)
                .corner_radius(radius)
                .min_size(vec2(width, theme::ROW))
                .truncate();
            let layout = egui::Layout::centered_and_justified(egui::Direction::LeftToRight);
            let response = ui
                .allocate_ui_with_layout(vec2(width, theme::ROW), layout, |ui| {
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

/// A line of the panel: a name in a column of its own, and what belongs to it.
pub(crate) fn field<R>(
    ui: &mut Ui,
    control: &Control,
    body: impl FnOnce(&mut Ui, egui::Id) -> R,
) -> R {
    ui.horizontal(|ui| {
        let left = ui.cursor().left();
        let label = ui.label(control.name).on_hover_text(control.tip);
        ui.add_space((theme::LABELS - (ui.cursor().left() - left)).max(0.0));
        body(ui, label.id)
    })
    .inner
}

/// Buttons of equal width over the whole width. Each entry: its words, its tooltip, whether it can
/// be pressed.
pub(crate) fn button_row(ui: &mut Ui, buttons: &[(&str, String, bool)]) -> Option<usize> {
    let mut pressed = None;
    let count = buttons.len().max(1) as f32;
    let gap = ui.spacing().item_spacing.x;
    let width = (ui.available_width() - gap * (count - 1.0)) / count;
    ui.horizontal(|ui| {
        for (i, (words, tip, enabled)) in buttons.iter().enumerate() {
            let size = vec2(width, theme::ROW);
            let button = Button::new(*words).min_size(size);
            let row = ui.add_enabled_ui(*enabled, |ui| ui.add_sized(size, button)).inner;
            if row.on_hover_text(tip).on_disabled_hover_text(tip).clicked() {
                pressed = Some(i);
            }
        }
    });
    pressed
}

/// A line: what it is about, and figures in columns of their own at the right.
pub(crate) fn number_row(
    ui: &mut Ui,
    name: impl FnOnce(&mut Ui),
    figures: [&str; 2],
    head: bool,
) -> Response {
    const FIGURE: f32 = 72.0;
    ui.horizontal(|ui| {
        let width = ui.available_width() - 2.0 * FIGURE;
        let size = vec2(width - ui.spacing().item_spacing.x, 16.0);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(size.x);
            name(ui);
        });
        ui.spacing_mut().item_spacing.x = 0.0;
        for figure in figures {
            let layout = Layout::right_to_left(Align::Center);
            ui.allocate_ui_with_layout(vec2(FIGURE, 16.0), layout, |ui| {
                ui.set_min_width(FIGURE);
                ui.label(match head {
                    true => RichText::new(figure).small().weak(),
                    false => RichText::new(figure).monospace(),
                });
            });
        }
    })
    .response
}

/// The tooltip of a menu's entry: at the left, where it hides no other entry.
pub(crate) fn beside(entry: &Response, text: &str) {
    let mut tip = Tooltip::for_enabled(entry);
    tip.popup = tip.popup.align(RectAlign::LEFT_START);
    tip.show(|ui| ui.label(text));
}

/// Width of a label's text in points.
pub(crate) fn text_width(ui: &Ui, text: &str) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE).size().x
}

/// A word at the right of a section's header.
pub(crate) struct Badge {
    pub(crate) text: String,
    /// In the colour of warnings.
    pub(crate) warns: bool,
}

/// A section of the side panel under a header that opens and closes it, with a count or a word
/// at its right.
pub(crate) fn section<R>(
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
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::click());
    if response.clicked() {
        state.toggle(ui);
        ui.data_mut(|d| d.insert_temp(id, Revealing(state.is_open())));
    }
    let openness = state.openness(ui.ctx());
    let colour = match response.hovered() {
        true => theme::accent_of(ui.visuals()),
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
        let at = rect.right_center() - vec2(theme::GAP, 0.0);
        let colour = if badge.warns { theme::accent_of(ui.visuals()) } else { theme::weak(ui) };
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
    let shown = state.show_body_unindented(ui, body)?;
    // One that is opened at the foot of the panel is not to be opened out of sight; of one that is taller
    // than the panel, its beginning is shown.
    if let Some(Revealing(true)) = ui.data(|d| d.get_temp(id)) {
        let height = (shown.response.rect.bottom() - rect.top()).min(ui.clip_rect().height());
        ui.scroll_to_rect(Rect::from_min_size(rect.min, vec2(rect.width(), height)), None);
        if openness >= 1.0 {
            ui.data_mut(|d| d.remove::<Revealing>(id));
        }
    }
    Some(shown.inner)
}

/// Whether a section that is being opened is to be scrolled to.
#[derive(Clone, Copy)]
struct Revealing(bool);

/// Opens the section of this name that is drawn next by this part of the window, and shows it.
pub(crate) fn open_section(ui: &Ui, id: impl std::hash::Hash + std::fmt::Debug) {
    let id = ui.make_persistent_id(id);
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, true);
    state.set_open(true);
    state.store(ui.ctx());
    ui.data_mut(|d| d.insert_temp(id, Revealing(true)));
}

/// Opens the section of this name, or closes it if it is open.
pub(crate) fn turn_section(ui: &Ui, id: &'static str) {
    let place = ui.make_persistent_id(id);
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), place, false);
    if state.is_open() {
        state.set_open(false);
        state.store(ui.ctx());
    } else {
        open_section(ui, id);
    }
}

/// Says that a button opens a menu.
pub(crate) fn menu_arrow(ui: &Ui, button: &Response) {
    let colour = ui.style().interact(button).text_color();
    arrow(ui.painter(), button.rect.right_center() - vec2(10.0, 0.0), 1.0, colour);
}

fn arrow(painter: &egui::Painter, centre: egui::Pos2, openness: f32, colour: Color32) {
    let turn = egui::emath::Rot2::from_angle(openness * std::f32::consts::FRAC_PI_2);
    let corners = [vec2(-2.0, -4.0), vec2(3.0, 0.0), vec2(-2.0, 4.0)].map(|v| centre + turn * v);
    painter.add(Shape::line(corners.to_vec(), Stroke::new(1.5, colour)));
}

/// A line across the panel between two groups.
pub(crate) fn rule(ui: &mut Ui) {
    ui.add(egui::Separator::default().spacing(theme::GAP));
}

/// A square of colour: linear Rec. 709 in 0..=1, or a radiance scaled to its largest channel.
pub(crate) fn swatch(ui: &mut Ui, linear: [f32; 3]) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(12.0), Sense::hover());
    let colour = egui::Rgba::from_rgb(linear[0], linear[1], linear[2]);
    let line = Stroke::new(1.0, theme::weak(ui).gamma_multiply(0.5));
    ui.painter().rect(rect, CornerRadius::same(2), colour, line, StrokeKind::Inside);
    response
}

/// Frame of the widget that has the keyboard focus.
pub(crate) fn focus_frame(ui: &Ui, rect: Rect) {
    let stroke = Stroke::new(1.0, theme::accent_of(ui.visuals()));
    ui.painter().rect_stroke(rect, theme::RADIUS, stroke, StrokeKind::Inside);
}

/// The space a file that is being dragged over the window would drop into.
pub(crate) fn drop_target(ui: &Ui, rect: Rect) {
    let rect = rect.shrink(theme::GROUP);
    let veil = ui.visuals().panel_fill.gamma_multiply(0.85);
    let stroke = Stroke::new(2.0, theme::accent_of(ui.visuals()));
    ui.painter().rect(rect, CornerRadius::same(8), veil, stroke, StrokeKind::Inside);
    let font = TextStyle::Heading.resolve(ui.style());
    let colour = ui.visuals().strong_text_color();
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, "Drop to open", font, colour);
}
