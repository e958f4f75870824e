//! The picture on the graphics card: tiles of radiance become textures of 8-bit colour.
//!
//! The window's thread gives tones to as many pixels a frame as it has time for, and to new tiles
//! alone. More than that, as after a change of exposure of a large picture, is work for another
//! thread; what is on the card stays until it is done, so that no picture has two exposures.

use crate::viewer::picture::maps::Scale;
use burnish::picture::Tone;
use burnish::progressive::{Snapshot, TILE, TileGrid, TileImage, TileRect};
use egui::epaint::{ColorImage, TextureHandle};
use egui::{Color32, Context, Rect, TextureOptions, pos2, vec2};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Side of one texture in pixels. Cards refuse textures beyond some size (8192 is common), and a
/// picture may be larger, so it is cut into sheets; whole tiles each.
const SHEET: u32 = 64 * TILE;
/// Pixels that the window's thread gives tones to in one frame, at most.
const AT_ONCE: usize = 1 << 18;

type Tiles = Vec<Option<Arc<TileImage>>>;

/// Map from a tile to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// Its radiance, by exposure and curve.
    Tone(Tone),
    /// A layer in false colour.
    Map(Scale),
}

/// A picture as it is shown, and the textures that show it.
pub(crate) struct PictureTexture {
    grid: TileGrid,
    look: Look,
    options: TextureOptions,
    /// Image that each tile is to show: of the newest epoch, or of an earlier one where that has none yet.
    wanted: Tiles,
    /// Images on the sheets, with what look and how magnified.
    shown: Tiles,
    shown_as: (Look, TextureOptions),
    sheets: Vec<Sheet>,
    job: Option<Job>,
}

struct Sheet {
    area: Area,
    texture: Option<TextureHandle>,
}

/// A sheet's place in the picture.
#[derive(Clone, Copy)]
struct Area {
    /// Its first pixel in the picture.
    origin: [u32; 2],
    size: [u32; 2],
}

/// All sheets being made anew by another thread.
struct Job {
    tiles: Tiles,
    look: Look,
    result: Receiver<Vec<ColorImage>>,
}

impl PictureTexture {
    /// A picture of nothing yet.
    pub(crate) fn new(grid: TileGrid, look: Look) -> PictureTexture {
        let mut sheets = Vec::new();
        for y in (0..grid.size[1]).step_by(SHEET as usize) {
            for x in (0..grid.size[0]).step_by(SHEET as usize) {
                let size = [(grid.size[0] - x).min(SHEET), (grid.size[1] - y).min(SHEET)];
                sheets.push(Sheet { area: Area { origin: [x, y], size }, texture: None });
            }
        }
        let options = TextureOptions::NEAREST;
        PictureTexture {
            grid,
            look,
            options,
            wanted: vec![None; grid.len()],
            shown: vec![None; grid.len()],
            shown_as: (look, options),
            sheets,
            job: None,
        }
    }

