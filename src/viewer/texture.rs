//! The picture on the graphics card: tiles of radiance become textures of 8-bit colour.

use burnish::picture::Tone;
use burnish::progressive::{Snapshot, TILE, TileGrid, TileImage};
use egui::epaint::{ColorImage, TextureHandle};
use egui::{Color32, Context, Rect, TextureOptions, pos2, vec2};
use std::sync::Arc;

/// Side of one texture in pixels. Cards refuse textures beyond some size (8192 is common), and a
/// picture may be larger, so it is cut into sheets; whole tiles each.
const SHEET: u32 = 64 * TILE;

/// What is shown of a picture, and the textures that show it.
pub(super) struct PictureTexture {
    grid: TileGrid,
    tone: Tone,
    options: TextureOptions,
    /// What each tile shows: of the newest epoch, or of an earlier one where that has none yet.
    shown: Vec<Option<Arc<TileImage>>>,
    sheets: Vec<Sheet>,
}

struct Sheet {
    /// Its first pixel in the picture.
    origin: [u32; 2],
    size: [u32; 2],
    texture: TextureHandle,
}

impl PictureTexture {
    /// A picture of nothing yet.
    pub(super) fn new(ctx: &Context, grid: TileGrid, tone: Tone) -> PictureTexture {
        let options = TextureOptions::NEAREST;
        let mut sheets = Vec::new();
        for y in (0..grid.size[1]).step_by(SHEET as usize) {
            for x in (0..grid.size[0]).step_by(SHEET as usize) {
                let size = [(grid.size[0] - x).min(SHEET), (grid.size[1] - y).min(SHEET)];
                let black = ColorImage::filled(size.map(|s| s as usize), Color32::BLACK);
                let texture = ctx.load_texture("picture", black, options);
                sheets.push(Sheet { origin: [x, y], size, texture });
            }
        }
        PictureTexture { grid, tone, options, shown: vec![None; grid.len()], sheets }
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.grid.size
    }

    /// The mean radiance shown at a pixel, and its standard error where that is known.
    pub(super) fn pixel(&self, [x, y]: [u32; 2]) -> Option<([f32; 3], Option<[f32; 3]>)> {
        let columns = self.grid.columns_rows()[0];
        let index = ((y / TILE) * columns + x / TILE) as usize;
        let tile = self.shown.get(index)?.as_ref()?;
        let rect = self.grid.rect(index);
        let at = (y - rect.y0) as usize * rect.width() + (x - rect.x0) as usize;
        Some((*tile.mean.get(at)?, tile.standard_error.get(at).copied()))
    }

    /// Shows the tiles that are new. Tiles that the snapshot does not have yet stay as they are.
    /// Returns how many were uploaded.
    pub(super) fn show(&mut self, snapshot: &Snapshot) -> usize {
        let mut uploaded = 0;
        for (index, tile) in snapshot.tiles.iter().enumerate() {
            let (Some(tile), Some(shown)) = (tile, self.shown.get(index)) else { continue };
            // Tiles never change once made: the same allocation is the same picture.
            if shown.as_ref().is_some_and(|old| Arc::ptr_eq(old, tile)) {
                continue;
            }
            self.shown[index] = Some(tile.clone());
            self.upload(index, tile);
            uploaded += 1;
        }
        uploaded
    }

    /// Changes exposure, curve or filter, which concerns every pixel.
    pub(super) fn restyle(&mut self, tone: Tone, options: TextureOptions) {
        if (tone, options) == (self.tone, self.options) {
            return;
        }
        (self.tone, self.options) = (tone, options);
        let columns = self.grid.columns_rows()[0] as usize;
        for sheet in &mut self.sheets {
            let mut image = ColorImage::filled(sheet.size.map(|s| s as usize), Color32::BLACK);
            let [x, y] = sheet.origin.map(|o| (o / TILE) as usize);
            let [w, h] = sheet.size.map(|s| s.div_ceil(TILE) as usize);
            for index in (y..y + h).flat_map(|row| (x..x + w).map(move |c| row * columns + c)) {
                let Some(Some(tile)) = self.shown.get(index) else { continue };
                let rect = self.grid.rect(index);
                let pixels = colours(tone, &tile.mean);
                if pixels.len() != rect.area() {
                    continue;
                }
                for (row, line) in pixels.chunks_exact(rect.width()).enumerate() {
                    let start = (rect.y0 - sheet.origin[1]) as usize + row;
                    let start = start * image.size[0] + (rect.x0 - sheet.origin[0]) as usize;
                    image.pixels[start..start + line.len()].copy_from_slice(line);
                }
            }
            sheet.texture.set(image, options);
        }
    }

    /// Paints the picture into a rectangle of the screen.
    pub(super) fn paint(&self, painter: &egui::Painter, rect: Rect) {
        let scale = rect.size() / vec2(self.grid.size[0] as f32, self.grid.size[1] as f32);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        for sheet in &self.sheets {
            let [origin, size] =
                [sheet.origin, sheet.size].map(|[x, y]| vec2(x as f32, y as f32) * scale);
            let place = Rect::from_min_size(rect.min + origin, size);
            if place.intersects(painter.clip_rect()) {
                painter.image(sheet.texture.id(), place, uv, Color32::WHITE);
            }
        }
    }

