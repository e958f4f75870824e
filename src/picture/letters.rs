//! Letters as coverage of pixels, for labels on pictures.
//!
//! Two openly licensed fonts, which the window takes from here: Ubuntu Light for words, Hack for figures,
//! whose digits are all of one width. No hinting and no kerning: letters stand where their advance widths
//! put them, at fractions of a pixel.

use ab_glyph_rasterizer::{Point, Rasterizer, point};
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use std::sync::LazyLock;

/// Which of the fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Ubuntu Light, each letter as wide as it is.
    Words,
    /// Hack, every letter of one width.
    Figures,
}

/// Statics: of constants, every crate that names them would have its own copy.
static FILES: [&[u8]; 2] = [epaint_default_fonts::UBUNTU_LIGHT, epaint_default_fonts::HACK_REGULAR];

impl Face {
    /// The font's file, a TrueType one.
    pub fn file(self) -> &'static [u8] {
        FILES[self as usize]
    }

    /// The font; `None` would be a font that cannot be read, of which a test makes sure that it is not.
    fn font(self) -> Option<&'static FontRef<'static>> {
        type Fonts = [Option<FontRef<'static>>; 2];
        static FONTS: LazyLock<Fonts> =
            LazyLock::new(|| FILES.map(|bytes| FontRef::new(bytes).ok()));
        FONTS[self as usize].as_ref()
    }
}

/// Pixels from one baseline to the next, per pixel of the letters' size.
pub(super) const LINE: f32 = 1.3;

/// Width in pixels of a line of letters of this size in pixels.
pub(super) fn width(face: Face, size: f32, text: &str) -> f32 {
    let mut x = 0.0;
    each(face, size, text, |_, _, advance| x += advance);
    x
}

/// The text itself, or as much of its beginning as fits, with "..." behind it.
pub(super) fn shortened(face: Face, size: f32, text: &str, most: f32) -> String {
    if width(face, size, text) <= most {
        return text.to_owned();
    }
    const DOTS: &str = "...";
    let room = most - width(face, size, DOTS);
    let mut kept = String::new();
    let mut x = 0.0;
    each(face, size, text, |letter, _, advance| {
        x += advance;
        if x <= room {
            kept.push(letter);
        }
    });
    kept.trim_end().to_owned() + DOTS
}

/// Calls `plot` with column, row and coverage in (0, 1] of every pixel that the letters touch, relative to
/// the baseline's left end: y grows downwards.
pub(super) fn cover(face: Face, size: f32, text: &str, mut plot: impl FnMut(i32, i32, f32)) {
    let Some(font) = face.font() else { return };
    // Letters reach a little beyond their advance widths, and twice their size is taller than any.
    let (left, above) = (size.ceil() as i32, (1.5 * size).ceil() as i32);
    let columns = width(face, size, text).ceil() as usize + 2 * left as usize;
    let mut pen = Pen {
        raster: Rasterizer::new(columns, 2 * above as usize),
        from: [left as f32, above as f32],
        start: point(0.0, 0.0),
        at: point(0.0, 0.0),
    };
    let outlines = font.outline_glyphs();
    each(face, size, text, |_, glyph, advance| {
        let settings = DrawSettings::unhinted(Size::new(size), LocationRef::default());
        if let Some(outline) = outlines.get(glyph) {
            // A letter without an outline, as the space is, covers nothing.
            let _ = outline.draw(settings, &mut pen);
        }
        pen.from[0] += advance;
    });
    pen.raster.for_each_pixel_2d(|x, y, coverage| {
        let coverage = coverage.min(1.0);
        if coverage > 1.0 / 512.0 {
            plot(x as i32 - left, y as i32 - above, coverage);
        }
    });
}

/// Calls `letter` with each letter, its glyph and its advance width in pixels.
fn each(face: Face, size: f32, text: &str, mut letter: impl FnMut(char, GlyphId, f32)) {
    let Some(font) = face.font() else { return };
    let (map, metrics) =
        (font.charmap(), font.glyph_metrics(Size::new(size), LocationRef::default()));
    for c in text.chars() {
        let glyph = map.map(c).unwrap_or_default();
        letter(c, glyph, metrics.advance_width(glyph).unwrap_or(0.0));
    }
}