    /// Width and height in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.grid.size
    }

    /// Whether there is anything to be painted.
    pub(crate) fn is_ready(&self) -> bool {
        self.sheets.iter().all(|s| s.texture.is_some())
    }

    /// Whether another thread is at work on it.
    #[cfg(test)]
    pub(crate) fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// The tile that shows a pixel, and the pixel's place in it.
    pub(crate) fn pixel(&self, pixel: [u32; 2]) -> Option<(&TileImage, usize)> {
        let (tile, rect, [x, y]) = self.tile_of(pixel)?;
        let at = y * rect.width() + x;
        (at < tile.mean.len()).then_some((tile, at))
    }

    /// The tile that shows a pixel, the tile's place, and the pixel's column and row there.
    pub(crate) fn tile_of(&self, [x, y]: [u32; 2]) -> Option<(&TileImage, TileRect, [usize; 2])> {
        let columns = self.grid.columns_rows()[0];
        let index = ((y / TILE) * columns + x / TILE) as usize;
        let tile = self.shown.get(index)?.as_deref()?;
        let rect = self.grid.rect(index);
        let within = x < rect.x1 && y < rect.y1;
        within.then(|| (tile, rect, [(x - rect.x0) as usize, (y - rect.y0) as usize]))
    }

    /// Wants the tiles of a snapshot. Tiles that it does not have yet stay as they are. Whether any
    /// is new.
    pub(crate) fn show(&mut self, snapshot: &Snapshot) -> bool {
        let mut news = false;
        for (wanted, tile) in self.wanted.iter_mut().zip(&snapshot.tiles) {
            let Some(tile) = tile else { continue };
            if wanted.as_ref().is_none_or(|wanted| !Arc::ptr_eq(wanted, tile)) {
                *wanted = Some(tile.clone());
                news = true;
            }
        }
        news
    }

    /// Images to be shown, with the tiles' places.
    pub(crate) fn tiles(&self) -> impl Iterator<Item = (&TileImage, TileRect)> + Clone {
        let tiles = self.wanted.iter().enumerate();
        tiles.filter_map(|(index, tile)| Some((tile.as_deref()?, self.grid.rect(index))))
    }

    /// Wants another look or filter, which concerns every pixel.
    pub(crate) fn restyle(&mut self, look: Look, options: TextureOptions) {
        (self.look, self.options) = (look, options);
    }

    /// Brings the card up to date, or has another thread do so, which then repaints. To be called
    /// with every frame. Returns how many pixels were given tones here.
    pub(crate) fn refresh(&mut self, ctx: &Context) -> usize {
        match self.job.take() {
            None => {}
            Some(job) => match job.result.try_recv() {
                Ok(images) => self.take_over(ctx, job, images),
                Err(TryRecvError::Empty) => {
                    self.job = Some(job);
                    return 0;
                }
                // It could not be had or failed: again, with what is wanted by now.
                Err(TryRecvError::Disconnected) => {}
            },
        }
        let (look, options) = self.shown_as;
        let stale: Vec<usize> = (0..self.wanted.len())
            .filter(|&i| match (&self.wanted[i], &self.shown[i]) {
                // Tiles never change once made: the same allocation is the same picture.
                (Some(wanted), Some(shown)) => look != self.look || !Arc::ptr_eq(wanted, shown),
                (wanted, _) => wanted.is_some(),
            })
            .collect();
        let pixels: usize = stale.iter().map(|&i| self.grid.rect(i).area()).sum();
        let [width, height] = self.grid.size.map(|s| s as usize);
        let blank = if self.is_ready() { 0 } else { width * height };
        if pixels.max(blank) > AT_ONCE {
            if pixels > 0 {
                self.start(ctx);
            }
            return 0;
        }
        if pixels > 0 {
            self.make_blank(ctx);
        }
        for &index in &stale {
            self.upload(index);
        }
        self.shown_as.0 = self.look;
        if options != self.options {
            self.shown_as.1 = self.options;
            self.refilter();
        }
        pixels
    }

    /// Has another thread make all sheets.
    fn start(&mut self, ctx: &Context) {
        let (send, result) = channel();
        let (grid, look, tiles) = (self.grid, self.look, self.wanted.clone());
        let areas: Vec<Area> = self.sheets.iter().map(|s| s.area).collect();
        self.job = Some(Job { tiles: tiles.clone(), look, result });
        let repaint = ctx.clone();
        let work = move || {
            let made = areas.into_iter().map(|area| sheet(grid, area, &tiles, look)).collect();
            // Nobody listens any more when the picture has another size by now.
            let _ = send.send(made);
            drop(send);
            repaint.request_repaint();
        };
        if std::thread::Builder::new().name("tones".to_owned()).spawn(work).is_err() {
            ctx.request_repaint_after_secs(1.0);
        }
    }

    fn take_over(&mut self, ctx: &Context, job: Job, images: Vec<ColorImage>) {
        for (sheet, image) in self.sheets.iter_mut().zip(images) {
            match &mut sheet.texture {
                Some(texture) => texture.set(image, self.options),
                None => sheet.texture = Some(ctx.load_texture("picture", image, self.options)),
            }
        }
        (self.shown, self.shown_as) = (job.tiles, (job.look, self.options));
    }

    /// Sheets to put tiles on.
    fn make_blank(&mut self, ctx: &Context) {
        for sheet in self.sheets.iter_mut().filter(|s| s.texture.is_none()) {
            let black = ColorImage::filled(sheet.area.size.map(|s| s as usize), Color32::BLACK);
            sheet.texture = Some(ctx.load_texture("picture", black, self.options));
        }
    }

    /// A texture takes its filter from the last part of it that was uploaded: one tile will do.
    fn refilter(&mut self) {
        let tiles_a_row = self.grid.columns_rows()[0];
        for i in 0..self.sheets.len() {
            let [x, y] = self.sheets[i].area.origin.map(|o| o / TILE);
            self.upload((y * tiles_a_row + x) as usize);
        }
    }

    /// Paints the picture into a rectangle of the screen.
    pub(crate) fn paint(&self, painter: &egui::Painter, rect: Rect) {
        let scale = rect.size() / vec2(self.grid.size[0] as f32, self.grid.size[1] as f32);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        for Sheet { area, texture } in &self.sheets {
            let Some(texture) = texture else { continue };
            let [origin, size] =
                [area.origin, area.size].map(|[x, y]| vec2(x as f32, y as f32) * scale);
            let place = Rect::from_min_size(rect.min + origin, size);
            if place.intersects(painter.clip_rect()) {
                painter.image(texture.id(), place, uv, Color32::WHITE);
            }
        }
    }

    /// Puts a tile as it is wanted on its sheet; black where there is none.
    fn upload(&mut self, index: usize) {
        let rect = self.grid.rect(index);
        let sheets_a_row = self.grid.size[0].div_ceil(SHEET);
        let sheet = (rect.y0 / SHEET) * sheets_a_row + rect.x0 / SHEET;
        let Some(Sheet { area, texture: Some(texture) }) = self.sheets.get_mut(sheet as usize)
        else {
            return;
        };
        let Some(wanted) = self.wanted.get(index) else { return };
        let pixels = match wanted {
            Some(tile) => colours(self.look, tile, rect),
            None => vec![Color32::BLACK; rect.area()],
        };
        if pixels.len() == rect.area() {
            let image = ColorImage::new([rect.width(), rect.height()], pixels);
            let at = [rect.x0 - area.origin[0], rect.y0 - area.origin[1]];
            texture.set_partial(at.map(|c| c as usize), image, self.options);
        }
        self.shown[index].clone_from(wanted);
    }
}