    fn upload(&mut self, index: usize, tile: &TileImage) {
        let rect = self.grid.rect(index);
        let sheets_a_row = self.grid.size[0].div_ceil(SHEET);
        let sheet = (rect.y0 / SHEET) * sheets_a_row + rect.x0 / SHEET;
        let Some(sheet) = self.sheets.get_mut(sheet as usize) else { return };
        let pixels = colours(self.tone, &tile.mean);
        if pixels.len() == rect.area() {
            let image = ColorImage::new([rect.width(), rect.height()], pixels);
            let at = [rect.x0 - sheet.origin[0], rect.y0 - sheet.origin[1]];
            sheet.texture.set_partial(at.map(|c| c as usize), image, self.options);
        }
    }
}

fn colours(tone: Tone, pixels: &[[f32; 3]]) -> Vec<Color32> {
    let mut colours = vec![Color32::BLACK; pixels.len()];
    tone.map(pixels, &mut colours, |[r, g, b]| Color32::from_rgb(r, g, b));
    colours
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::tests::Card;
    use burnish::progressive::{Counts, State};
    use egui_kittest::TestRenderer;

    /// A picture whose red tells the column and whose green the row.
    fn snapshot(size: [u32; 2], keep: impl Fn(usize) -> bool) -> Snapshot {
        let grid = TileGrid { size };
        let tile = |index| {
            let rect = grid.rect(index);
            let pixel =
                |x: u32, y: u32| [x as f32 / size[0] as f32, y as f32 / size[1] as f32, 0.5];
            let rows = (rect.y0..rect.y1).flat_map(|y| (rect.x0..rect.x1).map(move |x| (x, y)));
            let mean = rows.map(|(x, y)| pixel(x, y)).collect();
            TileImage { passes: 1, mean, standard_error: Vec::new(), block: 1 }
        };
        Snapshot {
            epoch: 1,
            grid,
            tiles: (0..grid.len()).map(|i| keep(i).then(|| Arc::new(tile(i)))).collect(),
            dirty: Vec::new(),
            passes: 1,
            counts: Counts::default(),
            error: None,
            seconds: 0.0,
            state: State::Done,
        }
    }

    fn upload(ctx: &Context, card: &mut Card) {
        card.handle_delta(&mut ctx.tex_manager().write().take_delta());
    }

    /// Whether the card shows the snapshot where that has tiles, and black elsewhere.
    fn shows(card: &Card, texture: &PictureTexture, snapshot: &Snapshot) -> bool {
        let picture = snapshot.mean();
        texture.sheets.iter().all(|sheet| {
            let codes = card.codes(sheet.texture.id());
            let [w, h] = sheet.size;
            assert_eq!(codes.len(), (w * h) as usize);
            (0..w * h).all(|i| {
                let (x, y) = (sheet.origin[0] + i % w, sheet.origin[1] + i / w);
                let [r, g, b] =
                    texture.tone.exact(picture.pixels[(y * picture.width + x) as usize]);
                codes[i as usize] == Color32::from_rgb(r, g, b)
            })
        })
    }

    #[test]
    fn pictures_beyond_one_sheet_are_cut_at_whole_tiles() {
        for size in [[SHEET + 40, 70], [33, SHEET + 1], [SHEET, 31], [1, 1]] {
            let (ctx, mut card) = (Context::default(), Card::default());
            let whole = snapshot(size, |_| true);
            let mut texture = PictureTexture::new(&ctx, whole.grid, Tone::default());
            assert_eq!(texture.show(&whole), whole.grid.len());
            upload(&ctx, &mut card);
            assert!(shows(&card, &texture, &whole), "{size:?}");
            let tone = Tone { exposure: 1.0, ..Tone::default() };
            texture.restyle(tone, TextureOptions::LINEAR);
            upload(&ctx, &mut card);
            assert!(shows(&card, &texture, &whole), "{size:?}, exposed");
        }
    }

    #[test]
    fn only_new_tiles_are_uploaded_and_missing_ones_stay() {
        let (ctx, mut card) = (Context::default(), Card::default());
        let whole = snapshot([100, 100], |_| true);
        let mut texture = PictureTexture::new(&ctx, whole.grid, Tone::default());
        assert_eq!(texture.show(&whole), 16);
        assert_eq!(texture.show(&whole), 0, "nothing is new");
        let mut next = whole.clone();
        next.tiles[5] = snapshot([100, 100], |_| true).tiles[5].clone();
        next.tiles[6] = None;
        assert_eq!(texture.show(&next), 1);
        upload(&ctx, &mut card);
        assert!(shows(&card, &texture, &whole));
    }

    #[test]
    fn a_pixel_is_found_in_its_tile() {
        let ctx = Context::default();
        let whole = snapshot([70, 40], |i| i != 0);
        let mut texture = PictureTexture::new(&ctx, whole.grid, Tone::default());
        texture.show(&whole);
        assert_eq!(texture.pixel([3, 3]), None, "not traced yet");
        let mean = whole.mean();
        for at @ [x, y] in [[69, 39], [32, 0], [31, 32]] {
            assert_eq!(texture.pixel(at), Some((mean.pixels[(y * 70 + x) as usize], None)));
        }
    }
}
