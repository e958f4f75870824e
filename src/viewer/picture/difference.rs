//! The difference of two pictures as a picture: colour where it is more than noise.

use crate::viewer::style::numbers::percent;
use burnish::measure::significance::{Noisy, Pixel, Significance};
use burnish::picture::{Picture, Tone};
use burnish::progressive::Snapshot;
use egui::epaint::ColorImage;
use egui::{Align2, Color32, FontId, Painter, Rect, TextStyle, Ui, pos2, vec2};
use std::sync::Arc;

/// Pictures to be compared, and how the first is shown in grey below the colours.
#[derive(Clone)]
pub(crate) struct Question {
    pub(crate) first: Snapshot,
    pub(crate) second: Snapshot,
    pub(crate) tone: Tone,
}

impl PartialEq for Question {
    fn eq(&self, o: &Question) -> bool {
        let same = same_picture;
        same(&self.first, &o.first) && same(&self.second, &o.second) && self.tone == o.tone
    }
}

/// Whether two snapshots show the same: tiles never change once made.
pub(crate) fn same_picture(a: &Snapshot, b: &Snapshot) -> bool {
    a.tiles.len() == b.tiles.len()
        && a.tiles.iter().zip(&b.tiles).all(|(a, b)| match (a, b) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        })
}

/// Result of a comparison.
pub(crate) struct Answer {
    /// The picture, and what there is to say; or why there is none.
    pub(crate) image: Option<Arc<ColorImage>>,
    pub(crate) verdict: Result<String, String>,
}

/// Relative differences from this on have the full colour.
const FULL: f32 = 0.5;
const BRIGHTER: [f32; 3] = [255.0, 140.0, 20.0];
const DARKER: [f32; 3] = [40.0, 130.0, 255.0];

/// Compares two pictures: a few tenths of a second for millions of pixels.
pub(crate) fn compare(question: &Question) -> Answer {
    let Question { first, second, tone } = question;
    let sides = [first, second].map(|s| (s.mean(), known_error(s)));
    let noisy = |i: usize| Noisy { mean: &sides[i].0, standard_error: sides[i].1.as_ref() };
    let Some(found) = Significance::new(noisy(0), noisy(1)) else {
        let size = |p: &Picture| format!("{} x {}", p.width, p.height);
        let why = format!(
            "The pictures have {} and {} pixels: there is no difference to be had.",
            size(&sides[0].0),
            size(&sides[1].0)
        );
        return Answer { image: None, verdict: Err(why) };
    };
    let mut codes = vec![[0u8; 3]; sides[0].0.pixels.len()];
    tone.rgb8(&sides[0].0.pixels, &mut codes);
    let colours = codes.iter().zip(&found.pixels).map(|(code, pixel)| {
        let grey =
            0.2126 * f32::from(code[0]) + 0.7152 * f32::from(code[1]) + 0.0722 * f32::from(code[2]);
        colour(grey, *pixel)
    });
    let size = [sides[0].0.width as usize, sides[0].0.height as usize];
    let image = ColorImage::new(size, colours.collect());
    let verdict = format!(
        "Second brighter in {} of the pixels, darker in {}; no significant difference in {}.",
        percent(found.brighter),
        percent(found.darker),
        percent(1.0 - found.brighter - found.darker)
    );
    Answer { image: Some(Arc::new(image)), verdict: Ok(verdict) }
}

/// The standard error, where the picture is one that has been traced here.
fn known_error(snapshot: &Snapshot) -> Option<Picture> {
    (snapshot.counts.paths > 0).then(|| snapshot.standard_error())
}

/// Half the grey of the picture, and over it the colour of what is significant.
fn colour(grey: f32, pixel: Pixel) -> Color32 {
    let ground = 0.5 * grey + 16.0;
    if !pixel.significant {
        return Color32::from_gray(ground as u8);
    }
    let strength = (pixel.relative.abs() / FULL).min(1.0).sqrt();
    let hue = if pixel.relative > 0.0 { BRIGHTER } else { DARKER };
    let [r, g, b] = hue.map(|c| (ground + (c - ground) * (0.25 + 0.75 * strength)) as u8);
    Color32::from_rgb(r, g, b)
}

/// Draws the meaning of the colours at the lower left of the picture.
pub(crate) fn legend(ui: &Ui, painter: &Painter, place: Rect) {
    let font: FontId = TextStyle::Small.resolve(ui.style());
    let size = vec2(168.0, 36.0);
    let at = Rect::from_min_size(place.left_bottom() + vec2(8.0, -size.y - 8.0), size);
    painter.rect_filled(at, 4.0, Color32::from_black_alpha(176));
    let bar = Rect::from_min_size(at.min + vec2(8.0, 6.0), vec2(size.x - 16.0, 10.0));
    let steps = 76;
    for i in 0..steps {
        let relative = FULL * (2.0 * (i as f32 + 0.5) / steps as f32 - 1.0);
        let cell = Rect::from_min_max(
            pos2(bar.left() + bar.width() * i as f32 / steps as f32, bar.top()),
            pos2(bar.left() + bar.width() * (i + 1) as f32 / steps as f32, bar.bottom()),
        );
        painter.rect_filled(cell, 0.0, colour(128.0, Pixel { relative, significant: true }));
    }
    for (x, align, words) in [
        (bar.left(), Align2::LEFT_TOP, "-50 % darker"),
        (bar.right(), Align2::RIGHT_TOP, "brighter +50 %"),
    ] {
        painter.text(pos2(x, bar.bottom() + 3.0), align, words, font.clone(), Color32::WHITE);
    }
}
