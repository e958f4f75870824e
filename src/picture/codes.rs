//! Pictures of 8-bit colours that are put together from others, with letters on them.

use super::{Picture, Tone};

/// 8-bit colours, as a screen shows them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Codes {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green and blue, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// A part of a picture in pixels, from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Codes {
    /// One colour everywhere.
    pub(super) fn filled([width, height]: [u32; 2], colour: [u8; 3]) -> Codes {
        Codes { width, height, pixels: vec![colour; width as usize * height as usize] }
    }

    fn at(&mut self, [x, y]: [u32; 2]) -> Option<&mut [u8; 3]> {
        let inside = x < self.width && y < self.height;
        let place = y as usize * self.width as usize + x as usize;
        self.pixels.get_mut(place).filter(|_| inside)
    }

    /// A picture with the codes that its own file would have; what is beyond the place is cut off.
    pub(super) fn put(&mut self, place: Place, picture: &Picture, tone: Tone) {
        let codes = tone.dithered(picture);
        for (y, row) in (0..place.height).zip(codes.chunks(picture.width.max(1) as usize)) {
            for (x, code) in (0..place.width).zip(row) {
                if let Some(pixel) = self.at([place.x + x, place.y + y]) {
                    *pixel = *code;
                }
            }
        }
    }

    /// A line of one pixel along the inside of the place's edge.
    pub(super) fn frame(&mut self, place: Place, colour: [u8; 3]) {
        let Place { x, y, width, height } = place;
        for (i, j) in (0..height).flat_map(|j| (0..width).map(move |i| (i, j))) {
            let edge = i == 0 || j == 0 || i + 1 == width || j + 1 == height;
            if let Some(pixel) = self.at([x + i, y + j]).filter(|_| edge) {
                *pixel = colour;
            }
        }
    }

    /// Mixes a colour in, as light: letters are as bold as their area.
    pub(super) fn blend(&mut self, at: [i32; 2], colour: [u8; 3], coverage: f32) {
        let [Ok(x), Ok(y)] = at.map(u32::try_from) else { return };
        let Some(pixel) = self.at([x, y]) else { return };
        for (own, code) in pixel.iter_mut().zip(colour) {
            let (from, to) = (light(*own), light(code));
            *own = Tone::default().exact([from + coverage * (to - from); 3])[0];
        }
    }
}

/// Of an sRGB code, in 0..=1.
fn light(code: u8) -> f32 {
    let x = f32::from(code) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_what_the_default_tone_shows_as_its_code() {
        for code in 0..=255 {
            assert_eq!(Tone::default().exact([light(code); 3]), [code; 3]);
        }
    }

    #[test]
    fn what_is_outside_is_left_out() {
        let mut codes = Codes::filled([4, 3], [0; 3]);
        let picture = Picture { width: 3, height: 3, pixels: vec![[1.0; 3]; 9] };
        codes.put(Place { x: 2, y: 1, width: 3, height: 9 }, &picture, Tone::default());
        codes.blend([-1, 0], [255; 3], 1.0);
        codes.blend([4, 0], [255; 3], 1.0);
        let white = codes.pixels.iter().filter(|&&code| code == [255; 3]).count();
        assert_eq!(white, 4);
        codes.blend([0, 0], [255; 3], 0.5);
        assert_eq!(codes.pixels[0], [188; 3], "half of the light");
    }
}
