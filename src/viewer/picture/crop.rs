//! A part of the picture chosen by dragging: the largest of the picture's proportions in what was dragged
//! over.

use burnish::scene::Crop;
use egui::{Pos2, Rect, vec2};

/// Points that a drag must be long: shorter ones are slips.
const LEAST: f32 = 8.0;

/// The part between two points of the screen; `None` where they are too near.
pub(crate) fn dragged(place: Rect, from: Pos2, to: Pos2) -> Option<Crop> {
    let (from, to) = (place.clamp(from), place.clamp(to));
    let by = to - from;
    if by.abs().max_elem() < LEAST {
        return None;
    }
    let [x, y] = [by.x / place.width(), by.y / place.height()];
    let side = x.abs().max(y.abs());
    // Not beyond the picture, whichever way it was dragged.
    let start = (from - place.min) / place.size();
    let room = |start: f32, by: f32| if by < 0.0 { start } else { 1.0 - start };
    let side = side.min(room(start.x, x)).min(room(start.y, y));
    let corner = |start: f32, by: f32| f64::from(if by < 0.0 { start - side } else { start });
    let at = |start: f32, by: f32| corner(start, by).clamp(0.0, 1.0 - f64::from(side));
    Crop::new(at(start.x, x), at(start.y, y), side.into()).ok()
}

/// Place of a part on the screen.
pub(crate) fn on_screen(place: Rect, part: Crop) -> Rect {
    let [x, y, side] = part.parts().map(|part| part as f32);
    let size = place.size();
    Rect::from_min_size(place.min + vec2(x, y) * size, size * side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_part_is_what_was_dragged_over_whichever_way() {
        let place = Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 200.0));
        let part = |from, to| dragged(place, from, to).map(Crop::parts);
        let expected = Some([0.25, 0.25, 0.5]);
        assert_eq!(part(pos2(200.0, 100.0), pos2(400.0, 200.0)), expected);
        assert_eq!(part(pos2(400.0, 200.0), pos2(200.0, 100.0)), expected);
        // The larger side counts, and the picture's edge.
        assert_eq!(part(pos2(200.0, 100.0), pos2(400.0, 110.0)), expected);
        assert_eq!(part(pos2(100.0, 50.0), pos2(9000.0, 9000.0)), Some([0.0, 0.0, 1.0]));
        assert_eq!(part(pos2(200.0, 100.0), pos2(204.0, 103.0)), None);
        let square = on_screen(place, Crop::new(0.25, 0.25, 0.5).unwrap());
        assert_eq!(square, Rect::from_min_max(pos2(200.0, 100.0), pos2(400.0, 200.0)));
    }
}
