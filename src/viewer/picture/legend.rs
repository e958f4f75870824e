//! The legend of a picture in false colour.

use super::maps::{Layer, Scale, viridis};
use crate::viewer::style::theme;
use burnish::progressive::{TileImage, TileRect};
use egui::{Align2, Color32, FontId, Rect, Shape, Stroke, TextStyle, Ui, pos2, vec2};

/// Width and height of the legend.
const LEGEND: egui::Vec2 = vec2(240.0, 56.0);

/// Draws the scale of the colours: below the picture where there is room, else over its lower left corner.
/// Points to the value of a pixel.
pub(crate) fn paint(ui: &Ui, scale: &Scale, [space, place]: [Rect; 2], pixel: Pixel) {
    let painter = ui.painter_at(space);
    let font: FontId = TextStyle::Small.resolve(ui.style());
    let seen = place.intersect(space);
    let below = pos2(seen.left(), seen.bottom() + theme::GAP);
    let within = seen.left_bottom() + vec2(theme::GAP, -LEGEND.y - theme::GAP);
    let fits = below.y + LEGEND.y + theme::GAP <= space.bottom();
    let at = Rect::from_min_size(if fits { below } else { within }, LEGEND);
    painter.rect_filled(at, theme::RADIUS, Color32::from_black_alpha(200));
    let inner = at.shrink2(vec2(8.0, 6.0));
    let write = |at, align, words: String, colour| {
        painter.text(at, align, words, font.clone(), colour);
    };
    let quiet = Color32::from_gray(0xc8);
    let title = scale.layer.control().name;
    let what = match scale.layer {
        Layer::Picture => title,
        Layer::Noise => "relative standard error, log",
        Layer::Samples => "samples per pixel, log",
    };
    write(inner.left_top(), Align2::LEFT_TOP, what.to_owned(), Color32::WHITE);
    let bar = Rect::from_min_size(inner.min + vec2(0.0, 16.0), vec2(inner.width(), 10.0));
    let steps = 112;
    let x = |share: f32| bar.left() + bar.width() * share;
    for i in 0..steps {
        let [from, to] = [i, i + 1].map(|i| i as f32 / steps as f32);
        let cell = Rect::from_x_y_ranges(x(from)..=x(to), bar.y_range());
        painter.rect_filled(cell, 0.0, viridis((from + to) / 2.0));
    }
    let below = bar.bottom() + 4.0;
    let [low, high] = scale.ends.map(|v| scale.layer.words(v));
    write(pos2(bar.left(), below), Align2::LEFT_TOP, format!("{low} and less"), quiet);
    write(pos2(bar.right(), below), Align2::RIGHT_TOP, format!("{high} and more"), quiet);
    match pixel {
        Pixel::None => {}
        Pixel::Unknown => {
            write(inner.right_top(), Align2::RIGHT_TOP, "not known (grey)".to_owned(), quiet);
        }
        Pixel::Value(value) => {
            let tip = pos2(x(scale.share(value)), bar.bottom() - 1.0);
            let corners = vec![tip, tip + vec2(-4.0, 6.0), tip + vec2(4.0, 6.0)];
            let outline = Stroke::new(1.0, Color32::BLACK);
            painter.add(Shape::convex_polygon(corners, Color32::WHITE, outline));
            let words = scale.layer.words(value);
            write(inner.right_top(), Align2::RIGHT_TOP, words, Color32::WHITE);
        }
    }
}

/// Value that the legend points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pixel {
    None,
    Unknown,
    Value(f32),
}

impl Pixel {
    /// The value of a pixel at this place of its tile.
    pub(crate) fn of(layer: Layer, tile: &TileImage, rect: TileRect, at: [usize; 2]) -> Pixel {
        layer.value(tile, rect, at).map_or(Pixel::Unknown, Pixel::Value)
    }
}