/// Draws outlines, whose y grows upwards from the baseline.
struct Pen {
    raster: Rasterizer,
    /// Of the letter's origin on the raster.
    from: [f32; 2],
    start: Point,
    at: Point,
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> Point {
        // The rasterizer reads and writes only what it has.
        let (columns, rows) = self.raster.dimensions();
        let [x, y] = [self.from[0] + x, self.from[1] - y];
        point(x.clamp(0.0, columns as f32 - 1.0), y.clamp(0.0, rows as f32 - 1.0))
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.start = self.place(x, y);
        self.at = self.start;
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.place(x, y);
        self.raster.draw_line(self.at, to);
        self.at = to;
    }

    fn quad_to(&mut self, x0: f32, y0: f32, x: f32, y: f32) {
        let (by, to) = (self.place(x0, y0), self.place(x, y));
        self.raster.draw_quad(self.at, by, to);
        self.at = to;
    }

    fn curve_to(&mut self, x0: f32, y0: f32, x1: f32, y1: f32, x: f32, y: f32) {
        let (first, second, to) = (self.place(x0, y0), self.place(x1, y1), self.place(x, y));
        self.raster.draw_cubic(self.at, first, second, to);
        self.at = to;
    }

    fn close(&mut self) {
        self.raster.draw_line(self.at, self.start);
        self.at = self.start;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Face; 2] = [Face::Words, Face::Figures];

    /// The area that a text covers, in pixels, and its box.
    fn area(face: Face, size: f32, text: &str) -> (f64, [i32; 4]) {
        let (mut area, mut bounds) = (0.0, [i32::MAX, i32::MAX, i32::MIN, i32::MIN]);
        cover(face, size, text, |x, y, coverage| {
            assert!(coverage > 0.0 && coverage <= 1.0);
            area += f64::from(coverage);
            let [left, top, right, bottom] = bounds;
            bounds = [left.min(x), top.min(y), right.max(x), bottom.max(y)];
        });
        (area, bounds)
    }

    #[test]
    fn letters_stand_on_the_baseline_and_grow_with_their_size() {
        for face in BOTH {
            assert!(face.font().is_some(), "{face:?}");
            let (small, [left, top, right, bottom]) = area(face, 16.0, "HE");
            assert!(left >= 0 && f64::from(right) <= f64::from(width(face, 16.0, "HE")));
            // Capitals are about 0.7 of the size, and end at the baseline.
            assert!((-13..=-10).contains(&top) && (-2..=0).contains(&bottom), "{top} {bottom}");
            // Twice as large, four times the area, whatever lies on pixels' edges.
            let (large, _) = area(face, 32.0, "HE");
            assert!((large / small / 4.0 - 1.0).abs() < 0.01, "{face:?}: {small} {large}");
            let (_, [.., below]) = area(face, 16.0, "gjpy");
            assert!((2..=6).contains(&below), "{below}");
        }
        assert_eq!(area(Face::Words, 16.0, "  ").0, 0.0);
    }

    /// The bar of an I is a rectangle: its area is known without a rasterizer.
    #[test]
    fn coverage_is_area() {
        let (whole, _) = area(Face::Words, 40.0, "I");
        let (thick, _) = area(Face::Words, 400.0, "I");
        assert!((100.0 * whole / thick - 1.0).abs() < 1e-3, "{whole} {thick}");
        let pixels = |size: f32| {
            let mut full = 0;
            cover(Face::Words, size, "I", |_, _, c| full += i32::from(c == 1.0));
            full
        };
        // Of a large letter nearly all pixels are covered whole.
        assert!(f64::from(pixels(400.0)) > 0.9 * thick);
    }

    #[test]
    fn figures_are_of_one_width_and_texts_add_up() {
        let digit = width(Face::Figures, 14.0, "0");
        for c in '0'..='9' {
            assert_eq!(width(Face::Figures, 14.0, &c.to_string()), digit);
        }
        let [a, b, ab] = ["mi", "l", "mil"].map(|text| width(Face::Words, 14.0, text));
        assert!((a + b - ab).abs() < 1e-4 && a > b);
    }

    #[test]
    fn what_is_too_long_is_cut_and_says_so() {
        for face in BOTH {
            assert_eq!(shortened(face, 14.0, "short", 1000.0), "short");
            let cut = shortened(face, 14.0, "a very long name indeed", 80.0);
            assert!(cut.starts_with("a very") && cut.ends_with("..."), "{cut}");
            assert!(width(face, 14.0, &cut) <= 80.0);
        }
    }
}
