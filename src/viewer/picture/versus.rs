//! Two pictures against each other in the picture's space: where each is drawn, the bar between them,
//! and what they are called.

use super::side::Side;
use crate::viewer::document::comparison::Layout;
use crate::viewer::picture::difference;
use crate::viewer::style::{labels, theme};
use egui::epaint::{ColorImage, TextureHandle};
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Key, Modifiers, Painter, Pos2, Rect, Sense, Stroke,
    TextStyle, TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;

/// The key that shows the second of two that flip.
pub(crate) const FLIP: Key = Key::X;
/// Step of the bar for one press of an arrow key, as a part of the picture's width.
const STEP: f32 = 0.01;

/// A comparison to draw in one frame.
pub(crate) struct Versus {
    pub(crate) layout: Layout,
    pub(crate) names: [String; 2],
    pub(crate) difference: Option<Arc<ColorImage>>,
}

/// The difference on the card.
#[derive(Default)]
pub(crate) struct DifferenceTexture {
    shown: Option<(Arc<ColorImage>, TextureHandle)>,
}

impl DifferenceTexture {
    fn paint(
        &mut self,
        painter: &Painter,
        place: Rect,
        image: &Arc<ColorImage>,
        options: TextureOptions,
    ) {
        match &mut self.shown {
            Some((shown, _)) if Arc::ptr_eq(shown, image) => {}
            Some((shown, texture)) => {
                *shown = image.clone();
                texture.set(image.clone(), options);
            }
            None => {
                let texture = painter.ctx().load_texture("difference", image.clone(), options);
                self.shown = Some((image.clone(), texture));
            }
        }
        let Some((_, texture)) = &self.shown else { return };
        let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.image(texture.id(), place, uv, Color32::WHITE);
    }
}

/// The parts of the space for the two pictures.
pub(crate) fn spaces(space: Rect, layout: Option<Layout>) -> [Rect; 2] {
    if layout != Some(Layout::SideBySide) {
        return [space; 2];
    }
    let (left, right) = space.split_left_right_at_x(space.center().x.round());
    [left, right]
}

impl Versus {
    /// Draws both into their places within their spaces, the bar at `wipe` of the picture's width.
    pub(crate) fn paint(
        self,
        ui: &Ui,
        [spaces, places]: [[Rect; 2]; 2],
        sides: &[Side; 2],
        wipe: &mut f32,
        on_card: &mut DifferenceTexture,
        options: TextureOptions,
    ) {
        let [first, second] =
            [0, 1].map(|i: usize| (ui.painter_at(spaces[i]), &sides[i], places[i]));
        let paint = |painter: &Painter, side: &Side, place: Rect| {
            if let Some(texture) = &side.texture {
                texture.paint(painter, place);
            }
        };
        match self.layout {
            Layout::SideBySide => {
                for (i, (painter, side, place)) in [first, second].into_iter().enumerate() {
                    paint(&painter, side, place);
                    chip(
                        ui,
                        &painter,
                        place.intersect(spaces[i]),
                        Align2::LEFT_TOP,
                        &self.names[i],
                    );
                }
            }
            Layout::Flip => {
                let held = !ui.ctx().text_edit_focused() && ui.input(|i| i.key_down(FLIP));
                let (painter, side, place) = if held { second } else { first };
                paint(&painter, side, place);
                let name = &self.names[usize::from(held)];
                chip(ui, &painter, place.intersect(spaces[0]), Align2::LEFT_TOP, name);
            }
            Layout::Wipe => {
                paint(&first.0, first.1, places[0]);
                let x = bar(ui, places[0], wipe);
                let right = spaces[0].with_min_x(x.max(spaces[0].left()));
                if right.is_positive() {
                    paint(&ui.painter_at(right), second.1, places[0]);
                }
                let seen = places[0].intersect(spaces[0]);
                let line = Stroke::new(1.0, Color32::WHITE);
                let shade = Stroke::new(3.0, Color32::from_black_alpha(120));
                for stroke in [shade, line] {
                    first.0.vline(x, seen.y_range(), stroke);
                }
                chip(ui, &first.0, seen, Align2::LEFT_TOP, &self.names[0]);
                chip(ui, &first.0, seen, Align2::RIGHT_TOP, &self.names[1]);
            }
            Layout::Difference => {
                match &self.difference {
                    Some(image) => on_card.paint(&first.0, places[0], image, options),
                    None => paint(&first.0, first.1, places[0]),
                }
                let seen = places[0].intersect(spaces[0]);
                let names = format!("{} to {}", self.names[0], self.names[1]);
                chip(ui, &first.0, seen, Align2::LEFT_TOP, &names);
                difference::legend(ui, &first.0, seen);
            }
        }
    }
}

/// The bar between two pictures: dragged, or moved by the arrow keys. Returns where it is.
fn bar(ui: &Ui, place: Rect, wipe: &mut f32) -> f32 {
    let x = place.left() + *wipe * place.width();
    let area = Rect::from_center_size(pos2(x, place.center().y), vec2(12.0, place.height()));
    let area = area.intersect(ui.max_rect());
    let response = ui.interact(area, Id::unique("wipe"), Sense::drag());
    let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    if response.dragged() && place.width() > 0.0 {
        *wipe += response.drag_delta().x / place.width();
    }
    if response.has_focus() {
        let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
        let by = ui.input_mut(|input| {
            let mut count = |key| input.count_and_consume_key(Modifiers::NONE, key) as f32;
            count(Key::ArrowRight) - count(Key::ArrowLeft)
        });
        *wipe += STEP * by;
    }
    *wipe = wipe.clamp(0.0, 1.0);
    let value = f64::from(*wipe);
    response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), value, labels::WIPE.name));
    place.left() + *wipe * place.width()
}

/// A name in a corner of a picture.
fn chip(ui: &Ui, painter: &Painter, place: Rect, corner: Align2, name: &str) {
    let font: FontId = TextStyle::Body.resolve(ui.style());
    let galley = painter.layout_no_wrap(name.to_owned(), font, Color32::WHITE);
    let size = galley.size() + vec2(16.0, 8.0);
    let inset = place.shrink(theme::GAP);
    let at = corner.align_size_within_rect(size, inset);
    painter.rect_filled(at, theme::RADIUS, Color32::from_black_alpha(176));
    painter.galley(at.min + vec2(8.0, 4.0), galley, Color32::WHITE);
}
