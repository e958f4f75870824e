//! The pixel under the pointer, in a corner of the picture's space that the pointer is not in.

use crate::viewer::picture::canvas::Hover;
use crate::viewer::style::numbers::digits;
use crate::viewer::style::theme;
use egui::{Align2, Area, Frame, Id, Margin, Order, Pos2, Rect, RichText, Ui, Vec2, vec2};

/// From the corner, where the pointer makes it move to the other one, in points.
const NEAR: Vec2 = vec2(320.0, 120.0);

/// Draws it; the pointer is at `pointer`.
pub(crate) fn ui(ui: &Ui, hover: &Hover, space: Rect, pointer: Option<Pos2>) {
    let corner = Rect::from_min_size(space.min, NEAR);
    let (pivot, corner) = if pointer.is_some_and(|p| corner.contains(p)) {
        (Align2::RIGHT_TOP, space.right_top() + vec2(-theme::GAP, theme::GAP))
    } else {
        (Align2::LEFT_TOP, space.left_top() + vec2(theme::GAP, theme::GAP))
    };
    Area::new(Id::unique("pixel"))
        .order(Order::Middle)
        .interactable(false)
        .pivot(pivot)
        .fixed_pos(corner)
        .show(ui.ctx(), |ui| {
            let fill = ui.visuals().panel_fill.gamma_multiply(0.9);
            let frame = Frame::new().fill(fill).corner_radius(theme::RADIUS);
            frame.inner_margin(Margin::symmetric(8, 4)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                ui.spacing_mut().interact_size.y = 0.0;
                for line in lines(hover) {
                    ui.label(RichText::new(line).monospace());
                }
            });
        });
}

/// Where it is and of how many passes; its radiance; the standard error of that.
pub(crate) fn lines(hover: &Hover) -> [String; 3] {
    let [x, y] = hover.pixel;
    let triple = |c: [f32; 3]| c.map(|v| format!("{:>8}", digits(f64::from(v), 3))).join(" ");
    let passes = match hover.passes {
        0 => "coarse preview".to_owned(),
        1 => "1 pass".to_owned(),
        n => format!("{n} passes"),
    };
    let error = hover.standard_error.map_or(format!("{:>8}", "-"), triple);
    [
        format!("({x}, {y})  {passes}"),
        format!("RGB {}", triple(hover.mean)),
        format!("  \u{b1} {error}"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_error_and_passes_are_told_as_far_as_they_are_known() {
        let known = Hover {
            pixel: [42, 24],
            mean: [0.5, 12.25, 0.0],
            standard_error: Some([0.001, 0.25, 0.0]),
            passes: 16,
        };
        let lines_of =
            |hover| lines(&hover).map(|l| l.split_whitespace().collect::<Vec<_>>().join(" "));
        assert_eq!(
            lines_of(known),
            ["(42, 24) 16 passes", "RGB 0.500 12.2 0", "\u{b1} 0.00100 0.250 0"]
        );
        let preview = Hover { standard_error: None, passes: 0, ..known };
        assert_eq!(lines_of(preview)[0], "(42, 24) coarse preview");
        assert_eq!(lines_of(preview)[2], "\u{b1} -");
    }
}
