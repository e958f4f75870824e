//! Colours, spacing and type.

use burnish::brdf::Model;
use burnish::picture::Face;
use egui::{
    Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke,
    Style, TextStyle, Ui, Visuals, vec2,
};

/// Width of the side panel in points.
pub(crate) const PANEL: f32 = 304.0;
/// Gap between things that belong together, and between groups, in points.
pub(crate) const GAP: f32 = 8.0;
pub(crate) const GROUP: f32 = 16.0;
pub(crate) const RADIUS: CornerRadius = CornerRadius::same(4);
/// Height of a line of controls, and width of the column of names.
pub(crate) const ROW: f32 = 24.0;
pub(crate) const LABELS: f32 = 72.0;

/// Behind white words that must not be overlooked.
pub(crate) const ALARM: Color32 = Color32::from_rgb(0xb8, 0x1c, 0x14);

/// The one accent, a polished bronze; on dark ground and on light.
fn accent(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0xd6, 0x9b, 0x5c) } else { Color32::from_rgb(0x8a, 0x56, 0x20) }
}

/// The colour that stands for a model in every plot: sky blue, vermilion and bluish green after Okabe
/// and Ito, which the colour-blind tell apart.
pub(crate) fn model(visuals: &Visuals, model: Model) -> Color32 {
    let (dark, light) = match model {
        Model::Phong => ([0x56, 0xb4, 0xe9], [0x00, 0x72, 0xb2]),
        Model::Beckmann => ([0xf0, 0x7f, 0x45], [0xc4, 0x4f, 0x00]),
        Model::Ggx => ([0x2f, 0xc4, 0x9a], [0x00, 0x80, 0x5e]),
    };
    let [r, g, b] = if visuals.dark_mode { dark } else { light };
    Color32::from_rgb(r, g, b)
}

/// The ground on which the picture is judged: neutral, of middle lightness.
pub(crate) fn surround(visuals: &Visuals) -> Color32 {
    Color32::from_gray(if visuals.dark_mode { 0x50 } else { 0x9a })
}

/// For what is beside the point.
pub(crate) fn weak(ui: &Ui) -> Color32 {
    ui.visuals().weak_text_color()
}

/// For warnings.
pub(crate) fn accent_of(visuals: &Visuals) -> Color32 {
    accent(visuals.dark_mode)
}

/// Sets up the fonts and both themes.
pub(crate) fn install(ctx: &Context) {
    ctx.set_fonts(fonts());
    ctx.set_style_of(egui::Theme::Dark, style(true));
    ctx.set_style_of(egui::Theme::Light, style(false));
}

/// Those of the labels on pictures. egui's own are the same, and would be in the program a second time.
pub(crate) fn fonts() -> FontDefinitions {
    let [words, figures] = ["words", "figures"];
    let mut fonts = FontDefinitions::empty();
    for (name, face) in [(words, Face::Words), (figures, Face::Figures)] {
        fonts.font_data.insert(name.into(), FontData::from_static(face.file()).into());
    }
    fonts.families.insert(FontFamily::Proportional, vec![words.into()]);
    fonts.families.insert(FontFamily::Monospace, vec![figures.into(), words.into()]);
    fonts
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
    v.error_fg_color = if dark { Color32::from_rgb(0xff, 0x6b, 0x60) } else { ALARM };
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

/// Draws what is chosen in a lighter grey from here on, instead of in the accent.
pub(crate) fn quiet_choice(ui: &mut Ui) {
    let (ground, text) = quiet(ui.visuals().dark_mode);
    let selection = &mut ui.visuals_mut().selection;
    (selection.bg_fill, selection.stroke.color) = (ground, text);
}

fn quiet(dark: bool) -> (Color32, Color32) {
    let (ground, text) = if dark { (0x56, 0xff) } else { (0xb8, 0x00) };
    (Color32::from_gray(ground), Color32::from_gray(text))
}

#[cfg(test)]
mod tests {
    use super::*;

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
                ("alarm", Color32::WHITE, ALARM),
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