/// All pixels of a sheet; black where there is no tile.
fn sheet(grid: TileGrid, area: Area, tiles: &Tiles, look: Look) -> ColorImage {
    let mut image = ColorImage::filled(area.size.map(|s| s as usize), Color32::BLACK);
    let columns = grid.columns_rows()[0] as usize;
    let [x, y] = area.origin.map(|o| (o / TILE) as usize);
    let [w, h] = area.size.map(|s| s.div_ceil(TILE) as usize);
    for index in (y..y + h).flat_map(|row| (x..x + w).map(move |c| row * columns + c)) {
        let Some(Some(tile)) = tiles.get(index) else { continue };
        let rect = grid.rect(index);
        let pixels = colours(look, tile, rect);
        if pixels.len() != rect.area() {
            continue;
        }
        for (row, line) in pixels.chunks_exact(rect.width()).enumerate() {
            let start = (rect.y0 - area.origin[1]) as usize + row;
            let start = start * image.size[0] + (rect.x0 - area.origin[0]) as usize;
            image.pixels[start..start + line.len()].copy_from_slice(line);
        }
    }
    image
}

fn colours(look: Look, tile: &TileImage, rect: TileRect) -> Vec<Color32> {
    match look {
        Look::Tone(tone) => {
            let mut colours = vec![Color32::BLACK; tile.mean.len()];
            tone.map(&tile.mean, &mut colours, |[r, g, b]| Color32::from_rgb(r, g, b));
            colours
        }
        Look::Map(scale) => scale.colours(tile, rect),
    }
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
            let (samples, standard_error) = (Vec::new(), Vec::new());
            TileImage { passes: 1, samples, mean, standard_error, block: 1 }
        };
        Snapshot {
            epoch: 1,
            grid,
            tiles: (0..grid.len()).map(|i| keep(i).then(|| Arc::new(tile(i)))).collect(),
            dirty: Vec::new(),
            passes: 1,
            whole: true,
            counts: Counts::default(),
            error: None,
            seconds: 0.0,
            group: burnish::trace::ReuseGroup::None,
            state: State::Done,
        }
    }

    fn upload(ctx: &Context, card: &mut Card) {
        card.handle_delta(&mut ctx.tex_manager().write().take_delta());
    }

    /// Whether the card shows the snapshot where that has tiles, and black elsewhere.
    fn shows(card: &Card, texture: &PictureTexture, snapshot: &Snapshot) -> bool {
        let picture = snapshot.mean();
        let Look::Tone(tone) = texture.look else { panic!("a map") };
        texture.sheets.iter().all(|Sheet { area, texture: on_card }| {
            let codes = card.codes(on_card.as_ref().unwrap().id());
            let [w, h] = area.size;
            assert_eq!(codes.len(), (w * h) as usize);
            (0..w * h).all(|i| {
                let (x, y) = (area.origin[0] + i % w, area.origin[1] + i / w);
                let [r, g, b] = tone.exact(picture.pixels[(y * picture.width + x) as usize]);
                codes[i as usize] == Color32::from_rgb(r, g, b)
            })
        })
    }

    /// Frame after frame until all that is wanted is on the card; the most pixels that one frame
    /// gave tones to on this thread.
    fn settle(texture: &mut PictureTexture, ctx: &Context, card: &mut Card) -> usize {
        let start = std::time::Instant::now();
        let mut most = 0;
        loop {
            let here = texture.refresh(ctx);
            most = most.max(here);
            upload(ctx, card);
            if here == 0 && !texture.is_busy() {
                return most;
            }
            assert!(start.elapsed().as_secs() < 60, "never done");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
    }

    #[test]
    fn pictures_beyond_one_sheet_are_cut_at_whole_tiles() {
        for size in [[SHEET + 40, 70], [33, SHEET + 1], [SHEET, 31], [1, 1]] {
            let (ctx, mut card) = (Context::default(), Card::default());
            let whole = snapshot(size, |_| true);
            let mut texture = PictureTexture::new(whole.grid, Look::Tone(Tone::default()));
            assert!(!texture.is_ready());
            texture.show(&whole);
            settle(&mut texture, &ctx, &mut card);
            assert!(shows(&card, &texture, &whole), "{size:?}");
            let tone = Tone { exposure: 1.0, ..Tone::default() };
            texture.restyle(Look::Tone(tone), TextureOptions::LINEAR);
            settle(&mut texture, &ctx, &mut card);
            assert!(shows(&card, &texture, &whole), "{size:?}, exposed");
        }
    }

    #[test]
    fn only_new_tiles_are_uploaded_and_missing_ones_stay() {
        let (ctx, mut card) = (Context::default(), Card::default());
        let whole = snapshot([100, 100], |_| true);
        let mut texture = PictureTexture::new(whole.grid, Look::Tone(Tone::default()));
        texture.show(&whole);
        assert_eq!(texture.refresh(&ctx), 100 * 100);
        texture.show(&whole);
        assert_eq!(texture.refresh(&ctx), 0, "nothing is new");
        let mut next = whole.clone();
        next.tiles[5] = snapshot([100, 100], |_| true).tiles[5].clone();
        next.tiles[6] = None;
        texture.show(&next);
        assert_eq!(texture.refresh(&ctx), whole.grid.rect(5).area());
        upload(&ctx, &mut card);
        assert!(shows(&card, &texture, &whole));
    }

    #[test]
    fn the_window_is_given_no_more_than_it_has_time_for() {
        let (ctx, mut card) = (Context::default(), Card::default());
        let whole = snapshot([1600, 1200], |_| true);
        let mut texture = PictureTexture::new(whole.grid, Look::Tone(Tone::default()));
        texture.show(&whole);
        assert_eq!(settle(&mut texture, &ctx, &mut card), 0, "the whole picture is another's work");
        // Some new tiles are put in place at once, and nothing else is touched.
        let mut next = whole.clone();
        for index in [0, 7, 800, whole.grid.len() - 1] {
            let tile = whole.tiles[index].as_ref().unwrap();
            next.tiles[index] = Some(Arc::new(TileImage {
                passes: 2,
                samples: Vec::new(),
                mean: tile.mean.iter().map(|p| p.map(|c| 0.5 * c)).collect(),
                standard_error: Vec::new(),
                block: 1,
            }));
        }
        texture.show(&next);
        let here = texture.refresh(&ctx);
        assert_eq!(
            (here, texture.is_busy()),
            (3 * 1024 + next.grid.rect(next.grid.len() - 1).area(), false)
        );
        upload(&ctx, &mut card);
        assert!(shows(&card, &texture, &next));
        // A new exposure is not seen before it is everywhere.
        let before = texture.look;
        let tone = Tone { exposure: -1.0, ..Tone::default() };
        texture.restyle(Look::Tone(tone), TextureOptions::NEAREST);
        assert_eq!((texture.refresh(&ctx), texture.is_busy()), (0, true));
        upload(&ctx, &mut card);
        texture.look = before;
        assert!(shows(&card, &texture, &next), "the picture before stays whole");
        texture.look = Look::Tone(tone);
        assert_eq!(settle(&mut texture, &ctx, &mut card), 0);
        assert!(shows(&card, &texture, &next));
        // Another filter is a tile a sheet.
        texture.restyle(Look::Tone(tone), TextureOptions::LINEAR);
        assert_eq!(texture.refresh(&ctx), 0);
        let delta = ctx.tex_manager().write().take_delta();
        let parts: Vec<usize> =
            delta.set.values().flatten().map(|d| d.image.width() * d.image.height()).collect();
        assert_eq!(parts, [1024]);
    }

    #[test]
    fn a_pixel_is_found_in_its_tile() {
        let ctx = Context::default();
        let whole = snapshot([70, 40], |i| i != 0);
        let mut texture = PictureTexture::new(whole.grid, Look::Tone(Tone::default()));
        texture.show(&whole);
        texture.refresh(&ctx);
        assert!(texture.pixel([3, 3]).is_none(), "not traced yet");
        let mean = whole.mean();
        for at @ [x, y] in [[69, 39], [32, 0], [31, 32]] {
            let (tile, i) = texture.pixel(at).unwrap();
            assert_eq!(tile.mean[i], mean.pixels[(y * 70 + x) as usize]);
        }
    }
}
